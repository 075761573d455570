"""Table `head` of a pantograph file: strips, pitch, roll, bending modes, friction and stops.

Each law is a table with its keys, its checks, its feature and its part of the model.
"""

from collections.abc import Callable
from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    NumberList,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.model.description.head_structure import (
    MountedStrip,
    Rotation,
    add_bending_mode,
    add_friction,
    add_roll,
    add_stop,
    mount_strips,
    set_strips,
)
from pantocheck.model.description.pantograph import Pantograph

ChainPart = int | str
"""Part of a chain: number of a mass from the base, from 1; its name; base; strip 1 or strip 2."""

LISTED_BY_LAW = Feature("", lambda _: False)
"""Declaration of the table: each law states its own feature."""

FindPart = Callable[[ChainPart, int], RealArray]
"""Displacement of a part per unit of each unknown, from the part and the number of unknowns."""

Optional = Field(exclude_if=is_absent)
"""Key that is left out of the digest of a file without it."""


class StripTable(InputTable):
    """Collector strip: a mass on a spring, or fixed to the head; of matrices and modes, a displacement."""

    position_m: Annotated[float, Field(ge=-2, le=2)]
    """Distance along the track ahead of the position of the pantograph [m]."""
    mass_kg: Annotated[Positive | None, Field(le=100), NO_FEATURE] = None
    """Mass of the strip on its spring [kg]; default: fixed to the last mass of the chain, which contains it."""
    stiffness_N_m: Annotated[Positive | None, Field(le=1e8), NO_FEATURE] = None
    """Spring between strip and head [N/m]."""
    damping_N_s_m: Annotated[NonNegative, Field(le=1e5), NO_FEATURE] = 0.0
    """Damper between strip and head [N s/m]."""
    shape: Annotated[NumberList | None, Field(max_length=200), NO_FEATURE] = None
    """Matrices and modes: displacement of the strip per unit of each unknown."""

    @cross_check
    def _spring_needs_a_mass(self) -> Problems:
        if (self.mass_kg is None) != (self.stiffness_N_m is None) or (self.damping_N_s_m and self.mass_kg is None):
            yield validation_problem("mass_kg", "a mass needs a spring, and a spring a mass", "Give both or none.")


class RotationTable(InputTable):
    """Rotation of the head."""

    inertia_kg_m2: Annotated[Positive, Field(le=1000)]
    """Moment of inertia; of a pitch without that of strips on springs [kg m2]."""
    stiffness_N_m_rad: Annotated[NonNegative, Field(le=1e7)]
    """Rotational stiffness against the part below the head [N m/rad]."""
    damping_N_m_s_rad: Annotated[NonNegative, Field(le=1e5)]
    """Rotational damper [N m s/rad]."""

    @property
    def rotation(self) -> Rotation:
        """Rotation of the model."""
        return Rotation(self.inertia_kg_m2, self.stiffness_N_m_rad, self.damping_N_m_s_rad)


class BendingModeTable(InputTable):
    """Mass-normalised bending mode of horns or strips, with a free head."""

    frequency_Hz: Annotated[Positive, Field(le=1000)]
    """Natural frequency [Hz]."""
    damping_ratio: Annotated[NonNegative, Field(lt=1)]
    """Damping ratio [-]."""
    shapes: Annotated[
        tuple[Annotated[NumberList, Field(max_length=5)], ...], Field(strict=False, min_length=1, max_length=2)
    ]
    """Displacement of each strip in the mode: coefficients of the powers of the lateral position of the wire, from 0 on
    [kg^-1/2, kg^-1/2 / m, ...].
    """


class RubbingTable(InputTable):
    """Parts between which a force acts: two parts of a chain, or a direction of matrices and modes."""

    between: Annotated[tuple[ChainPart, ChainPart] | None, Field(strict=False), NO_FEATURE] = None
    """Chain: lower and upper part; mass by name or number from the base, base, strip 1 or strip 2."""
    direction: Annotated[NumberList | None, Field(max_length=200), NO_FEATURE] = None
    """Matrices and modes: distance of both parts per unit of each unknown."""


class FrictionTable(RubbingTable):
    """Coulomb friction between two parts."""

    force_N: Annotated[Positive, Field(le=1000)]
    """Force of sliding [N]."""
    sliding_speed_m_s: Annotated[Positive, Field(le=0.1), NO_FEATURE] = 1e-3
    """Speed from which the parts slide; below, the force is proportional to the speed [m/s]."""


class StopTable(RubbingTable):
    """Bump stop between two parts; distances count from springs without force."""

    extension_m: Annotated[float | None, Field(ge=-3, le=3), NO_FEATURE] = None
    """Distance from which the stop acts when the parts move apart [m]."""
    compression_m: Annotated[float | None, Field(ge=-3, le=3), NO_FEATURE] = None
    """Distance from which the stop acts when the parts approach each other [m]."""
    stiffness_N_m: Annotated[Positive, Field(le=1e8)]
    """Stiffness of the stop [N/m]."""
    damping_N_s_m: Annotated[NonNegative, Field(le=1e5), NO_FEATURE] = 0.0
    """Damper of the stop; it does not pull [N s/m]."""

    @cross_check
    def _has_a_side(self) -> Problems:
        if self.extension_m is None and self.compression_m is None:
            yield validation_problem("extension_m", "missing", "Give extension_m, compression_m or both.")


