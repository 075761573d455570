"""Uncertainty from the sampling rate of a record, and from the resolution of its numbers.

Both are bounds of an error, not scatter. A value inside a limit counts only if it stays inside with both. A record with
fewer samples or digits therefore does not pass where the whole record fails.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Protocol

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import Evaluation, Value, ValuesByOwner
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.uncertainty import Component

SAME_NUMBER = 1e-7
"""Smallest step of a channel [SI unit]: a smaller one is rounding of the computer."""

SAME_RATE = 0.999
"""Share of a rate from which a record has the same rate."""


class ChannelSignals(Protocol):
    """Signals whose quantities can be computed from changed channels."""

    @property
    def pantographs(self) -> Mapping[int, PantographSignals]:
        """Signals by number from 1."""

    @property
    def line(self) -> LineSignals:
        """Uplift at the supports."""

    @property
    def evaluation(self) -> Evaluation:
        """Quantities over the analysis section."""

    def evaluate_channels(self, pantographs: Mapping[int, PantographSignals], line: LineSignals) -> Evaluation:
        """Quantities of other channels in the same section."""


def sampling_component(signals: ChannelSignals, full_rate_Hz: float | None) -> Component:
    """Uncertainty from the sampling rate: the largest change when every second sample is left out.

    The error of every usual method falls at least in proportion to the interval of the samples. It is then at most the
    change when this interval is doubled. A quantity that half of the samples do not give has no half-width.

    Args:
        signals: Signals of the record.
        full_rate_Hz: Rate at which the case is computed; a record at this rate loses nothing. None: not known.
    """
    rate = min(pantograph.rate for pantograph in signals.pantographs.values())
    if full_rate_Hz is not None and rate >= SAME_RATE * full_rate_Hz:
        return Component("sampled at the rate of the case", _fill(signals.evaluation.values, 0.0))
    thinned = [_thin(signals, first) for first in (0, 1)]
    return Component(
        f"every second sample of {rate:.6g} per second left out", _find_changes(signals.evaluation.values, [thinned])
    )


def resolution_component(signals: ChannelSignals) -> Component:
    """Uncertainty from the steps of the recorded numbers: the largest change by half a step.

    Half a step is added to all samples, and to those above the mean while it is taken from those below, both ways.
    Mean and extremes change most by the first, and standard deviations by the second.

    Args:
        signals: Signals of the record.
    """
    steps = {number: find_step(pantograph.force.delivered) for number, pantograph in signals.pantographs.items()}
    shifted = [_move(signals, partial(_point_one_way, sign)) for sign in (-1.0, 1.0)]
    spread = [_move(signals, partial(_point_outwards, sign)) for sign in (-1.0, 1.0)]
    text = ", ".join(f"{step:.3g} N" for step in dict.fromkeys(steps.values()))
    return Component(f"force in steps of {text}", _find_changes(signals.evaluation.values, [shifted, spread]))


def find_step(series: RealArray) -> float:
    """Step of the numbers of a channel: the smallest difference of two of its values; 0 for a constant channel."""
    differences = np.diff(np.unique(series[np.isfinite(series)]))
    distinct = differences[differences > SAME_NUMBER]
    return float(distinct.min()) if distinct.size else 0.0


def _point_one_way(sign: float, series: RealArray) -> RealArray:
    """The same sign for every sample."""
    return np.full(series.shape, sign)


def _point_outwards(sign: float, series: RealArray) -> RealArray:
    """Sign of the distance of each sample from the mean, times a sign."""
    known = series[np.isfinite(series)]
    return np.asarray(sign * np.sign(series - (known.mean() if known.size else 0.0)))


def _thin(signals: ChannelSignals, first: int) -> Evaluation:
    """Quantities of every second sample."""
    pantographs = {
        number: replace(
            pantograph,
            position=pantograph.position[first::2],
            force=replace(
                pantograph.force, delivered=pantograph.force.delivered[first::2], rate=pantograph.force.rate / 2
            ),
            contact_height=_select(pantograph.contact_height, first),
            arc_channels=_select(pantograph.arc_channels, first),
        )
        for number, pantograph in signals.pantographs.items()
    }
    line = replace(
        signals.line,
        support_uplift=_select(signals.line.support_uplift, first),
        last_position=_select(signals.line.last_position, first),
    )
    return signals.evaluate_channels(pantographs, line)


def _select(channel: RealArray | None, first: int) -> RealArray | None:
    return None if channel is None else channel[..., first::2]


def _move(signals: ChannelSignals, direction: Callable[[RealArray], RealArray]) -> Evaluation:
    """Quantities of channels whose samples are moved by half a step of each channel in a direction of +1 or -1."""

    def move(series: RealArray) -> RealArray:
        return np.asarray(series + find_step(series) / 2 * direction(series))

    pantographs = {
        number: replace(
            pantograph,
            force=replace(pantograph.force, delivered=move(pantograph.force.delivered)),
            contact_height=None if pantograph.contact_height is None else move(pantograph.contact_height),
        )
        for number, pantograph in signals.pantographs.items()
    }
    uplift = signals.line.support_uplift
    line = replace(signals.line, support_uplift=None if uplift is None else np.array([move(row) for row in uplift]))
    return signals.evaluate_channels(pantographs, line)


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
            if all(len(numbers) == len(group) for numbers, group in zip(others, groups, strict=True)):
                changes.setdefault(owner, {})[name] = sum(max(abs(x - value) for x in group) for group in others)
    return changes


def _select_numbers(owner: int, name: str, evaluations: Sequence[Evaluation]) -> list[float]:
    """Numbers of a quantity in those evaluations that have it."""
    found = [each.values.get(owner, {}).get(name) for each in evaluations]
    return [number for number in found if isinstance(number, float | int)]
