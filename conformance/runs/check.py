"""Check of a record, and the finding it can return."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record_signals import RecordSignals

CheckName = Literal[
    "coverage",
    "motion",
    "support passing",
    "coincidence",
    "roll-off",
    "dynamics",
    "implied force",
    "mean force",
    "content",
    "copy",
]


@dataclass(frozen=True)
class Finding:
    """Finding of a check."""

    kind: Literal["contradiction", "doubt", "unchecked"]
    """`contradiction` (the record cannot be graded), `doubt` (a warning), `unchecked` (the record lacks a channel)."""
    text: str
    """One line for the reader of the report."""


def worst_finding(findings: Iterable[Finding]) -> Finding | None:
    """First contradiction, or first doubt, or first check not made; None without findings."""
    return min(findings, key=lambda finding: ("contradiction", "doubt", "unchecked").index(finding.kind), default=None)


@dataclass(frozen=True)
class Check:
    """Consistency check of a record."""

    name: CheckName
    """Name in messages and documents."""
    must_hold: str
    """Condition on the record."""
    why: str
    """Fault that would otherwise go unnoticed."""
    needs: str
    """Channels without which the check is not made."""
    run: Callable[[Case, RecordSignals], Finding | None]
    """Function of the case and the signals of the record; returns a finding, or None if the condition holds."""
