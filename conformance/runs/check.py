"""Check of a record, the finding it can return, and measures of a channel that several checks share."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.check_row import (
    MISGIVINGS,
    Cause,
    Measured,
    Misgiving,
    NotMeasured,
    RowBasis,
    RowOutcome,
)
from pantocheck.conformance.core.results_part import LARGEST_RESULT
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

    basis: RowBasis
    """Number with its thresholds, or the cause of an outcome without a number."""
    text: str = ""
    """One line for the reader of the report; empty if the check confirms the record."""

    @property
    def kind(self) -> RowOutcome:
        """`contradiction` (not graded), `doubt` (a warning), `unchecked` (the record lacks a channel), `confirmed`."""
        return self.basis.outcome


HOLDS, DOES_NOT_APPLY, NAMED_ELSEWHERE = (
    Finding(NotMeasured(cause=cause)) for cause in ("holds", "does not apply", "named by another check")
)


@dataclass(frozen=True)
class Measure:
    """Number that a check compares with thresholds."""

    name: str
    """Name of the number."""
    unit: str
    """Unit; empty for a ratio."""
    thresholds: Mapping[Misgiving, float]
    """Thresholds by the outcome beyond them."""
    side: Literal["above", "below"] = "above"
    """Side of the thresholds on which the condition does not hold."""
    for_filtered: bool = False
    """Whether the number can decide only where the force was delivered filtered."""

    def compare(self, number: float, part: str = "", text: str = "") -> Finding:
        """Finding on a number of a part of the record; a number that is not known lies beyond every threshold.

        Args:
            number: Number in the unit of the measure.
            part: Pantograph or support; empty for the whole record.
            text: Text of the finding beyond a threshold.
        """
        worst = LARGEST_RESULT if self.side == "above" else -LARGEST_RESULT
        known = worst if np.isnan(number) else float(np.clip(number, -LARGEST_RESULT, LARGEST_RESULT))
        basis = Measured(
            measure=self.name,
            number=known,
            unit=self.unit,
            side=self.side,
            thresholds=dict(self.thresholds),
            part=part,
        )
        return Finding(basis, "" if basis.outcome == "confirmed" else text)


def report_missing(text: str) -> Finding:
    """Finding of a check for which the record lacks a channel, or its resolution."""
    return Finding(NotMeasured(cause="not possible"), text)


def report_not_made(check: CheckName, reason: str) -> Finding:
    """Finding of a check that the record does not allow."""
    return report_missing(f"the {check} check was not made: {reason}")


def report_low_rate(check: CheckName, rate: float) -> Finding:
    """Finding of a check that the rate of a record [Hz] does not allow."""
    return report_not_made(check, f"a rate of {rate:g} Hz is too low")


def worst_finding(findings: Iterable[Finding]) -> Finding:
    """Worst finding, with the number that is nearest to its threshold; without findings, the check does not apply."""
    return min(findings, key=_rank, default=DOES_NOT_APPLY)


def _rank(finding: Finding) -> tuple[int, float]:
    """The worst finding has the smallest rank."""
    kinds: tuple[RowOutcome, ...] = (*MISGIVINGS, "confirmed")
    basis = finding.basis
    return kinds.index(finding.kind), -basis.utilisation if isinstance(basis, Measured) else np.inf


@dataclass(frozen=True)
class Check:
    """Consistency check of a record."""

    name: CheckName
    """Name in messages and documents."""
    must_hold: str
    """Condition on the record."""
    purpose: str
    """Fault that would otherwise go unnoticed."""
    needs: str
    """Channels without which the check is not made."""
    run: Callable[[Case, RecordSignals], Finding]
    """Function of the case and the signals of the record."""
    measures: tuple[Measure, ...] = ()
    """Numbers that can decide the check."""
    causes: tuple[Cause, ...] = ("not possible",)
    """Causes of an outcome without a number."""


# Measures of a channel.
TINY = float(np.finfo(float).tiny)
"""Smallest divisor."""

COARSEST_STEP_M = 0.5e-3
"""Steps of a rounded height or uplift from which they confirm nothing [m]; the error of steps of 0.1 mm is accepted."""

SMALLEST_STEP = 1e-9
"""Differences that binary numbers make of equal decimal ones [m]."""


def rounding_step(values: RealArray) -> float:
    """Smallest difference between two values [m]: the step to which they are rounded; infinite for a constant.

    Args:
        values: Samples of a channel, (n,) [m].
    """
    steps = np.diff(np.unique(values))
    return float(steps[steps > SMALLEST_STEP].min(initial=np.inf))


def windowed_spectrum(signal: RealArray, rate: float) -> tuple[RealArray, RealArray]:
    """Frequencies [Hz] and amplitudes of a signal about its mean, with a Hann window; amplitudes have no scale."""
    frequency = np.asarray(np.fft.rfftfreq(signal.size, 1 / rate), dtype=np.float64)
    return frequency, np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size)))
