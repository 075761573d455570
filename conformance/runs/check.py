"""Check of a record, the finding it can return, and measures of a channel that several checks share."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
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


def report_not_made(check: CheckName, reason: str) -> Finding:
    """Finding of a check that the record does not allow."""
    return Finding("unchecked", f"the {check} check was not made: {reason}")


def report_low_rate(check: CheckName, rate: float) -> Finding:
    """Finding of a check that the rate of a record [Hz] does not allow."""
    return report_not_made(check, f"a rate of {rate:g} Hz is too low")


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
