"""Evaluation of a delivery: signals, quantities, errors and consistency findings, each computed once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import CheckName, Finding
from pantocheck.conformance.consistency.record_checks import check_record
from pantocheck.conformance.consistency.record_state import record_state
from pantocheck.conformance.grading.criterion_grading import GradedValues, grade_limit
from pantocheck.conformance.grading.record_mismatch import find_other_case, find_record_mismatch
from pantocheck.conformance.grading.start_agreement import StartAgreement, compare_starts
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.signals import edge_warnings
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.results_format import Criterion, RecordFacts

MIN_SECTIONS = 3
"""Smallest number of shifted sections that give a spread."""


@dataclass(frozen=True)
class CaseEvaluation:
    """A delivery of a system, evaluated for its case.

    Parameters
    ----------
    case : Case
        Case with its limits.
    delivered : Delivered
        Data that the system delivered.
    """

    case: Case
    delivered: Delivered

    @cached_property
    def mismatch(self) -> str | None:
        """Reason why the delivery does not belong to the case; None if it does."""
        case, record = self.case, self.delivered.record
        if (other := find_other_case(case, self.delivered.case_digest)) is not None:
            return other
        for name in sorted(self.delivered.static):
            if name not in QUANTITIES:
                return f"the system delivered an unknown quantity {name!r}"
            if QUANTITIES[name].scope != "static":
                return f"the system delivered {name!r} in 'static', but this quantity is computed from the record"
        if case.is_static:
            return None
        if record is None:
            return None if self.delivered.summary is not None else "the system delivered no record"
        return find_record_mismatch(case, record)

    @cached_property
    def signals(self) -> RecordSignals | None:
        """Signals of the record; None if the system delivered no record."""
        record = self.delivered.record
        return None if record is None else self._signals(record)

    @cached_property
    def values(self) -> GradedValues:
        """Quantities with discretisation error and section spread."""
        refined = self.delivered.refined
        return GradedValues(
            evaluation=_complete(self.delivered, None if self.signals is None else self.signals.evaluation),
            refined=None
            if refined is None
            else _complete(refined, None if refined.record is None else self._signals(refined.record).evaluation),
            spread={} if self.signals is None else section_spread(self.signals, self.case.shifted_sections),
        )

    @cached_property
    def findings(self) -> dict[CheckName, Finding]:
        """Findings of the consistency checks."""
        return {} if self.signals is None else check_record(self.case, self.signals)

    @cached_property
    def contradiction(self) -> str | None:
        """Text of the contradiction that the checks found; None if there is none."""
        return next((finding.text for finding in self.findings.values() if finding.kind == "contradiction"), None)

    @cached_property
    def start_agreement(self) -> StartAgreement:
        """Agreement of the stated start with that of the case."""
        return compare_starts(self.case, self.delivered.start)

    @cached_property
    def record_facts(self) -> RecordFacts | None:
        """State of the record; None for a case without a record."""
        digests = {"digest": self.delivered.digest, "case_digest": self.delivered.case_digest}
        start = {"start": self.start_agreement.state, "start_text": self.start_agreement.text}
        if self.delivered.summary is not None:
            reason = "a summary record has no samples to check"
            return RecordFacts(state="unverified", reason=reason, **digests, **start)
        if self.signals is None:
            return None
        state, reason = record_state(self.findings)
        return RecordFacts(state=state, reason=reason, **digests, **start)

    def grade_limits(self, lowest_trust: Trust) -> list[Criterion]:
        """Grade the delivery by every limit of the case."""
        return [grade_limit(limit, self.values, lowest_trust) for limit in self.case.limits]

    def edge_warnings(self) -> list[str]:
        """Warnings on filter transients inside the analysis section."""
        return [] if self.signals is None else edge_warnings(self.signals.pantographs, self.signals.record.speed)

    def _signals(self, record: Record) -> RecordSignals:
        return RecordSignals(record, self.case.file.filter.low_pass, self.case.line.geometry.supports)


def _complete(delivered: Delivered, evaluation: Evaluation | None) -> Evaluation:
    """Quantities of the record or summary, with those of the line at rest and of a study."""
    evaluation = evaluation or delivered.summary or Evaluation({LINE: {}}, {LINE: {}})
    values = dict(evaluation.values)
    for owner, extra in ((LINE, delivered.static), *delivered.study.findings.items()):
        values[owner] = {**values.get(owner, {}), **{name: extra[name] for name in QUANTITIES if name in extra}}
    return Evaluation(values, evaluation.skipped)


def section_spread(signals: RecordSignals, sections: Sequence[tuple[float, float]]) -> dict[int, dict[str, float]]:
    """Largest difference of each quantity from its value when the analysis section is shifted.

    At constant speed on equal spans, the quantities settle. At speeds near the wave speed this takes tens of spans;
    until then they depend on the analysis section. Mesh refinement does not reduce this uncertainty.

    Parameters
    ----------
    signals : RecordSignals
        Signals of the run.
    sections : sequence of tuple of float
        Start and end of every section of the same length [m, m].

    Returns
    -------
    dict of int to dict of str to float
        Spread in the units of the quantities, by pantograph and name; quantities available in fewer than
        `MIN_SECTIONS` sections are left out.
    """
    shifted = [signals.evaluate_section(section).values for section in sections]
    spread: dict[int, dict[str, float]] = {}
    for owner, quantities in signals.evaluation.values.items():
        for name, value in quantities.items():
            others = [values.get(owner, {}).get(name) for values in shifted]
            numbers = [other for other in others if isinstance(other, float | int)]
            if isinstance(value, float | int) and len(numbers) >= MIN_SECTIONS:
                spread.setdefault(owner, {})[name] = float(max(abs(other - value) for other in numbers))
    return spread
