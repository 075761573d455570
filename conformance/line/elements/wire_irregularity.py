"""Irregularity of the contact wire: measured heights, or a power spectral density with a seed."""

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Protocol, cast

import numpy as np
from pydantic import Field, Tag

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.derived_numbers import Numbers, round_numbers, round_positions
from pantocheck.conformance.line.elements.element import Element, choose_by_key
from pantocheck.model import Catenary, Kind, Wire
from pantocheck.model.description.irregularity import Irregularity, SpectralDensity, realise_irregularity

MOST_POINTS = 50_000
"""Largest number of measured points: a height every 6 cm over 3 km."""
MOST_WAVES = 3000
"""Largest number of the shortest waves on a line: waves of 1 m over 3 km."""

MeasuredPositions = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=MOST_POINTS)]
MeasuredHeights = Annotated[
    tuple[Annotated[float, Field(ge=-0.5, le=0.5)], ...], Field(strict=False, min_length=2, max_length=MOST_POINTS)
]
SpectralValues = Annotated[tuple[Positive, ...], Field(strict=False, min_length=2, max_length=1000)]


class ScaledIrregularity(SourcedTable):
    """Irregularity with a common factor of its heights, which a campaign can vary."""

    height_factor: Annotated[float | None, Field(ge=0, le=100, exclude_if=is_absent), Feature("irregularity")] = None
    """Factor of all heights; default: 1 [-]."""

    @property
    def scale(self) -> float:
        """Factor of all heights."""
        return 1.0 if self.height_factor is None else self.height_factor


class MeasuredIrregularity(ScaledIrregularity):
    """Heights of the contact wire that a pantograph feels in addition to those at rest, joined by a cubic spline."""

    x_m: MeasuredPositions
    """Positions along the track, in increasing order [m]."""
    height_m: MeasuredHeights
    """Additional heights [m]; beyond the positions that of the nearest end."""

    @cross_check
    def _check_points(self) -> Problems:
        yield from _check_pairs("x_m", self.x_m, "height_m", self.height_m)


class SpectralIrregularity(ScaledIrregularity):
    """One-sided power spectral density of the additional heights, realised over the line with random phases."""

    frequency_1_m: SpectralValues
    """Spatial frequencies, in increasing order [1/m]."""
    density_m3: SpectralValues
    """Density at each frequency, log-log interpolated, zero outside of them [m3]."""
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)]
    """Seed of the phases."""

    @cross_check
    def _check_points(self) -> Problems:
        yield from _check_pairs("frequency_1_m", self.frequency_1_m, "density_m3", self.density_m3)

    def check_resolution(self, length: float) -> Problems:
        """Problem of a spectrum with too many waves on a line of a length [m]."""
        highest = MOST_WAVES / length
        if self.frequency_1_m[-1] > highest:
            yield validation_problem(
                "contact_wire.irregularity.frequency_1_m",
                f"{self.frequency_1_m[-1]:g} 1/m is too high for a line of {length:g} m",
                f"Give frequencies up to {highest:.3g} 1/m: at most {MOST_WAVES} waves on the line.",
            )


def _check_pairs(first: str, places: tuple[float, ...], second: str, values: tuple[float, ...]) -> Problems:
    """Problems of a list of places and a list of values there."""
    if len(places) != len(values):
        yield validation_problem(second, f"{len(values)} values for {len(places)} of {first}", "Give one for each.")
    falling = next((n for n, (a, b) in enumerate(pairwise(places), 2) if b <= a), None)
    if falling is not None:
        yield validation_problem(
            f"{first}[{falling}]", f"{places[falling - 1]:g} follows {places[falling - 2]:g}", "Give increasing values."
        )


IrregularityTable = Annotated[
    Annotated[MeasuredIrregularity, Tag("MeasuredIrregularity")]
    | Annotated[SpectralIrregularity, Tag("SpectralIrregularity")],
    choose_by_key("density_m3", SpectralIrregularity, MeasuredIrregularity),
]


class DerivedIrregularity(InputTable):
    """Heights that a head feels in addition to those of the wire: a cubic spline with zero slope at both ends."""

    x_m: Numbers
    """Positions of the points [m]."""
    height_m: Numbers
    """Heights [m]; beyond the points that of the nearest end."""


class IrregularWire(InputTable):
    """Key of the irregularity in the table of the contact wire."""

    irregularity: Annotated[IrregularityTable | None, Field(exclude_if=is_absent), Feature("irregularity")] = None
    """Heights that a pantograph feels in addition to those at rest."""


class DerivedIrregularWire(InputTable):
    """Key of the irregularity in the derived values of the contact wire."""

    irregularity: Annotated[DerivedIrregularity | None, Field(exclude_if=is_absent)] = None
    """absent: a smooth wire."""


class IrregularLine(Protocol):
    """Line with the table of its contact wires."""

    contact_wire: IrregularWire


class Irregularities(Element):
    """Irregularity of the contact wires; parallel wires have the same."""

    @property
    def _irregularity_table(self) -> IrregularityTable | None:
        return cast(IrregularLine, self).contact_wire.irregularity

    @property
    def built_irregularity(self) -> Irregularity | None:
        """Irregularity of the contact wires; None: smooth wires."""
        table = self._irregularity_table
        return None if table is None else _realise(table, self.line.geometry.length)

    def irregularity_at(self, position: RealArray) -> RealArray:
        """Heights of the irregularity at positions (n,) [m]; zero on smooth wires [m]."""
        from pantocheck.model.description.irregularity_spline import irregularity_height

        irregularity = self.built_irregularity
        return np.zeros_like(position) if irregularity is None else irregularity_height(irregularity, position)

    @cross_check
    def _check_irregularity(self) -> Problems:
        if isinstance(self._irregularity_table, SpectralIrregularity):
            yield from self._irregularity_table.check_resolution(self.line.geometry.length)

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Give the irregularity to the contact wires."""
        irregularity = self.built_irregularity
        wires = (
            replace(wire, irregularity=irregularity) if wire.kind is Kind.CONTACT_WIRE else wire
            for wire in catenary.wires
        )
        return replace(catenary, wires=tuple(wires))


def derive_irregularity(wire: Wire) -> DerivedIrregularity | None:
    """Points of the irregularity of a contact wire."""
    irregularity = wire.irregularity
    if irregularity is None:
        return None
    return DerivedIrregularity(
        x_m=round_positions(irregularity.position), height_m=round_numbers(np.array(irregularity.height))
    )


@lru_cache(maxsize=8)
def _realise(table: IrregularityTable, length: float) -> Irregularity:
    """Irregularity of a table over a line of a length [m]."""
    if isinstance(table, SpectralIrregularity):
        realised = realise_irregularity(SpectralDensity(table.frequency_1_m, table.density_m3), length, table.seed)
    else:
        realised = Irregularity(table.x_m, table.height_m)
    return replace(realised, height=tuple(table.scale * height for height in realised.height))
