"""Evaluation of a delivery: signals, quantities, errors and consistency findings, each computed once."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.start_and_section import (
    has_short_run_in,
    list_earlier_sections,
    run_in_spans,
    shift_section,
    span_length,
)
from pantocheck.conformance.core.criterion import ComponentName, Criterion
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.case_identity import explain_widened_limit
from pantocheck.conformance.grading.criterion_grading import GradedValues, grade_limit
from pantocheck.conformance.grading.record_uncertainty import (
    add_bounds,
    draw_lengths,
    find_lengths,
    largest_changes,
    length_component,
    section_spread,
    shift_component,
    widen_changes,
)
from pantocheck.conformance.grading.start_agreement import StartAgreement, compare_starts
from pantocheck.conformance.quantities.evaluation import LINE, ChannelSignals, Evaluation, Value
from pantocheck.conformance.quantities.pantograph_signals import edge_warnings
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.uncertainty import Component, SampleParts, Uncertainty, draw_sample, map_items
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_resolution import resolution_component, sampling_component
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.runs.check import CheckName, Finding
from pantocheck.conformance.runs.record_checks import check_record, judge_record_state, list_check_rows
from pantocheck.conformance.runs.record_folder import find_other_case, find_record_mismatch
from pantocheck.conformance.runs.system import Delivered

AT_REST = Component("does not apply: the line is at rest")
NO_RECORD = Component("not known: there is no record of one passage")
NO_SAMPLES = Component("does not apply: there are no samples")
EXACT_LINE = Component("does not apply: the line file states no tolerances")


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
    def start_signals(self) -> list[RecordSignals]:
        """Signals of the runs from other starts."""
        records = [start.record for start in self.delivered.starts if start.record is not None]
        return [self._signals(record, float(record.position[0, 0])) for record in records]

    @property
    def start_evaluations(self) -> list[Evaluation]:
        """Quantities of the runs from other starts."""
        return [start.evaluation for start in self.start_signals]

    @cached_property
    def uncertainty(self) -> Uncertainty:
        """Uncertainty of the quantities by component."""
        delivered, case, signals = self.delivered, self.case, self.signals
        digest = case.digest.removeprefix("sha256:")
        coarse = None if delivered.coarse is None else self._evaluate(delivered.coarse)
        components: dict[ComponentName, Component] = {
            "discretisation": discretisation_component(coarse, self.evaluation, self.refined)
        }
        if signals is None:
            absent = AT_REST if case.is_static else NO_RECORD
            components |= {"start": absent, "section": absent, "length": absent}
            components |= {"sampling": NO_SAMPLES, "resolution": NO_SAMPLES}
            components["line"] = EXACT_LINE if case.line.tolerance is None else absent
            return Uncertainty(components)
        starts = self.start_signals
        sections = shift_section(case.analysis_section, span_length(case))
        line_changes = [subtract_values(self._evaluate(run), self.evaluation) for run in delivered.changed_lines]
        lengths = find_lengths(signals.pantographs, signals.line, span_length(case), case.speed)
        components |= {
            "start": start_component(case, signals, self.start_evaluations),
            "section": shift_component(signals, sections),
            "length": length_component(lengths, span_length(case)),
            "sampling": sampling_component(signals, 1 / case.file.discretisation.time_step_s),
            "resolution": resolution_component(signals),
            "line": line_component(line_changes, case.line.tolerance is not None),
        }
        runs, earlier = [signals, *starts], () if starts else list_earlier_sections(case)
        parts = SampleParts(
            values=signals.evaluation.values,
            members=[
                *(start.evaluation.values for start in starts),
                *(run.evaluate_section(section).values for run in runs for section in sections),
                *(signals.evaluate_section(section).values for section in earlier),
            ],
            deviations=draw_lengths(lengths, digest),
            mesh_changes=sign_half_widths(components["discretisation"], self.evaluation, self.refined),
            bounds=add_bounds(components),
            line_changes=line_changes,
        )
        return Uncertainty(components, signals.evaluation.values, draw_sample(parts, digest))

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
            return RecordFacts(state="unconfirmed", reason=reason, **digests, **start)
        if self.signals is None:
            return None
        rows = list_check_rows(self.findings)
        state, reason = judge_record_state(rows)
        return RecordFacts(state=state, reason=reason, checks=rows, **digests, **start)

    def grade_limits(self, lowest_trust: Trust, rule: DecisionRule = SIMPLE) -> list[Criterion]:
        """Grade the delivery by every limit of the case."""
        return [
            grade_limit(limit, self.values, lowest_trust, rule=rule, doubt=explain_widened_limit(self.case.id, limit))
            for limit in self.case.limits
        ]

    def edge_warnings(self) -> list[str]:
        """Warnings on filter transients inside the analysis section."""
        return [] if self.signals is None else edge_warnings(self.signals.pantographs, self.signals.record.speed)

    def _evaluate(self, run: Delivered) -> Evaluation:
        """Quantities of a further run of the case."""
        return _complete(run, None if run.record is None else self._signals(run.record).evaluation)

    def _signals(self, record: Record, start: float | None = None) -> RecordSignals:
        """Signals of a run of the case, or of a run from another start of the first pantograph [m]."""
        line, run = self.case.line, (self.case.start_positions[0] if start is None else start, self.case.end)
        return RecordSignals(record, self.case.file.filter, line.geometry.supports, line.overlaps, run)


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


# Uncertainty of the values of a case, component by component.
def discretisation_component(coarse: Evaluation | None, value: Evaluation, fine: Evaluation | None) -> Component:
    """Uncertainty from mesh and time step.

    Args:
        coarse, value, fine: Quantities with element length and time step doubled, as in the case, and halved; None: not
            known.
    """
    if fine is None:
        return Component("not known: the system delivered one mesh and one time step only")
    half_widths: dict[int, dict[str, Value]] = {}
    for owner, quantities in value.values.items():
        finer = fine.values.get(owner, {})
        coarser = {} if coarse is None else coarse.values.get(owner, {})
        half_widths[owner] = {
            name: _half_width(coarser.get(name), number, finer[name])
            for name, number in quantities.items()
            if _same_items(finer.get(name), number)
        }
    meshes = "of the case and halved" if coarse is None else "doubled, of the case and halved"
    return Component(f"runs with element length and time step {meshes}", half_widths)


def _half_width(coarse: Value | None, value: Value, fine: Value) -> Value:
    """Half-width from mesh and time step of a number, or of each item."""
    if coarse is None or not _same_items(coarse, value):
        return map_items(partial(discretisation_half_width, None), value, fine)
    return map_items(discretisation_half_width, coarse, value, fine)


def _same_items(a: Value | None, b: Value) -> bool:
    """Whether two values are both numbers, or have equally many items."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b)
    return a is not None and not isinstance(a, tuple) and not isinstance(b, tuple)


