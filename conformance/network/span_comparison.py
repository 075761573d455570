"""Spans of a passage beside their neighbours: the force of a healthy line repeats from span to span.

The median of the neighbouring spans is subtracted from every span. What remains is averaged over the extent of a
defect, and compared with its own robust standard deviation nearby. The threshold is that of the largest value per block
in clean track. For a Gaussian process, the square of this value has a Gumbel distribution (Rice's formula); here, its
median and scale are those of all blocks, of which defects are a small part.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from pantocheck.conformance.core.array_types import RealArray

GRID_M = 0.5
"""Distance of the samples along the track [m]."""

SHORTEST_SPAN_M, LONGEST_SPAN_M = 30.0, 90.0
"""Lengths of a span [m]."""

NEIGHBOURS, FEWEST_NEIGHBOURS = 10, 4
"""Number of the nearest spans that a span is compared with, and the smallest number of them with the same length."""

SAME_LENGTH_SHARE = 0.03
"""Largest difference of the lengths of two spans that are compared [-]."""

PERIODIC = 0.3
"""Smallest autocorrelation at the length of a span that shows spans without a table of supports [-]."""

TILE_M = 1000.0
"""Stretch over which the length of the spans is estimated [m]."""

EXTENTS_M = (3.0, 12.0, 30.0)
"""Extents of a defect [m]: a point of the contact wire, a dropper with its neighbours, a span."""

BLOCK_M, FEWEST_BLOCKS = 50.0, 40
"""Length of a block [m], and smallest number of blocks that has a threshold."""

FALSE_ALARMS_PER_1000_KM = 1.0
"""Places that are listed in 1,000 km of clean track, if its largest values follow this distribution."""

GAUSSIAN_SPREAD = 2.0
"""Smallest scale of the Gumbel distribution of a square: that of a Gaussian process."""

LEAST_SCATTER_SHARE = 0.005
"""Smallest robust standard deviation over the median force [-]."""


@dataclass(frozen=True)
class Deviation:
    """Place where the force differs from that of the neighbouring spans."""

    index: int
    """Sample of the grid."""
    deviation: float
    """Mean difference over the extent, in robust standard deviations of such means."""
    threshold: float
    """Size that clean track exceeds once in a stated length, at this extent."""
    extent_m: float


def find_spans(force: RealArray, supports: RealArray) -> RealArray:
    """Start and end of the spans of a passage, (n, 2) [m from the first sample].

    Args:
        force: Filtered force on the grid; NaN where it is not known.
        supports: Known supports in increasing order [m from the first sample]; if there are fewer than two, the length
            of the spans is that of the period of the force.
    """
    if supports.size > 1:
        return np.column_stack([supports[:-1], supports[1:]])
    edges, length = [0.0], 0.0
    while (start := edges[-1]) + LONGEST_SPAN_M < force.size * GRID_M:
        tile = force[int(start / GRID_M) : int((start + TILE_M) / GRID_M)]
        length = estimate_period(tile) or length or LONGEST_SPAN_M
        count = max(1, int(tile.size * GRID_M / length))
        edges += [start + length * (i + 1) for i in range(count)]
    return np.column_stack([edges[:-1], edges[1:]])


def estimate_period(force: RealArray) -> float:
    """Length of the spans of a stretch from the autocorrelation of its force [m]; 0 if the force has no period."""
    known = np.isfinite(force)
    if not known.any():
        return 0.0
    centred = np.where(known, force - force[known].mean(), 0.0)
    power = np.abs(np.fft.rfft(centred, 2 * centred.size)) ** 2
    lags = np.fft.irfft(power)[: centred.size] / np.arange(centred.size, 0, -1)
    periods = np.arange(SHORTEST_SPAN_M, LONGEST_SPAN_M, 0.1)
    repeats = [number for number in range(1, 6) if number * LONGEST_SPAN_M < 0.7 * centred.size * GRID_M]
    if not repeats or lags[0] <= 0:
        return 0.0
    score = np.mean([np.interp(n * periods / GRID_M, np.arange(lags.size), lags) for n in repeats], 0) / lags[0]
    if score.max() < PERIODIC:
        return 0.0
    first = int(np.flatnonzero(score > 0.9 * score.max())[0])  # a multiple of the length repeats as well
    near = slice(first, first + 20)
    return float(periods[near][np.argmax(score[near])])


def subtract_neighbours(force: RealArray, spans: RealArray) -> RealArray:
    """Difference from the median of the neighbouring spans; NaN where unknown.

    Args:
        force: Filtered force on the grid [N].
        spans: Start and end of the spans, (n, 2) [m].
    """
    rest = np.full(force.size, np.nan)
    lengths, grid = np.diff(spans, axis=1)[:, 0], GRID_M * np.arange(force.size)
    for number, (start, end) in enumerate(spans):
        first = max(0, min(number - NEIGHBOURS // 2, len(spans) - NEIGHBOURS - 1))
        near = np.arange(first, min(len(spans), first + NEIGHBOURS + 1))
        alike = np.abs(lengths[near] / lengths[number] - 1) <= SAME_LENGTH_SHARE
        near = near[alike & (near != number)]
        here = slice(max(0, int(np.ceil(start / GRID_M))), max(0, int(np.ceil(end / GRID_M))))
        share = (grid[here] - start) / lengths[number]
        others = np.interp(spans[near, :1] + share * lengths[near, None], grid, force, left=np.nan, right=np.nan)
        others = others[np.isfinite(others).all(axis=1)]
        if len(others) >= FEWEST_NEIGHBOURS:
            rest[here] = force[here] - np.median(others, axis=0)
    return rest


def scale_difference(rest: RealArray, force: RealArray) -> RealArray:
    """Difference from the neighbouring spans in robust standard deviations; parameters on the grid [N]."""
    least = LEAST_SCATTER_SHARE * abs(float(np.nanmedian(force))) if np.isfinite(force).any() else 1.0
    return rest / _find_scale(rest, least)


def find_deviations(rest: RealArray) -> Iterator[Deviation]:
    """Places of a passage, or of the mean of several, that differ from their neighbourhood; the first one first.

    Args:
        rest: Difference from the neighbouring spans on the grid.
    """
    if not np.isfinite(rest).any():
        return
    scaled = rest / _find_scale(rest, 1e-9)  # the mean of many passages scatters less than that of few
    count = len(_split(rest))
    ratio, found = np.zeros(count), [Deviation(0, 0.0, np.inf, 0.0)] * count
    for extent in EXTENTS_M:
        width = round(extent / GRID_M)
        mean = np.convolve(scaled, np.ones(width) / width, "same")
        deviations = _split(mean / max(1.4826 * float(np.nanmedian(np.abs(mean))), 1e-9))
        sizes = np.where(np.isfinite(deviations), np.abs(deviations), 0.0)
        peaks = sizes.max(axis=1)
        known = peaks > 0
        if known.sum() < FEWEST_BLOCKS:
            continue
        threshold = find_threshold(peaks[known])
        for number in np.flatnonzero(peaks / threshold > np.maximum(ratio, 1.0)):
            ratio[number] = peaks[number] / threshold
            column = int(np.argmax(sizes[number]))
            index = int(number) * sizes.shape[1] + column
            found[number] = Deviation(index, float(deviations[number, column]), threshold, extent)
    for group in np.split(np.arange(count), np.flatnonzero(ratio <= 1.0)):
        if ratio[group].max(initial=0.0) > 1.0:
            yield found[group[np.argmax(ratio[group])]]


def find_threshold(peaks: Sequence[float] | RealArray) -> float:
    """Size that the largest value of a block of clean track exceeds as often as a false alarm is accepted."""
    quarter, median, three_quarters = np.quantile(peaks, (0.25, 0.5, 0.75)) ** 2
    spread = max((three_quarters - quarter) / np.log(np.log(4) / np.log(4 / 3)), GAUSSIAN_SPREAD)
    share = FALSE_ALARMS_PER_1000_KM * BLOCK_M / 1e6 / len(EXTENTS_M)
    return float(np.sqrt(median + spread * (np.log(np.log(2)) - np.log(-np.log1p(-share)))))


def _split(values: RealArray) -> RealArray:
    """Blocks of the grid, (blocks, samples); the last one is filled with NaN."""
    size = round(BLOCK_M / GRID_M)
    return np.pad(values, (0, -values.size % size), constant_values=np.nan).reshape(-1, size)


def _find_scale(values: RealArray, least: float) -> RealArray:
    """Robust standard deviation of each sample: the median of those of its block and the five on either side."""
    sizes = np.abs(_split(values))
    medians = _take_medians(sizes)
    near = sliding_window_view(np.pad(medians, NEIGHBOURS // 2, constant_values=np.nan), NEIGHBOURS + 1)
    scale = np.fmax(least, 1.4826 * _take_medians(near))
    return np.asarray(np.repeat(scale, sizes.shape[1])[: values.size])


def _take_medians(rows: RealArray) -> RealArray:
    """Median of the known values of each row; NaN without any."""
    found = np.full(len(rows), np.nan)
    known = np.isfinite(rows).any(axis=1)
    found[known] = np.nanmedian(rows[known], axis=1)
    return found
