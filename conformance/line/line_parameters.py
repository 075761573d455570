"""Properties of a line that a measurement can correct: each multiplies a value of the model by a factor."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, Kind, Rayleigh

ParameterGroup = Literal["tensions", "droppers", "supports", "arms"]
"""Groups of properties that a fit frees together."""

CatenaryChange = Callable[[Catenary, float], Catenary]


@dataclass(frozen=True)
class LineParameter:
    """Property of a line."""

    name: str
    """Key of its tolerance in a line file, without `_pct`."""
    group: ParameterGroup | None
    """Group that frees it; None: a coefficient of damping."""
    scale: CatenaryChange
    """Line in which the property is multiplied by a factor."""
    keys: tuple[tuple[str, str], ...]
    """Tables of a line file, wherever they stand, and the keys in them that the factor multiplies."""
    tolerance: float = 0.01
    """Standard deviation without a stated tolerance, as a share of the value [-]."""
    inverse: tuple[tuple[str, str], ...] = ()
    """Tables and keys that the factor divides."""


def _scale_wire(kind: Kind, key: Literal["tension", "bending_stiffness"]) -> CatenaryChange:
    def scale(line: Catenary, factor: float) -> Catenary:
        wires = (replace(w, **{key: getattr(w, key) * factor}) if w.kind is kind else w for w in line.wires)
        return replace(line, wires=tuple(wires))

    return scale


def _scale_droppers(line: Catenary, factor: float) -> Catenary:
    """Droppers with their stiffness, or EA, times a factor."""
    parts = (
        replace(d, axial_stiffness=(d.axial_stiffness or 0.0) * factor)
        if d.stiffness is None
        else replace(d, stiffness=d.stiffness * factor)
        for d in line.droppers
    )
    return replace(line, droppers=tuple(parts))


def _scale_supports(line: Catenary, factor: float) -> Catenary:
    parts = (replace(support, stiffness=support.stiffness * factor) for support in line.messenger_supports)
    return replace(line, messenger_supports=tuple(parts))


def _scale_arm_stiffness(line: Catenary, factor: float) -> Catenary:
    """Arms with their stiffness times a factor: a hinged arm, of stiffness force over length, is so much shorter."""
    parts = (
        replace(a, length=None if a.length is None else a.length / factor)
        if a.vertical_stiffness is None
        else replace(a, vertical_stiffness=a.vertical_stiffness * factor)
        for a in line.steady_arms
    )
    return replace(line, steady_arms=tuple(parts))


def _scale_arm_mass(line: Catenary, factor: float) -> Catenary:
    return replace(line, steady_arms=tuple(replace(arm, mass=arm.mass * factor) for arm in line.steady_arms))


def _scale_damping(kind: Kind, key: str) -> CatenaryChange:
    def scale(line: Catenary, factor: float) -> Catenary:
        rayleigh = line.rayleigh(kind)
        changed: Rayleigh = replace(rayleigh, **{key: getattr(rayleigh, key) * factor})
        return replace(line, damping={**line.damping, kind: changed})

    return scale


def _tension(kind: Kind) -> LineParameter:
    return LineParameter(f"{kind}_tension", "tensions", _scale_wire(kind, "tension"), ((str(kind), "tension_N"),))


def _bending(kind: Kind, tolerance: float) -> LineParameter:
    keys = ((str(kind), "bending_stiffness_N_m2"),)
    return LineParameter(f"{kind}_bending_stiffness", None, _scale_wire(kind, "bending_stiffness"), keys, tolerance)


def _damping(kind: Kind, key: str, in_file: str) -> LineParameter:
    return LineParameter(f"{kind}_{key}", None, _scale_damping(kind, key), ((str(kind), in_file),), 0.2)


MECHANICAL: tuple[LineParameter, ...] = (
    _tension(Kind.CONTACT_WIRE),
    _tension(Kind.MESSENGER_WIRE),
    LineParameter(
        "dropper_stiffness",
        "droppers",
        _scale_droppers,
        (("droppers", "stiffness_N_m"), ("droppers", "axial_stiffness_EA_N")),
    ),
    LineParameter(
        "messenger_support_stiffness", "supports", _scale_supports, (("messenger_support", "stiffness_N_m"),)
    ),
    LineParameter(
        "steady_arm_stiffness",
        "arms",
        _scale_arm_stiffness,
        (("steady_arm", "vertical_stiffness_N_m"),),
        inverse=(("steady_arm", "length_m"),),
    ),
    LineParameter(
        "steady_arm_moving_mass",
        "arms",
        _scale_arm_mass,
        (("steady_arm", "mass_kg_m"), ("steady_arm", "clamp_kg")),
    ),
)
"""Properties on which natural frequencies depend; tensions at the stated masses, because they see T / m alone."""

BENDING: tuple[LineParameter, ...] = (_bending(Kind.CONTACT_WIRE, 0.1), _bending(Kind.MESSENGER_WIRE, 0.5))
"""Bending stiffness of the wires. No fit frees it: it changes the modes only where a wire bends, at supports, arms and
droppers, and stands for the stiffness of their clamps. That of a stranded wire depends on the friction of its strands
(K. O. Papailiou, On the bending stiffness of transmission line conductors, IEEE Trans. Power Delivery 12 (1997) 1576).
The tolerances are assumed, and were chosen after the fits of the record T1 had been seen.
"""

DAMPING: tuple[LineParameter, ...] = tuple(
    _damping(kind, key, in_file)
    for kind in (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE)
    for key, in_file in (
        ("stiffness_coefficient", "stiffness_coefficient_s"),
        ("mass_coefficient", "mass_coefficient_1_s"),
    )
)
"""Coefficients of the damping of the wires, stiffness before mass of each wire."""

SMALLEST_DIRECTION = 1e-6
"""Smallest variance of a direction of the tolerances that counts, over the largest one [-]."""

PARAMETER_GROUPS: tuple[ParameterGroup, ...] = get_args(ParameterGroup)


def scale_line(line: Catenary, parameters: Iterable[LineParameter], factors: Sequence[float]) -> Catenary:
    """Line with each of its properties multiplied by a factor."""
    for parameter, factor in zip(parameters, factors, strict=True):
        line = parameter.scale(line, float(factor))
    return line


def build_factor_covariance(line: LineFile, parameters: Sequence[LineParameter]) -> RealArray:
    """Covariance of the factors of properties by the tolerances of a line file, (p, p) [-]."""
    return line.covariance_of([each.name for each in parameters], [each.tolerance for each in parameters])


def list_tolerance_lines(line: LineFile) -> list[Catenary]:
    """Lines one standard deviation away from a line along each principal direction of its stated tolerances."""
    table = line.tolerance
    if table is None:
        return []
    stated = [each for each in (*MECHANICAL, *DAMPING) if getattr(table, f"{each.name}_pct") is not None]
    variance, direction = np.linalg.eigh(build_factor_covariance(line, stated))
    catenary, kept = build_catenary(line), variance > SMALLEST_DIRECTION * variance.max(initial=0.0)
    # The sign of a direction is arbitrary: its largest share increases.
    sign = np.sign(np.take_along_axis(direction, np.abs(direction).argmax(axis=0)[None], axis=0))[0]
    shifts = (direction * sign * np.sqrt(np.maximum(variance, 0.0))).T[kept]
    return [scale_line(catenary, stated, (1 + shift).tolist()) for shift in shifts]
