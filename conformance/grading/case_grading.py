"""Grading of a case: from the outcome of a system to the result of the case."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.core.criterion import judge_criteria
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule
from pantocheck.conformance.core.figure_data import ExtremePlace
from pantocheck.conformance.core.packed_samples import SignalSamples
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_conformity import count_passing_starts, find_case_conformity
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_identity import compare_with_library, limits_digest, list_limit_changes
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.case_verification import verify_evaluation, verify_ungraded
from pantocheck.conformance.grading.contact_loss_list import build_contact_losses, find_force_places, find_uplift_place
from pantocheck.conformance.grading.derived_facts import list_derived_facts, list_input_values, list_law_forces
from pantocheck.conformance.grading.input_sensitivity import describe_studies, list_conditions
from pantocheck.conformance.grading.reading_grades import evaluate_readings, mark_readings
from pantocheck.conformance.grading.results_building import key_by_owner, list_components, select_finite
from pantocheck.conformance.grading.supported_frequencies import list_supported_frequencies
from pantocheck.conformance.grading.validity_warnings import extended_band_warnings, validity_warnings
from pantocheck.conformance.records.evaluated_signals import pack_signals
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.traces import build_pantograph_traces, build_uplift_traces
from pantocheck.conformance.results.results_format import CaseResult, InputGroup, LibraryIdentity, RunFacts, Step
from pantocheck.conformance.runs.system import Delivered, Errored, Outcome, Skipped

_EMPTY: dict[str, object] = {
    "warnings": [],
    "criteria": [],
    "quantities": {},
    "skipped": {},
    "spread": {},
    "traces": {},
    "uplift": [],
}
"""Parts of a result without grades."""


def grade_case(case: Case, outcome: Outcome, lowest_trust: Trust, rule: DecisionRule = SIMPLE) -> CaseResult:
    """Grade the outcome of a case.

    Args:
        case: Case with its limits.
        outcome: Outcome of the case on a system.
        lowest_trust: Lowest trust of the limits that count.
        rule: Decision rule.
    """
    match outcome:
        case Skipped(reason):
            return build_ungraded(case, "skip", reason)
        case Errored(reason):
            return build_ungraded(case, "error", reason)
        case delivered:
            return grade_evaluation(CaseEvaluation(case, delivered), lowest_trust, rule)


def grade_evaluation(evaluation: CaseEvaluation, lowest_trust: Trust, rule: DecisionRule = SIMPLE) -> CaseResult:
    """Grade an evaluated delivery by the limits of its case."""
    case, delivered, signals = evaluation.case, evaluation.delivered, evaluation.signals
    if evaluation.mismatch is not None:
        return build_ungraded(case, "error", evaluation.mismatch, delivered)
    values, contradiction = evaluation.values, evaluation.contradiction
    findings = evaluation.findings.values()
    # Quantities of a contradicted record are shown but not graded: some would pass.
    criteria, readings = [], evaluate_readings(evaluation)
    if contradiction is None:
        criteria = mark_readings(evaluation.grade_limits(lowest_trust, rule), readings, list_conditions(case))
    supports = case.line.geometry.span_limits
    record, start = evaluation.record_facts, evaluation.start_agreement
    verdict = judge_case([judge_criteria(criteria)], record)
    return _build_result(
        case,
        delivered,
        verdict=verdict,
        criteria_verdict=verdict,
        verification=verify_evaluation(evaluation),
        reason=contradiction,
        warnings=[
            *delivered.warnings,
            *(finding.text for finding in findings if finding.kind == "doubt"),
            *([start.text] if record is not None and start.state == "differs" else []),
            *evaluation.edge_warnings(),
            *validity_warnings(case, values.evaluation),
            *extended_band_warnings(values.evaluation, values.refined, delivered.run.dt_s),
        ],
        notes=[
            *(finding.text for finding in findings if finding.kind == "unchecked"),
            *([start.text] if record is not None and start.state == "not stated" else []),
        ],
        criteria=criteria,
        conformity=find_case_conformity(criteria, count_passing_starts(evaluation, criteria), readings),
        record=record,
        quantities=key_by_owner(select_finite(values.evaluation.values)),
        readings=readings,
        skipped=key_by_owner(values.evaluation.skipped),
        spread=key_by_owner(values.spread),
        uncertainty=key_by_owner(select_finite(values.uncertainty.combined)),
        uncertainty_components=list_components(values.uncertainty),
        uncertainty_basis=values.uncertainty.basis,
        traces={} if signals is None else build_pantograph_traces(signals.pantographs, supports),
        uplift=[] if signals is None else build_uplift_traces(signals.line, signals.record.time),
        signals=None if signals is None else _pack(case, signals),
        contact_losses=None if signals is None else build_contact_losses(signals.pantographs),
        places={} if signals is None else _find_places(signals),
        charts=list(delivered.study.charts),
        tables=list(delivered.study.tables),
    )


def _pack(case: Case, signals: RecordSignals) -> SignalSamples | None:
    """Signals of the evaluation and of its further readings."""
    others = map(case.with_reading, case.file.reading)
    readings = [(other.file.filter, other.analysis_section) for other in others]
    return pack_signals(signals.pantographs, signals.line, signals.record.time, readings, signals.overlaps)


def _find_places(signals: RecordSignals) -> dict[str, dict[str, ExtremePlace]]:
    return find_force_places(signals.pantographs) | find_uplift_place(signals.line, signals.record.time)


def build_ungraded(case: Case, verdict: Verdict, reason: str, delivered: Delivered | None = None) -> CaseResult:
    """Result of a case that was not graded."""
    text = " ".join(reason.split())
    return _build_result(
        case,
        delivered or Delivered(),
        notes=[],
        verdict=verdict,
        criteria_verdict=verdict,
        verification=verify_ungraded(case, verdict, text),
        reason=text,
    )


def _build_result(case: Case, delivered: Delivered, notes: Sequence[str], **parts: object) -> CaseResult:
    file, record, library = case.file, delivered.record, compare_with_library(case)
    return CaseResult.model_validate(
        {
            "id": case.id,
            "title": file.title,
            "notes": [*(fmu.description for fmu in delivered.fmus), *case.notes, *delivered.notes, *notes],
            "fmus": delivered.fmus,
            "model_uncertainty": list(delivered.model_uncertainty),
            "supported": list_supported_frequencies(case, delivered),
            "conditions": list_conditions(case),
            "input_studies": describe_studies(case),
            "inputs": _list_inputs(case),
            "derived": list_derived_facts(case, delivered.uplift_forces),
            "line_shape": delivered.line_shape,
            "motion": delivered.motion,
            "input_digest": case.digest,
            "changes": list(case.changes),
            "limits_digest": limits_digest(case.limits),
            "stated_limits_digest": limits_digest(case.file.limit),
            "limit_changes": list_limit_changes(case),
            "library": library,
            "origin": None if library == "identical" else case.origin,
            "edition": file.edition,
            "superseded_by": file.superseded_by,
            "steps": _list_steps(case, library),
            "run": RunFacts(
                **delivered.run.model_dump(),
                speed_km_h=file.speed_km_h,
                rate_Hz=None if record is None else float(f"{record.rate:.9g}"),
                filter=file.filter,
                evaluated_m=None if case.is_static else case.analysis_section,
                law_forces=list_law_forces(case),
            ),
            **_EMPTY,
            **parts,
        }
    )


def _list_inputs(case: Case) -> list[InputGroup]:
    """Groups of inputs with their values; a single provisional key has no values, because its group has them."""
    tables = case.sourced_tables
    return [
        InputGroup(
            group=group.group,
            trust=group.trust,
            source=source_text(group.source),
            values=list_input_values(tables[group.group], set(tables), group.group) if group.group in tables else {},
        )
        for group in case.inputs
    ]


def _list_steps(case: Case, library: LibraryIdentity) -> list[Step]:
    """Steps of the procedure that a case belongs to; an own case, or one of no edition, is not a reference model."""
    file = case.file
    if file.mass_drop is not None or not isinstance(file.study, DampingSensitivity | None):
        return []
    if not case.is_static:
        return [] if library == "own" or file.edition is None else ["reference_models"]
    return ["static_check"] if file.apparent_mass is None else ["pantograph_model", "static_check"]