class HeadTable(SourcedTable):
    """Structure of the head, and the forces of friction and stops."""

    strip: Annotated[tuple[StripTable, ...], Field(strict=False, max_length=2), Optional, Feature("two_strips")] = ()
    """Collector strips from front to rear; default: the head is the only one, at the position of the pantograph."""
    pitch: Annotated[RotationTable | None, Optional, Feature("head_pitch")] = None
    """Rotation about the lateral axis, which moves the strips by their position."""
    roll: Annotated[RotationTable | None, Optional, Feature("head_roll")] = None
    """Rotation about the axis of the track, which moves the strips by the lateral position of the wire."""
    bending_mode: Annotated[
        tuple[BendingModeTable, ...], Field(strict=False, max_length=20), Optional, Feature("bending_modes")
    ] = ()
    """Bending modes of horns and strips."""
    friction: Annotated[
        tuple[FrictionTable, ...], Field(strict=False, max_length=20), Optional, Feature("friction")
    ] = ()
    """Friction between parts."""
    stop: Annotated[tuple[StopTable, ...], Field(strict=False, max_length=20), Optional, Feature("stops")] = ()
    """Stroke limits."""

    @cross_check
    def _strips_in_order(self) -> Problems:
        positions = [strip.position_m for strip in self.strip]
        if positions != sorted(set(positions), reverse=True):
            yield validation_problem("strip", "the strips are not in order", "List them from front to rear.")
        for i, mode in enumerate(self.bending_mode):
            if len(mode.shapes) != max(len(self.strip), 1):
                yield validation_problem(
                    f"bending_mode[{i}].shapes", f"{len(mode.shapes)} lists", "Give one list per strip."
                )

    def find_misfits(self, chain: bool, unknowns: int) -> Problems:
        """Problems of keys that do not fit the model of the pantograph.

        Args:
            chain: Whether the pantograph is a chain; otherwise it has matrices or modes.
            unknowns: Number of its unknowns.
        """
        for i, strip in enumerate(self.strip):
            size = None if strip.shape is None else len(strip.shape)
            if size != (None if chain else unknowns) or not (chain or strip.mass_kg is None):
                hint = "Give no shape." if chain else f"Give a shape of {unknowns} values, and neither mass nor spring."
                yield validation_problem(f"strip[{i}].shape", "does not fit the model", hint)
        if self.pitch is not None and not (chain and self.strip):
            yield validation_problem("pitch", "needs the strips of a chain", "Leave it out, or state strips.")
        for key in ("friction", "stop"):
            for i, part in enumerate(getattr(self, key)):
                right = part.direction is None if chain else len(part.direction or ()) == unknowns
                if not right or (part.between is None) == chain:
                    wanted, other = ("between", "direction") if chain else ("direction", "between")
                    hint = f"Give {wanted}." if chain else f"Give {wanted} with {unknowns} values."
                    yield validation_problem(f"{key}[{i}]", f"needs {wanted}, and no {other}", hint)

    def extend(self, pantograph: Pantograph, find_part: FindPart, datum: RealArray) -> Pantograph:
        """Pantograph with the structure of this table.

        Args:
            pantograph: Linear model with a single contact.
            find_part: Place of a part of a chain.
            datum: Displacement of its unknowns at which springs are without force, (n,) [m].
        """
        model, base = pantograph, datum.size
        if any(strip.shape for strip in self.strip):
            shapes = [np.array(strip.shape) for strip in self.strip]
            model = set_strips(model, [strip.position_m for strip in self.strip], shapes)
        elif self.strip:
            mounted = [
                MountedStrip(s.position_m, s.mass_kg or 0.0, s.stiffness_N_m or 0.0, s.damping_N_s_m)
                for s in self.strip
            ]
            model = mount_strips(model, mounted, None if self.pitch is None else self.pitch.rotation)
        if self.roll is not None:
            model = add_roll(model, self.roll.rotation)
        for mode in self.bending_mode:
            model = add_bending_mode(model, mode.frequency_Hz, mode.damping_ratio, mode.shapes)
        size = model.head.size

        def find(part: ChainPart) -> RealArray:
            number = int(part[6:]) - 1 if isinstance(part, str) and part in ("strip 1", "strip 2") else None
            return model.strip_shapes[number] if number is not None else find_part(part, size)

        def direction(table: RubbingTable) -> RealArray:
            if table.between is None:
                return np.pad(np.array(table.direction), (0, size - base))
            lower, upper = map(find, table.between)
            return np.asarray(upper - lower)

        for friction in self.friction:
            model = add_friction(model, direction(friction), friction.force_N, friction.sliding_speed_m_s)
        for stop in self.stop:
            closing = direction(stop)
            # Springs between parts are without force at equal heights, the base spring at the datum.
            rest = float(closing[:base] @ datum) if stop.between is None or "base" in stop.between else 0.0
            for sign, limit in ((1.0, stop.extension_m), (-1.0, stop.compression_m)):
                if limit is not None:
                    gap = limit + sign * rest
                    model = add_stop(model, sign * closing, gap, stop.stiffness_N_m, stop.damping_N_s_m)
        return model