def sign_half_widths(component: Component, value: Evaluation, fine: Evaluation | None) -> dict[int, dict[str, float]]:
    """Half-widths of quantities with one value, with the sign of their change to the finer mesh."""
    finer = {} if fine is None else fine.values
    signed: dict[int, dict[str, float]] = {}
    for owner, widths in component.half_widths.items():
        for name, width in widths.items():
            number, other = value.values[owner][name], finer.get(owner, {}).get(name)
            if not isinstance(width, tuple) and not isinstance(number, tuple) and not isinstance(other, tuple | None):
                signed.setdefault(owner, {})[name] = math.copysign(width, other - number)
    return signed


def subtract_values(other: Evaluation, value: Evaluation) -> dict[int, dict[str, float]]:
    """Differences of the quantities with one value in two evaluations."""
    return {
        owner: {
            name: float(changed - number)
            for name, number in quantities.items()
            if isinstance(number, float | int)
            and isinstance(changed := other.values.get(owner, {}).get(name), float | int)
        }
        for owner, quantities in value.values.items()
    }


def line_component(changes: Sequence[Mapping[int, Mapping[str, float]]], is_stated: bool) -> Component:
    """Uncertainty from the tolerances of the line, by linear propagation.

    Args:
        changes: Changes of the quantities by one standard deviation along each principal direction.
        is_stated: Whether the line file states tolerances.
    """
    if not is_stated:
        return EXACT_LINE
    if not changes:
        return Component("not known: the system delivered no runs on other lines")
    squares: dict[int, dict[str, float]] = {}
    for change in changes:
        for owner, quantities in change.items():
            for name, difference in quantities.items():
                own = squares.setdefault(owner, {})
                own[name] = own.get(name, 0.0) + difference**2
    widths = {owner: {name: QUANTILE_95 * math.sqrt(x) for name, x in part.items()} for owner, part in squares.items()}
    basis = (
        f"{len(changes)} runs on lines one standard deviation away along the principal directions of the tolerances of "
        "the line file, at the uplift forces of the line as stated; linear"
    )
    return Component(basis, widths)


