"""Which computed mode is which measured mode: by frequency and by shape at the sensors."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from pantocheck.conformance.array_types import ComplexArray, RealArray

LARGEST_FREQUENCY_GAP = 0.05  # relative distance in frequency beyond which two modes are not the same
LEAST_MAC = 0.5


@dataclass(frozen=True)
class ModePair:
    """A measured mode and its computed counterpart, by their indices, and how alike their shapes are (0 to 1)."""

    measured: int
    computed: int
    mac: float


def modal_assurance(measured: ComplexArray, computed: RealArray) -> float:
    """Modal assurance criterion of two shapes at the same sensors; 1 if they are multiples of each other."""
    norm = float(np.sum(np.abs(measured) ** 2) * np.sum(computed**2))
    return float(np.abs(np.vdot(measured, computed)) ** 2) / norm if norm > 0 else 0.0


def pair_modes(
    measured_frequency: RealArray,
    measured_shapes: list[ComplexArray],
    computed_frequency: RealArray,
    computed_shapes: list[RealArray],
) -> tuple[ModePair, ...]:
    """Pairs of least total distance.

    A line model is off by a common factor in frequency more than by anything else, so that factor is removed first.

    Parameters
    ----------
    measured_frequency : (m,) ndarray
        [Hz].
    measured_shapes : list[complex ndarray]
        For each, (s,) at its sensors.
    computed_frequency : (n,) ndarray
        [Hz].
    computed_shapes : list[ndarray]
        For each measured mode, (n, s) the computed shapes at its sensors.
    """
    m, n = measured_frequency.size, computed_frequency.size
    if m == 0 or n == 0:
        return ()
    likeness = np.array(
        [[modal_assurance(measured_shapes[i], computed_shapes[i][j]) for j in range(n)] for i in range(m)],
        dtype=np.float64,
    )
    single = np.array([shape.size < 2 for shape in measured_shapes])
    likeness[single] = 1.0
    factor = _common_factor(measured_frequency, computed_frequency, likeness)
    distance = np.abs(np.log(measured_frequency[:, None] / (factor * computed_frequency[None, :])))
    cost = np.where(distance < LARGEST_FREQUENCY_GAP, (distance / 0.01) ** 2 + 4 * (1 - likeness), 1e6)
    rows, columns = linear_sum_assignment(cost)
    return tuple(
        ModePair(int(i), int(j), float(likeness[i, j]))
        for i, j in zip(rows, columns, strict=True)
        if cost[i, j] < 1e6 and likeness[i, j] >= LEAST_MAC
    )


def _common_factor(measured: RealArray, computed: RealArray, likeness: RealArray) -> float:
    trials = np.linspace(1 - LARGEST_FREQUENCY_GAP, 1 + LARGEST_FREQUENCY_GAP, 201)

    def misfit(factor: float) -> float:
        distance = np.abs(np.log(measured[:, None] / (factor * computed[None, :]))) / 0.01
        return float(np.sum(np.minimum((distance**2 + 4 * (1 - likeness)).min(axis=1), 4.0)))

    return float(min(trials, key=misfit))
