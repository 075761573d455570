"""Evaluation of a delivery: signals, quantities, errors and consistency findings, each computed once."""

from dataclasses import dataclass
from functools import cached_property

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.start_and_section import shift_section, span_length
from pantocheck.conformance.consistency.check import CheckName, Finding
from pantocheck.conformance.consistency.record_checks import check_record
from pantocheck.conformance.consistency.record_state import record_state
from pantocheck.conformance.grading.case_uncertainty import discretisation_component, start_component
from pantocheck.conformance.grading.criterion_grading import GradedValues, grade_limit
from pantocheck.conformance.grading.record_mismatch import find_other_case, find_record_mismatch
from pantocheck.conformance.grading.record_uncertainty import length_component, section_spread, shift_component
from pantocheck.conformance.grading.start_agreement import StartAgreement, compare_starts
from pantocheck.conformance.grading.uncertainty import Component, Uncertainty
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation
from pantocheck.conformance.quantities.pantograph_signals import edge_warnings
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.criterion_format import ComponentName, Criterion
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.record_facts import RecordFacts

AT_REST = Component("does not apply: the line is at rest")
NO_RECORD = Component("not known: there is no record of one passage")


@dataclass(frozen=True)
class CaseEvaluation:
    """A delivery of a system, evaluated for its case."""

    case: Case
    """Case with its limits."""
    delivered: Delivered
    """Data that the system delivered."""

    @cached_property
    def mismatch(self) -> str | None:
        """Reason why the delivery does not belong to the case; None if it does."""
        case, record = self.case, self.delivered.record
        if (other := find_other_case(case, self.delivered.case_digest)) is not None:
            return other
        for name in sorted(self.delivered.static):
            if name not in QUANTITIES:
                return f"the system delivered an unknown quantity {name!r}{_suggest_list(name)}"
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
    def evaluation(self) -> Evaluation:
        """Quantities of the run of the case."""
        return _complete(self.delivered, None if self.signals is None else self.signals.evaluation)

    @cached_property
    def refined(self) -> Evaluation | None:
        """Quantities with element length and time step halved; None if the system delivered no such run."""
        return None if self.delivered.refined is None else self._evaluate(self.delivered.refined)

    @cached_property
    def values(self) -> GradedValues:
        """Quantities with their uncertainty, discretisation error and section spread."""
        study, signals = self.delivered.study.spread, self.signals
        run = {} if signals is None else section_spread(signals, self.case.shifted_sections)
        return GradedValues(
            evaluation=self.evaluation,
            refined=self.refined,
            spread={owner: {**run.get(owner, {}), **study.get(owner, {})} for owner in run.keys() | study.keys()},
            uncertainty=self.uncertainty,
        )

    @cached_property
    def uncertainty(self) -> Uncertainty:
        """Uncertainty of the quantities by component."""
        delivered, case, signals = self.delivered, self.case, self.signals
        coarse = None if delivered.coarse is None else self._evaluate(delivered.coarse)
        components: dict[ComponentName, Component] = {
            "discretisation": discretisation_component(coarse, self.evaluation, self.refined)
        }
        if signals is None:
            absent = AT_REST if case.is_static else NO_RECORD
            return Uncertainty({**components, "start": absent, "section": absent, "length": absent})
        others = [self._evaluate(start) for start in delivered.starts]
        return Uncertainty(
            {
                **components,
                "start": start_component(case, signals, others),
                "section": shift_component(signals, shift_section(case.analysis_section, span_length(case))),
                "length": length_component(
                    signals.pantographs, span_length(case), case.speed, case.digest.removeprefix("sha256:")
                ),
            }
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

    def _evaluate(self, run: Delivered) -> Evaluation:
        """Quantities of a further run of the case."""
        return _complete(run, None if run.record is None else self._signals(run.record).evaluation)

    def _signals(self, record: Record) -> RecordSignals:
        line = self.case.line
        return RecordSignals(record, self.case.file.filter.low_pass, line.geometry.supports, line.overlaps)


def _complete(delivered: Delivered, evaluation: Evaluation | None) -> Evaluation:
    """Quantities of the record or summary, with those of the line at rest and of a study."""
    evaluation = evaluation or delivered.summary or Evaluation({LINE: {}}, {LINE: {}})
    values = dict(evaluation.values)
    for owner, extra in ((LINE, delivered.static), *delivered.study.findings.items()):
        values[owner] = {**values.get(owner, {}), **{name: extra[name] for name in QUANTITIES if name in extra}}
    return Evaluation(values, evaluation.skipped)


def _suggest_list(name: str) -> str:
    """Remedy for the name of one value of a list, as limits print it; empty for any other name."""
    quantity, bracket, _ = name.partition("[")
    known = bracket and quantity in QUANTITIES and QUANTITIES[quantity].scope == "static"
    return f"; give the list {quantity!r}, with the value of item 1 first" if known else ""
