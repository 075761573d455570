"""Changes of the contact force by another damping model, and their range over shifted analysis sections."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from pantocheck.conformance.grading.record_uncertainty import MIN_SECTIONS, largest_changes
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.records.record_signals import RecordSignals

COMPARED_QUANTITIES = ("cov_20", "cov_50", *BAND_QUANTITIES)
"""Quantities of Table 1 of Vo Van, Balmes and Lorang (2015)."""

CHANGES = {quantity: f"change_{quantity.removesuffix('_N')}_pct" for quantity in COMPARED_QUANTITIES}
"""Name of the change of each quantity."""


@dataclass(frozen=True)
class ForceChanges:
    """Changes between two runs, over the analysis section and over shifted sections."""

    values: dict[int, dict[str, Value]]
    """Changes by pantograph (0: the line) and name."""
    shifted: tuple[dict[int, dict[str, Value]], ...] = field(default_factory=tuple)
    """The same over each of the shifted sections."""

    @property
    def spread(self) -> dict[int, dict[str, float]]:
        """Largest difference of each change from its value when the analysis section is shifted, in its unit."""
        return largest_changes(self.values, self.shifted, MIN_SECTIONS)

    def list_shifted(self, owner: int, name: str) -> list[float]:
        """Values of a change over the shifted sections, as far as they are known."""
        found = (part.get(owner, {}).get(name) for part in self.shifted)
        return [value for value in found if isinstance(value, float)]


def compare_damping_runs(
    before: RecordSignals, after: RecordSignals, sections: Sequence[tuple[float, float]] = ()
) -> ForceChanges:
    """Changes between two runs of a case.

    Args:
        before, after: Signals with the earlier damping and with that of the case.
        sections: Shifted analysis sections [m, m].
    """
    shifted = (
        force_changes(before.evaluate_section(section).values, after.evaluate_section(section).values)
        for section in sections
    )
    return ForceChanges(force_changes(before.evaluation.values, after.evaluation.values), tuple(shifted))


def force_changes(before: ValuesByOwner, after: ValuesByOwner) -> dict[int, dict[str, Value]]:
    """Changes of the statistics of the contact force [%].

    Args:
        before, after: Quantities by pantograph and name.

    Returns:
        Changes by pantograph and name, without those that one side lacks. The line holds the comparison of the first
        with the last pantograph.
    """
    findings: dict[int, dict[str, Value]] = {}
    for pantograph in before.keys() & after.keys() - {LINE}:
        findings[pantograph] = {}
        for quantity, name in CHANGES.items():
            old, new = before[pantograph].get(quantity), after[pantograph].get(quantity)
            if isinstance(old, float) and isinstance(new, float) and old > 0:
                findings[pantograph][name] = 100 * (new / old - 1)
    line = _compare_pantographs(findings, (before, after), last=max(findings, default=1))
    return {**findings, LINE: line} if line else findings


def _compare_pantographs(
    changes: Mapping[int, Mapping[str, Value]], runs: Sequence[ValuesByOwner], last: int
) -> dict[str, Value]:
    """First and last pantograph: difference of the changes in 20-50 Hz, smallest ratio of the variations."""
    if last == 1:
        return {}
    line: dict[str, Value] = {}
    rear, front = (changes.get(pantograph, {}).get(CHANGES["rms_20_50_N"]) for pantograph in (last, 1))
    if isinstance(rear, float) and isinstance(front, float):
        line["rear_over_front_change_20_50_pct"] = rear - front
    variations = [[run.get(pantograph, {}).get("cov_20") for pantograph in (1, last)] for run in runs]
    ratios = [
        first / other
        for first, other in variations
        if isinstance(first, float) and isinstance(other, float) and other > 0
    ]
    if len(ratios) == len(runs):
        line["front_over_rear_cov_20"] = min(ratios)
    return line
