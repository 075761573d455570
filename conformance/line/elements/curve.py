"""Curves of the track, and their cant."""

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.derived_numbers import round_number, round_position
from pantocheck.conformance.line.elements.element import BuiltSection, DerivedKeys, Element, list_key
from pantocheck.model import Catenary, TrackCurve
from pantocheck.model.description.curves import head_shift

if TYPE_CHECKING:
    from pantocheck.model import DiscretisedLine

SMALLEST_RADIUS_M = 50.0
"""Smallest radius of a curve [m]: a span of 10 m then turns by 0.2 rad, the limit of small slopes."""


class CurveTable(InputTable):
    """Curve of the track; curvature and cant rise over its transitions and are constant between them."""

    from_m: NonNegative
    """Start of the curve, with its transition [m]."""
    to_m: Positive
    """End of the curve, with its transition [m]."""
    radius_m: Annotated[float, Field(ge=-1e5, le=1e5)]
    """Radius; positive: its centre lies at positive y [m]."""
    transition_m: Annotated[NonNegative, Feature("curves")] = 0.0
    """Length of the transition at either end [m]."""
    cant_m: Annotated[float, Field(ge=-0.3, le=0.3), Feature("cant")] = 0.0
    """Height of the outer above the inner rail [m]."""

    @cross_check
    def _check_radius(self) -> Problems:
        if abs(self.radius_m) < SMALLEST_RADIUS_M:
            yield validation_problem(
                "radius_m",
                f"{self.radius_m:g} m is too small",
                f"Give at least {SMALLEST_RADIUS_M:g} m, of either sign.",
            )

    @cross_check
    def _check_transitions(self) -> Problems:
        if self.to_m - self.from_m < max(2 * self.transition_m, 1e-6):
            yield validation_problem(
                "to_m",
                f"{self.to_m:g} m leaves no room for two transitions of {self.transition_m:g} m from {self.from_m:g} m",
                "Give the end of the curve after both of its transitions.",
            )


class TrackTable(SourcedTable):
    """Track below the line: straight except for its curves."""

    contact_wire_height_m: Annotated[float, Field(gt=3, le=10)]
    """Height of the contact wire above the rails, for the effect of cant [m]."""
    rail_distance_m: Annotated[float, Field(gt=0.5, le=2)]
    """Distance between the centre lines of both rails [m]."""
    curve: Annotated[tuple[CurveTable, ...], Field(strict=False, max_length=1000), Feature("curves")] = ()
    """Curves in order."""


class DerivedCurve(InputTable):
    """Curve of the track: T times curvature loads every wire per length towards positive y, at rest."""

    from_m: float
    """Start, with its transition [m]."""
    to_m: float
    """End, with its transition [m]."""
    curvature_1_m: float
    """Curvature between the transitions [1/m]."""
    transition_m: float
    """Length at either end over which the curvature rises [m]."""


class TrackCurves(Element):
    """Curves of the track, and their cant."""

    derived: ClassVar[DerivedKeys] = {"curves": list_key(DerivedCurve, "curves of the track; absent: a straight track")}

    track: Annotated[
        TrackTable | None,
        Field(exclude_if=is_absent),
        Feature("curves", lambda track: track is not None and bool(track.curve)),
    ] = None
    """Curves and cant of the track; default: straight."""

    @property
    def curves(self) -> tuple[CurveTable, ...]:
        """Curves of the track."""
        return () if self.track is None else self.track.curve

    @cross_check
    def _check_curves(self) -> Problems:
        length = self.line.geometry.length
        for number, (before, after) in enumerate(pairwise(self.curves), 2):
            if after.from_m < before.to_m:
                yield validation_problem(
                    f"track.curve[{number}].from_m",
                    f"{after.from_m:g} m lies in the curve that ends at {before.to_m:g} m",
                    "Give the curves in order, without overlap.",
                )
        for number, curve in enumerate(self.curves, 1):
            if curve.to_m > length:
                yield validation_problem(
                    f"track.curve[{number}].to_m",
                    f"{curve.to_m:g} m is not on the line, which ends at {length:g} m",
                    f"Give a position up to {length:g} m.",
                )

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Add the curves of the track."""
        curves = (TrackCurve(c.from_m, c.to_m, c.radius_m, c.transition_m, c.cant_m) for c in self.curves)
        return replace(catenary, curves=tuple(curves))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Curves with their curvatures."""
        curves = (
            DerivedCurve(
                from_m=round_position(curve.start),
                to_m=round_position(curve.end),
                curvature_1_m=round_number(1 / curve.radius),
                transition_m=round_position(curve.transition),
            )
            for curve in section.line.catenary.curves
        )
        return {"curves": tuple(curves)}

    def measure(self, built: "DiscretisedLine") -> dict[str, float]:
        """Largest lateral distance of a touched contact wire at rest from the centre of a pantograph head."""
        from pantocheck.model.statics.contact_wires import touched_wires

        track, catenary, position = self.track, built.catenary, built.mesh.position
        if track is None or not catenary.has_lateral_field:
            return {}
        shift = head_shift(catenary.curves, position, track.rail_distance_m, track.contact_wire_height_m)
        rows = [built.mesh.row_of[wire.name, "y"] for wire in catenary.contact_wires]
        offset = max(
            abs(float(built.state.deflection[rows[wire], station, 0] - shift[station]))
            for station, x in enumerate(position)
            for wire in touched_wires(built, float(x))
        )
        return {"head_offset_mm": 1e3 * offset}
