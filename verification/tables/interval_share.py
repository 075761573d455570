"""Judgement of stated 95 % intervals by the share of them that contains the true value.

Outcomes of a row, by that share and its 95 % confidence interval (Wilson):

    FAIL             the share is outside of 93 % to 97 %
    93 to 97 %       the share is inside, but the confidence interval excludes 95 %
    shortfall width  the median half-width is more than 1.5 times the smallest one with correct coverage
    95 %             none of these
    too few          fewer than 1,000 intervals, and the confidence interval reaches into 93 % to 97 %

The confidence interval of a correct interval of 95 % excludes 95 % in 5 % of the rows.
"""

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pantocheck.conformance.campaigns.sample_statistics import wilson_interval

SHARE_COLUMNS = "intervals | contained [%] | confidence [%] | width ratio"
"""Heads of the columns of `IntervalShare.text`."""


FEWEST = 1000
"""Fewest intervals of a row for an outcome other than FAIL."""


class IntervalShare(NamedTuple):
    """Intervals of one row."""

    count: int
    """Number of intervals."""
    contained: int
    """Number of those that contain the true value."""
    width_ratio: float
    """Median half-width over the smallest one with correct coverage."""

    @property
    def share(self) -> float:
        """Share that contains the true value [%]."""
        return 100 * self.contained / self.count

    @property
    def confidence(self) -> tuple[float, float]:
        """95 % confidence interval of the share (Wilson) [%]."""
        lower, upper = wilson_interval(self.contained, self.count)
        return 100 * lower, 100 * upper

    @property
    def outcome(self) -> str:
        """Outcome by the rule of this module."""
        lower, upper = self.confidence
        if self.count < FEWEST and lower <= 97 and upper >= 93:
            return "too few"
        if not 93 <= self.share <= 97:
            return "FAIL"
        if self.width_ratio > 1.5:
            return "shortfall width"
        return "95 %" if lower <= 95 <= upper else "93 to 97 %"

    @property
    def text(self) -> str:
        """Cells of a table in Markdown."""
        lower, upper = self.confidence
        return f"{self.count} | {self.share:.1f} | {lower:.1f} to {upper:.1f} | {self.width_ratio:.2f}"


def read_rows(path: Path) -> list[dict[str, str]]:
    """Rows of a store; none if it does not exist."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def append_row(path: Path, row: Mapping[str, object]) -> None:
    """Append a row to a store; a new one begins with the keys."""
    new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(row), lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerow(row)


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table in Markdown."""
    head = f"| {' | '.join(heads)} |"
    print(f"\n{head}\n{'|---' * (head.count('|') - 1)}|")
    for row in rows:
        print(f"| {' | '.join(row)} |", flush=True)
