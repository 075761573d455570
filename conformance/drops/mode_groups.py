"""Groups of span modes. In group n the spans vibrate with n half-waves; the group has one mode per span.

The spans of a section are similar, so that the modes form groups near multiples of one frequency. Groups of higher
number are wider; from the fifth group on they almost touch. The gaps between groups remain regular: there are no modes
near (k + 1/2) times the mean frequency of the first group. This mean, and a slight increase of the multiples by bending
stiffness, are chosen so that the gaps contain as few modes as possible and no group has more modes than spans.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.results.identified_modes import Mode

LAST_GROUP = 8
"""Last group that is numbered; beyond it, modes of the spans and modes between droppers mix."""

CLEARANCE = 0.06
"""Half-width of the gap between two groups, over the mean frequency of the first group [-]."""


def assign_groups(modes: list[Mode], spans: int | None) -> tuple[Mode, ...]:
    """Assign the vertical modes to groups, and mark the outliers of each group; `spans` as in `number_groups`."""
    vertical = [i for i, mode in enumerate(modes) if not mode.lateral]
    frequency = np.array([mode.frequency_Hz for mode in modes])
    certain = np.array([modes[i].frequency_Hz for i in vertical if modes[i].certain])
    numbers = number_groups(certain, frequency[vertical], spans)
    groups = {i: int(number) or None for i, number in zip(vertical, numbers, strict=True)}
    outliers = set[int]()
    for number in {number for number in groups.values() if number is not None}:
        members = [i for i in vertical if groups[i] == number and modes[i].certain]
        flags = find_group_outliers(np.array([modes[i].damping_ratio for i in members]))
        outliers |= {i for i, flag in zip(members, flags, strict=True) if flag}
    return tuple(
        mode.model_copy(update={"group": groups.get(i), "outlier": i in outliers}) for i, mode in enumerate(modes)
    )


def number_groups(certain: RealArray, all_modes: RealArray, spans: int | None) -> IntegerArray:
    """Number of the group of each mode.

    Args:
        certain: Frequencies of the certain vertical modes, which determine the groups, (n,) [Hz].
        all_modes: Frequencies to number, (m,) [Hz].
        spans: Number of spans; None if unknown.

    Returns:
        Numbers from 1, (m,); 0 beyond `LAST_GROUP`, and for all modes if fewer than three are certain.
    """
    if certain.size < 3:
        return np.zeros(all_modes.size, dtype=np.int64)
    ordered = np.sort(certain)
    guess = float(np.mean(ordered[ordered < 1.45 * ordered[0]]))
    used = ordered[ordered < (LAST_GROUP + 0.5) * guess]
    trials = [(mean, stretch) for mean in guess * np.linspace(0.85, 1.15, 61) for stretch in np.linspace(0, 0.02, 11)]
    mean, stretch = min(trials, key=lambda t: _misfit(used, t[0], t[1], spans) + ((t[0] / guess - 1) / 0.1) ** 2)
    numbers = np.searchsorted(_gaps(mean, stretch), all_modes) + 1
    numbers[numbers > LAST_GROUP] = 0
    return np.asarray(numbers, dtype=np.int64)


def find_group_outliers(values: RealArray) -> NDArray[np.bool_]:
    """Mark values more than 1.5 interquartile ranges outside the quartiles (Tukey), (n,); none of fewer than four."""
    if values.size < 4:
        return np.zeros(values.size, dtype=np.bool_)
    low, high = np.percentile(values, [25, 75])
    reach = 1.5 * (high - low)
    return np.asarray((values < low - reach) | (values > high + reach))


def _gaps(mean: float, stretch: float) -> RealArray:
    """Gaps above groups 1..LAST_GROUP [Hz]."""
    k = np.arange(1, LAST_GROUP + 1) + 0.5
    return np.asarray(k * mean * (1 + stretch * (k - 1)))


def _misfit(frequencies: RealArray, mean: float, stretch: float, spans: int | None) -> float:
    gaps = _gaps(mean, stretch)
    nearest = np.abs(frequencies[:, None] - gaps[None, gaps < frequencies[-1] + mean]).min(axis=0)
    crowding = float(np.sum(np.exp(-((nearest / (CLEARANCE * mean)) ** 2))))
    below = float(np.sum(frequencies < 0.5 * mean))
    if spans is None:
        return crowding + 3 * below
    counts = np.bincount(np.searchsorted(gaps, frequencies))[:LAST_GROUP]
    return crowding + 3 * below + 2 * float(np.maximum(counts - spans, 0).sum())


# Modes whose half-power bands overlap: few sensors cannot tell them apart, and a pole can be a mixture of them.
OVERLAP = 1.0
"""Distance of two modes below which their half-power bands overlap, in half-power bandwidths [-].

On a line of equal spans, measured modes with another computed mode within half a bandwidth have errors of the damping
ratio of up to 11 %. Separate modes have errors of up to 0.7 %, as their standard deviations state.
"""


def warn_about_overlap(modes: Sequence[Mode]) -> tuple[str, ...]:
    """Warn of the pairs of modes that overlap, by number and frequencies; uncertain and lateral modes do not count."""
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


def required_duration(points: float, frequency_Hz: float, damping_ratio: float) -> float:
    """Length of a record whose spectrum has a number of lines in the half-power band of a mode, N / (2 zeta f) [s]."""
    return points / (2 * damping_ratio * frequency_Hz)


def overlaps(frequency: RealArray, i: int, bandwidth: float) -> bool:
    """Whether another frequency is nearer to the i-th one than `OVERLAP` bandwidths [Hz]."""
    return frequency.size > 1 and bool(abs(frequency[nearest_other(frequency, i)] - frequency[i]) < OVERLAP * bandwidth)


def nearest_other(frequency: RealArray, i: int) -> int:
    """Index of the frequency nearest to the i-th one, of two frequencies or more."""
    distance = np.abs(frequency - frequency[i])
    distance[i] = np.inf
    return int(np.argmin(distance))
