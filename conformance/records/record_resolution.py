"""Uncertainty from the sampling rate of a record, and from the resolution of its numbers.

Both are bounds of an error, not scatter. A value inside a limit counts only if it stays inside with both. A record with
fewer samples or digits therefore does not pass where the whole record fails.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import ChannelSignals, Evaluation, Value, ValuesByOwner
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.uncertainty import Component

SAME_NUMBER = 1e-7
"""Smallest step of a channel [SI unit]: a smaller one is rounding of the computer."""

SAME_MULTIPLE = 0.05
"""Largest distance of a difference from a multiple of the step, in steps: numbers are converted between units."""

MEAN_TIMES_S = (0.2, 0.05)
"""Times of the moving means that separate the bands from 5 and from 20 Hz [s]."""

CANDIDATES, ROUNDED_SHARE = 5, 0.8
"""Number of the smallest differences that may be the step, and share of its multiples: clipped samples are none."""

CUBIC, STRAIGHT = (9 / 16, -1 / 16), (1 / 2, 0.0)
"""Weights of the two nearer and of the two farther neighbours at equal distances, for values halfway between them."""

SINGLE_EXTREMES = frozenset(quantity.name for quantity in PANTOGRAPH_QUANTITIES if quantity.extreme) | frozenset(
    quantity.name for quantity in LINE_QUANTITIES
)
"""Quantities that are the value of one sample."""

SAME_RATE = 0.999
"""Share of a rate from which a record has the same rate."""


def sampling_component(signals: ChannelSignals, full_rate_Hz: float | None) -> Component:
    """Uncertainty from the sampling rate: changes when samples are left out, and when all lie half an interval later.

    The error of every usual method falls at least in proportion to the interval of the samples. It is then at most the
    change when this interval is doubled. The samples that are left out are interpolated by cubic polynomials, so that
    every quantity of the record can be computed. The section also gains or loses a sample at each end.

    The extreme of a curve lies between two samples. Left-out samples on straight lines bound its distance from the
    nearer sample up to 0.41 intervals, and samples half an interval later bound the rest.

    Args:
        signals: Signals of the record.
        full_rate_Hz: Rate at which the case is computed; a record at this rate loses nothing. None: not known.
    """
    rate = min(pantograph.rate for pantograph in signals.pantographs.values())
    if full_rate_Hz is not None and rate >= SAME_RATE * full_rate_Hz:
        return Component("sampled at the rate of the case", _fill(signals.evaluation.values, 0.0))
    thinned = [_change_samples(signals, partial(replace_samples, first, CUBIC)) for first in (0, 1)]
    straight = [_change_samples(signals, partial(replace_samples, first, STRAIGHT)) for first in (0, 1)]
    later = [_change_samples(signals, interpolate_halfway)]
    first = next(iter(signals.pantographs.values()))
    start, end = first.section
    step = float(np.median(np.diff(first.position)))
    sections = [(start - step, end), (start + step, end), (start, end - step), (start, end + step)]
    moved = [signals.evaluate_section(section) for section in sections]
    values, groups = signals.evaluation.values, [thinned, moved, later]
    extremes = {
        owner: {name: value for name, value in quantities.items() if name in SINGLE_EXTREMES}
        for owner, quantities in values.items()
    }
    widths, wider = _find_changes(values, groups), _find_changes(extremes, [*groups, straight])
    return Component(
        f"every second of {rate:.6g} samples per second left out, samples half an interval later, and ends of the "
        "section moved by a sample",
        {owner: {**quantities, **wider.get(owner, {})} for owner, quantities in widths.items()},
    )


def resolution_component(signals: ChannelSignals) -> Component:
    """Uncertainty from the steps of the recorded numbers: the largest change by half a step.

    Half a step is added to all samples, or taken from them. Half a step is also added to those above a moving mean, and
    taken from those below, both ways: over the record for the standard deviation, and over shorter times for the bands.
    Mean and extremes change most by the first, and standard deviations by the second.

    Args:
        signals: Signals of the record.
    """
    forces = [pantograph.force.delivered for pantograph in signals.pantographs.values()]
    heights = [pantograph.contact_height for pantograph in signals.pantographs.values()]
    uplifts = [] if signals.line.support_uplift is None else [*signals.line.support_uplift]
    steps = [find_step(series) for series in (*forces, *heights, *uplifts) if series is not None]
    if not any(steps):
        return Component("no steps found in the numbers of the record", _fill(signals.evaluation.values, 0.0))
    rate = min(pantograph.rate for pantograph in signals.pantographs.values())
    one_way = [partial(np.full_like, fill_value=sign) for sign in (-1.0, 1.0)]
    shifted = [_change_samples(signals, partial(move_samples, direction)) for direction in one_way]
    windows = [0, *(round(seconds * rate) for seconds in MEAN_TIMES_S)]
    directions = [partial(_point_outwards, sign, window) for sign in (-1.0, 1.0) for window in windows]
    spread = [_change_samples(signals, partial(move_samples, direction)) for direction in directions]
    text = ", ".join(f"{step:.3g} N" for step in dict.fromkeys(map(find_step, forces)))
    return Component(f"force in steps of {text}", _find_changes(signals.evaluation.values, [shifted, spread]))


def find_step(series: RealArray) -> float:
    """Step of the numbers of a channel: a small difference of two values, if nearly all samples are multiples of it.

    A channel without such a step, and a constant one, have the step 0.
    """
    return _find_step(series.tobytes())


@lru_cache(maxsize=256)
def _find_step(samples: bytes) -> float:
    series = np.frombuffer(samples)
    known = series[np.isfinite(series)]
    differences = np.diff(values := np.unique(known))
    for step in np.sort(differences[differences > SAME_NUMBER])[:CANDIDATES]:
        multiples = (known - values[values.size // 2]) / step
        if np.mean(np.abs(multiples - np.round(multiples)) < SAME_MULTIPLE) > ROUNDED_SHARE:
            return float(step)
    return 0.0


def _point_outwards(sign: float, window: int, series: RealArray) -> RealArray:
    """Sign of the distance of each sample from the mean of a window of samples, times a sign; 0: the whole channel."""
    known = np.isfinite(series)
    filled = np.where(known, series, series[known].mean() if known.any() else 0.0)
    mean = _moving_mean(filled, window) if window > 1 else filled.mean()
    distance = series - mean
    equal = np.abs(distance) <= SAME_NUMBER  # rounding of the sums would decide the sign
    return np.asarray(sign * np.sign(np.where(equal, 0.0, distance)))


def _moving_mean(series: RealArray, window: int) -> RealArray:
    """Mean of the samples of a window around each; the series is mirrored at its ends."""
    level = series.mean()
    sums = np.cumsum(np.pad(series - level, (window // 2 + 1, window - window // 2 - 1), mode="symmetric"))
    return np.asarray(level + (sums[window:] - sums[:-window]) / window)


def replace_samples(first: int, weights: tuple[float, float], series: RealArray) -> RealArray:
    """Replace every second sample by its four neighbours.

    A sample beside a missing one stays.

    Args:
        first: First sample that is replaced, 0 or 1.
        weights: Weight of each of the two nearer and of the two farther neighbours.
        series: Samples, (n,).
    """
    padded = np.pad(series, 3, mode="reflect") if series.size > 3 else np.pad(series, 3, mode="edge")
    between = weights[0] * (padded[2:-4] + padded[4:-2]) + weights[1] * (padded[:-6] + padded[6:])
    changed = np.where(np.isfinite(between), between, series)
    changed[1 - first :: 2] = series[1 - first :: 2]
    return changed


def interpolate_halfway(series: RealArray) -> RealArray:
    """Values half an interval after each sample, by cubic polynomials; a sample beside a missing one stays."""
    padded = np.pad(series, (1, 2), mode="edge")
    between = CUBIC[0] * (padded[1:-2] + padded[2:-1]) + CUBIC[1] * (padded[:-3] + padded[3:])
    return np.where(np.isfinite(between), between, series)


def move_samples(direction: Callable[[RealArray], RealArray], series: RealArray) -> RealArray:
    """Move the samples of a channel by half of its step in a direction of +1 or -1."""
    return np.asarray(series + find_step(series) / 2 * direction(series))


def _change_samples(signals: ChannelSignals, change: Callable[[RealArray], RealArray]) -> Evaluation:
    """Quantities of changed channels of force, contact height and uplift."""
    pantographs = {
        number: replace(
            pantograph,
            force=replace(pantograph.force, delivered=change(pantograph.force.delivered)),
            contact_height=None if pantograph.contact_height is None else change(pantograph.contact_height),
        )
        for number, pantograph in signals.pantographs.items()
    }
    uplift = signals.line.support_uplift
    if uplift is not None and uplift.size:
        uplift = np.array([change(row) for row in uplift])
    return signals.evaluate_channels(pantographs, replace(signals.line, support_uplift=uplift))


def _fill(values: ValuesByOwner, number: float) -> ValuesByOwner:
    """The same half-width for every quantity with one value."""
    return {
        owner: {name: number for name, value in quantities.items() if not isinstance(value, tuple)}
        for owner, quantities in values.items()
    }


def _find_changes(values: ValuesByOwner, groups: Sequence[Sequence[Evaluation]]) -> ValuesByOwner:
    """Sum over groups of the largest change of each quantity in the evaluations of a group."""
    changes: dict[int, dict[str, Value]] = {}
    for owner, quantities in values.items():
        for name, value in quantities.items():
            if isinstance(value, tuple):
                continue
            others = [_select_numbers(owner, name, group) for group in groups]
            if all(others):
                changes.setdefault(owner, {})[name] = sum(max(abs(x - value) for x in group) for group in others)
    return changes


def _select_numbers(owner: int, name: str, evaluations: Sequence[Evaluation]) -> list[float]:
    """Numbers of a quantity in those evaluations that have it."""
    found = [each.values.get(owner, {}).get(name) for each in evaluations]
    return [number for number in found if isinstance(number, float | int)]
