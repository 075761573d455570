"""Calibration of half-widths: share of the true changes that they contain, and the ratio of change to half-width."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from pantocheck.conformance.quantities.evaluation import ValuesByOwner

Key = tuple[str, int, str]
"""Case, pantograph (0: the line) and quantity."""

TARGET = 0.95
"""Share of the changes that the half-widths should contain."""


@dataclass(frozen=True)
class Entry:
    """A value, its half-width, and the true changes that the half-width should contain."""

    value: float
    half_width: float
    changes: tuple[float, ...]

    @property
    def contained(self) -> int:
        """Number of changes within the half-width; rounding of a millionth of the value counts as equal."""
        return sum(abs(change) <= self.half_width + 1e-6 * abs(self.value) for change in self.changes)

    @property
    def largest(self) -> float:
        """Largest change."""
        return max(map(abs, self.changes))

    @property
    def is_trivial(self) -> bool:
        """Whether the quantity does not change at all."""
        return self.largest <= 1e-6 * abs(self.value)


@dataclass(frozen=True)
class Calibration:
    """Entries by case, pantograph and quantity."""

    entries: Mapping[Key, Entry]

    def join(self, other: "Calibration") -> "Calibration":
        """Entries of both."""
        return Calibration({**self.entries, **other.entries})

    def print_table(self) -> None:
        """Print the entries in Markdown."""
        print("\n| case | quantity | of | value | half-width | largest change | ratio | contained |")
        print("| :-- | :-- | --: | --: | --: | --: | --: | --: |")
        for (case, owner, name), entry in self.entries.items():
            if not entry.is_trivial:
                ratio = entry.largest / entry.half_width if entry.half_width else float("inf")
                share = f"{entry.contained} of {len(entry.changes)}"
                numbers = f"{entry.value:.3f} | {entry.half_width:.3f} | {entry.largest:.3f} | {ratio:.2f} | {share}"
                print(f"| `{case}` | `{name}` | {owner or 'line'} | {numbers} |", flush=True)

    def print_summary(self) -> None:
        """Print the share of contained changes and the median ratio of all entries that change."""
        entries = [entry for entry in self.entries.values() if not entry.is_trivial]
        changes = sum(len(entry.changes) for entry in entries)
        contained = sum(entry.contained for entry in entries)
        ratios = [entry.largest / entry.half_width for entry in entries if entry.half_width]
        print(
            f"\n{len(entries)} entries; {contained} of {changes} changes contained: {100 * contained / changes:.1f} %"
        )
        print(f"(target {100 * TARGET:g} %). Median ratio of largest change to half-width: {median(ratios):.2f}.")


def build_calibration(
    case: str, values: ValuesByOwner, half_widths: ValuesByOwner, others: Sequence[ValuesByOwner]
) -> Calibration:
    """Entries of all quantities with one value and a half-width; `others` are the values that should be contained."""
    entries = {}
    for owner, quantities in half_widths.items():
        for name, half_width in quantities.items():
            value, found = values[owner][name], [other.get(owner, {}).get(name) for other in others]
            changes = tuple(
                number - value for number in found if isinstance(number, float) and isinstance(value, float)
            )
            if changes and isinstance(value, float) and isinstance(half_width, float):
                entries[case, owner, name] = Entry(value, half_width, changes)
    return Calibration(entries)