def start_component(case: Case, signals: ChannelSignals, others: Sequence[Evaluation]) -> Component:
    """Uncertainty from the start and the run-in.

    Args:
        case: Case of the run.
        signals: Signals of the run.
        others: Quantities of the same case with other starts.
    """
    run_in = f"a run-in of {run_in_spans(case):.3g} spans"
    if others:
        changes = largest_changes(signals.evaluation.values, [other.values for other in others], len(others))
        basis = f"{len(others)} runs with other starts and ramps, after {run_in}"
        return Component(basis, widen_changes(changes))
    widths = section_spread(signals, list_earlier_sections(case))
    if widths:
        return Component(f"earlier sections of the same run, before which at least half of {run_in} is left", widths)
    if has_short_run_in(case):
        return Component(f"not known: after {run_in}, it needs runs with other starts")
    return Component("not known: the record does not contain earlier sections, with a shorter run-in")


# Uncertainty from mesh and time step, by Richardson extrapolation and the grid convergence index.
#
# Element length and time step are doubled and halved together, a refinement ratio of 2. With the values f_2 (doubled),
# f_1 (of the case) and f_0 (halved), the observed order and the error of f_1 are
#
# p = log2((f_2 - f_1) / (f_1 - f_0)),    e = (f_1 - f_0) 2^p / (2^p - 1)
#
# (Roache 1994, doi:10.1115/1.2910291; ASME V&V 20-2009; Eca and Hoekstra 2014, doi:10.1016/j.jcp.2014.01.006). The
# half-width of the 95 % interval is the error times a safety factor. Without an observed order, the difference f_1 -
# f_0 is used. A quarter of f_2 - f_1, which predicts it at second order, replaces it where it is small by chance.
LOWEST_ORDER, HIGHEST_ORDER = 0.5, 4.0
"""Range of an observed order: below it, values hardly converge; above it, cubic elements do not converge."""

METHOD_ORDER = 2.0
"""Order of the time integration: a higher observed order is taken as this one (Eca and Hoekstra 2014)."""

SAFETY_FACTOR = 1.25
"""Safety factor where an order is observed (Roache 1994; Eca and Hoekstra 2014)."""

LARGE_SAFETY_FACTOR = 3.0
"""Safety factor on a difference of two meshes where no order is observed (Roache 1994; Eca and Hoekstra 2014)."""


def observed_order(coarse: float, value: float, fine: float) -> float | None:
    """Order of convergence of three values, each with half of the steps of the one before; None: no convergence.

    Args:
        coarse, value, fine: Values with steps doubled, as in the case, and halved.
    """
    first, second = coarse - value, value - fine
    return math.log2(first / second) if second and first / second > 0 else None


def discretisation_half_width(coarse: float | None, value: float, fine: float) -> float:
    """Half-width of the 95 % interval of a value from mesh and time step.

    Args:
        coarse: Value with element length and time step doubled; None if it is not known.
        value, fine: Value of the case, and with element length and time step halved.

    Returns:
        Richardson error times `SAFETY_FACTOR` where an order is observed, else a difference times
        `LARGE_SAFETY_FACTOR`.
    """
    if coarse is None:
        return LARGE_SAFETY_FACTOR * abs(value - fine)
    order = observed_order(coarse, value, fine)
    if order is not None and LOWEST_ORDER <= order <= HIGHEST_ORDER:
        growth = math.pow(2, min(order, METHOD_ORDER))
        return SAFETY_FACTOR * abs(value - fine) * growth / (growth - 1)
    return LARGE_SAFETY_FACTOR * max(abs(value - fine), abs(coarse - value) / 2**METHOD_ORDER)
