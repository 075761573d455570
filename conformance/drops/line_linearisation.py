"""Identified modes of a line as functions of its properties and of its damping, linearised about one line.

The rows are, for each pair of modes, the logarithm of the frequency, the damping ratio, and the shape at the sensors
without its scale.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.drops.damping_model import MATRICES, WIRES, list_other_damping
from pantocheck.conformance.drops.mode_matching import (
    MatchedModes,
    Positions,
    compute_sensor_shapes,
    find_sensor_positions,
    match_modes,
)
from pantocheck.conformance.line.line_parameters import LineParameter, scale_line
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary, DiscretisedLine, Kind, Rayleigh
from pantocheck.model.discretisation.discretised_line import with_damping, with_properties
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.mode_derivatives import ModeDerivatives, NeighbouringLines, derive_modes
from pantocheck.model.modal.modes import damping_forms
from pantocheck.model.statics.assembly import assemble_matrices

STEP = 1e-3
"""Change of a factor for the derivatives of the matrices [-]; their error is of the order of its square."""

SHAPE_ERROR = 0.02
"""Standard deviation of a computed shape at a sensor, over its largest component [-]."""


@dataclass(frozen=True)
class Linearisation:
    """Computed counterparts of the m paired modes about one line; p properties, t coefficients of damping."""

    matched: MatchedModes
    """Pairs of the line."""
    frequency: RealArray
    """Computed frequencies, (m,) [Hz]."""
    frequency_slope: RealArray
    """Derivatives of their logarithms by the factors of the properties, (m, p) [-]."""
    ratios: RealArray
    """Damping ratio per unit of each coefficient, (m, t)."""
    ratio_slope: RealArray
    """Its derivatives by the factors, (m, t, p)."""
    stated: RealArray
    """Damping ratios by the components that are not fitted, (m,) [-]."""
    stated_slope: RealArray
    """Their derivatives by the factors, (m, p) [-]."""
    shape_residual: RealArray
    """Measured shapes without the part along the computed ones, over their standard deviation, (r,) [-]."""
    shape_slope: RealArray
    """Derivatives of the computed counterparts by the factors, (r, p) [-]."""
    shape_mode: IntegerArray
    """Index of the pair of each row of the shapes, (r,)."""

    def damping_slope(self, values: RealArray) -> RealArray:
        """Derivatives of the damping ratios by the factors for coefficients (t,), (m, p) [-]."""
        return np.asarray(self.stated_slope + np.einsum("mtp,t->mp", self.ratio_slope, values))


def linearise_line(
    usable: list[Mode],
    line: Catenary,
    parameters: Sequence[LineParameter],
    factors: RealArray,
    element: float,
    source: str,
) -> Linearisation:
    """Pair identified modes with those of a changed line, and derive their counterparts by the factors.

    Args:
        usable: Identified modes.
        line: Line as stated.
        parameters: Properties of the line.
        factors: Factor of each property, (p,).
        element: Element length [m].
        source: Name of the file of the modes, for messages.

    Raises:
        InputError: A sensor is not on the line, or too few modes have a computed counterpart.
    """
    changed = scale_line(line, parameters, factors.tolist())
    matched = match_modes(usable, changed, element, source)

    def change_property(number: int, step: float) -> DiscretisedLine:
        moved = factors.copy()
        moved[number] += step
        return with_properties(matched.mesh, scale_line(line, parameters, moved.tolist()))

    neighbours = [
        NeighbouringLines(change_property(n, -STEP), change_property(n, STEP), 2 * STEP) for n in range(len(parameters))
    ]
    span = _Span(matched, neighbours, derive_modes(matched.mesh, matched.shapes, neighbours))
    others = list_other_damping(line)
    units = [others | {Kind(kind): UNIT_DAMPING[matrix]} for kind in WIRES for matrix in MATRICES]
    stated, *with_units = span.derive_ratios([others, *units])
    columns = np.array(with_units) - stated
    bands = tuple(replace(band, damping_ratio=0.0) for band in line.modal_damping)
    stated = stated * apply_modal_bands(np.ones(len(stated)), span.frequency, bands)[:, None]
    return Linearisation(
        matched,
        span.frequency,
        span.frequency_slope,
        columns[:, :, 0].T,
        columns[:, :, 1:].transpose(1, 0, 2),
        stated[:, 0],
        stated[:, 1:],
        *_derive_shapes(span, find_sensor_positions(usable, changed, source)),
    )


UNIT_DAMPING = {"stiffness": Rayleigh(stiffness_coefficient=1.0), "mass": Rayleigh(mass_coefficient=1.0)}
"""Damping of one kind with one coefficient, by its matrix."""


@dataclass(frozen=True)
class _Span:
    """Span of a line with its paired modes, and neighbouring lines for each property."""

    matched: MatchedModes
    neighbours: Sequence[NeighbouringLines]
    modes: ModeDerivatives

    @property
    def paired(self) -> IntegerArray:
        """Computed mode of each pair, (m,)."""
        return np.array([pair.computed for pair in self.matched.pairs], dtype=np.int64)

    @property
    def frequency(self) -> RealArray:
        """Computed frequencies, (m,) [Hz]."""
        return self.matched.shapes.frequency[self.paired]

    @property
    def frequency_slope(self) -> RealArray:
        """Derivatives of their logarithms, (m, p) [-]."""
        return self.modes.eigenvalue[:, self.paired].T / (2 * (2 * np.pi * self.frequency[:, None]) ** 2)

    def derive_ratios(self, dampings: Sequence[Mapping[Kind, Rayleigh]]) -> RealArray:
        """Damping ratios with d dampings, and behind them their derivatives by the factors, (d, m, 1 + p)."""

        def damp(line: DiscretisedLine) -> list[DiscretisedLine]:
            return [with_damping(line, damping) for damping in dampings]

        shape, damped = self.matched.shapes.shape, damp(self.matched.mesh)
        forms = damping_forms(damped, shape)[:, self.paired]
        changes = [
            (damping_forms(damp(each.upper), shape) - damping_forms(damp(each.lower), shape)) / each.distance
            for each in self.neighbours
        ]
        slopes = np.array(
            [
                self.modes.form_derivative(assemble_matrices(line).damping, change)[:, self.paired].T
                for line, change in zip(damped, np.array(changes).swapaxes(0, 1), strict=True)
            ]
        )
        slopes -= forms[:, :, None] * self.frequency_slope
        return np.concatenate([forms[:, :, None], slopes], axis=2) / (4 * np.pi * self.frequency[:, None])


def _derive_shapes(span: _Span, positions: Positions) -> tuple[RealArray, RealArray, IntegerArray]:
    """Residuals of the shapes, (r,), derivatives of their computed counterparts, (r, p), and pair of each, (r,).

    A shape has no scale: both are taken at right angles to the computed shape, over the standard deviations.
    """
    measured, known = compute_sensor_shapes(span.matched.paired, span.matched.mesh, span.modes.span, positions)
    residuals, slopes, numbers = [np.zeros(0)], [np.zeros((0, len(span.neighbours)))], []
    for number, (mode, shape, at_sensors, j) in enumerate(
        zip(span.matched.paired, measured, known, span.paired, strict=True)
    ):
        if shape.size < 2:
            continue
        stds = [s.std or 0.0 for s in mode.sensor_shape if (s.wire, s.position_m) in positions]
        std = np.hypot(np.array(stds) / np.abs(shape).max(), SHAPE_ERROR)
        # A complex factor of modulus one makes the shape as real as it can be.
        turned = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real / np.abs(shape).max() / std
        computed = at_sensors[j] / std
        change = span.modes.rotation[:, :, j] @ at_sensors / std
        across = np.linalg.svd(computed[None])[2][1:]
        residuals.append(across @ turned)
        slopes.append((turned @ computed) / (computed @ computed) * across @ change.T)
        numbers += [number] * len(across)
    return np.concatenate(residuals), np.concatenate(slopes), np.array(numbers, dtype=np.int64)
