"""Modes whose half-power bands overlap: few sensors cannot tell them apart, and a pole can be a mixture of them."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.identification.mode import Mode

OVERLAP = 1.0
"""Distance of two modes below which their half-power bands overlap, in half-power bandwidths [-].

On a line of equal spans, measured modes with another computed mode within half a bandwidth have errors of the damping
ratio of up to 11 %. Separate modes have errors of up to 0.7 %, as their standard deviations state.
"""


def warn_about_overlap(modes: Sequence[Mode]) -> tuple[str, ...]:
    """Warning with the number and frequencies of the pairs of modes that overlap.

    Args:
        modes: Identified modes of a line; uncertain and lateral ones do not count.

    Returns:
        One warning, or none.
    """
    clear = [mode for mode in modes if mode.certain and not mode.lateral]
    frequency = np.array([mode.frequency_Hz for mode in clear])
    close = [i for i, mode in enumerate(clear) if overlaps(frequency, i, half_power_bandwidth(mode))]
    if not close:
        return ()
    pairs = {tuple(sorted((i, nearest_other(frequency, i)))) for i in close}
    listed = ", ".join(f"{frequency[i]:.3f}" for i in sorted(set[int]().union(*pairs)))
    return (
        f"{count_noun(len(pairs), 'near-coincident pair')} of modes with overlapping half-power bands: {listed} Hz. "
        "Their damping ratios can be mixtures; a damping fit leaves them out.",
    )


def half_power_bandwidth(mode: Mode) -> float:
    """Half-power bandwidth 2 zeta f of a mode [Hz]."""
    return 2 * mode.damping_ratio * mode.frequency_Hz


def overlaps(frequency: RealArray, i: int, bandwidth: float) -> bool:
    """Whether another frequency is nearer to the i-th one than `OVERLAP` bandwidths [Hz]."""
    return frequency.size > 1 and bool(abs(frequency[nearest_other(frequency, i)] - frequency[i]) < OVERLAP * bandwidth)


def nearest_other(frequency: RealArray, i: int) -> int:
    """Index of the frequency nearest to the i-th one, of two frequencies or more."""
    distance = np.abs(frequency - frequency[i])
    distance[i] = np.inf
    return int(np.argmin(distance))
