"""Scale of an axis of a figure: limits from the data, ticks at round numbers, and their labels."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from pantocheck.conformance.core.array_types import RealArray

ROUND_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Distances of ticks that a reader counts without effort, times a power of ten."""

MOST_INTERVALS = 9
"""Largest number of intervals between ticks: more do not help a reader."""


def list_round_numbers(low: float, high: float, intervals: int) -> list[float]:
    """Multiples of a round step between two numbers, in at most this number of intervals, with at least two ticks."""
    raw = (high - low) / max(intervals, 1)
    if not raw > 0:
        return [low]
    decade = 10.0 ** math.floor(math.log10(raw))
    steps = [step * decade / 10 for step in ROUND_STEPS[:-1]] + [step * decade for step in ROUND_STEPS]
    fitting = next(number for number, step in enumerate(steps) if step >= raw * (1 - 1e-12))
    for step in reversed(steps[: fitting + 1]):
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last - first >= 1:
            break
    return [number * step for number in range(first, last + 1)]


def label_ticks(ticks: Sequence[float]) -> list[str]:
    """Ticks as plain numbers with the same number of decimals."""
    places = np.array(ticks)
    size = math.floor(math.log10(float(np.ptp(places)) or 1.0)) if places.size > 1 else 0
    decimals = next((n for n in range(10) if abs(places - places.round(n)).max(initial=0) < 1e-3 * 10.0**size), 10)
    return [f"{value:.{decimals}f}".replace("-", "\N{MINUS SIGN}") for value in places.round(decimals) + 0.0]


@dataclass
class AxisScale:
    """Axis of a panel: its data, limits and ticks."""

    margin: float = 0.0
    """Space beyond the data at both ends, as a share of their range."""
    limits: tuple[float | None, float | None] = (None, None)
    """Stated limits; None: from the data."""
    intervals: int = MOST_INTERVALS
    """Largest number of intervals between ticks."""
    ticks: Sequence[float] | None = None
    labels: Sequence[str] | None = None
    """Stated ticks and labels; None: round numbers, and plain numbers."""
    write: Callable[[float], str] | None = None
    """Label of a tick, in place of a plain number."""
    has_labels: bool = True
    name: str = ""
    ends: list[tuple[float, float]] = field(default_factory=list)
    """Smallest and largest value of each drawn part."""

    def include(self, values: RealArray | Sequence[float]) -> None:
        """Make room for values."""
        numbers = np.asarray(values, dtype=np.float64)
        numbers = numbers[np.isfinite(numbers)]
        if numbers.size:
            self.ends.append((float(numbers.min()), float(numbers.max())))

    def find_ends(self) -> tuple[float, float]:
        """Ends of the axis, which hold the stated ticks."""
        low, high = (min(end[0] for end in self.ends), max(end[1] for end in self.ends)) if self.ends else (0.0, 1.0)
        if low == high:
            space = 0.05 * (abs(low) or 1.0)
            low, high = low - space, high + space
        margin = self.margin * (high - low)
        below, above = self.limits
        low, high = low - margin if below is None else below, high + margin if above is None else above
        return min([low, *(self.ticks or ())]), max([high, *(self.ticks or ())])

    def list_ticks(self) -> tuple[list[float], list[str]]:
        """Places and labels of the ticks inside the limits."""
        ticks = list_round_numbers(*self.find_ends(), self.intervals) if self.ticks is None else [*self.ticks]
        labels = self.labels or (label_ticks(ticks) if self.write is None else [self.write(tick) for tick in ticks])
        return ticks, [label if self.has_labels else "" for label in labels]
