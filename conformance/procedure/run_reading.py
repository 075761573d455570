"""Runs of a pair: a case that the system under test runs, or a record."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.cases.start_and_section import span_length
from pantocheck.conformance.comparison.measured_run import list_run_supports
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.uncertainty import Component, Uncertainty
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.procedure.compared_sides import RunSide, measure_spacing
from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.procedure.run_pair import RecordRun
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.criterion_format import ComponentName
from pantocheck.conformance.results.outcome import Delivered, missing_record_reason
from pantocheck.conformance.systems.system import System


def read_run(run: RecordRun, dossier: Dossier, profile: Profile) -> RunSide:
    """Read a recorded run of a pair.

    Args:
        run: Table of the dossier.
        dossier: Dossier with the line.
        profile: Rules of the line tests.

    Raises:
        InputError: The record cannot be read or is impossible.
    """
    span = dossier.lines[run.line].geometry.longest_span
    record = load_assessed_record(dossier.locate(run.record), profile, LineTable(span_m=span))
    return RunSide(
        record, run.line, run.pantographs, run.direction, measure_spacing(record), span, list_run_supports(record)
    )


def make_run(case: Case, direction: str, system: System, dossier: Dossier, profile: Profile, path: Path) -> RunSide:
    """Run a case on the system under test, keep its record, and read it like any other record.

    Args:
        case: Case of the run.
        direction: Direction of the train.
        system: System under test.
        dossier: Dossier with the names of lines and pantographs.
        profile: Rules of the line tests.
        path: Table to write the record to.

    Raises:
        InputError: The system delivers no record, or one that contradicts its case; or the filter of the case is not
            that of the line tests.
    """
    if case.file.filter != profile.filter:
        found = f"the filter of case {case.id} is not that of the line tests"
        raise InputError("dossier, table line_test.filter", found, "State the same filter.")
    outcome = system.run(case)
    where = f"system '{system.name}', case '{case.id}'"
    if not isinstance(outcome, Delivered) or outcome.record is None:
        raise InputError(where, missing_record_reason(outcome), "Every simulated run needs a record with samples.")
    evaluation = CaseEvaluation(case, outcome)
    if (fault := evaluation.mismatch or evaluation.contradiction) is not None:
        raise InputError(where, fault, "Deliver the record of this case.")
    spacing = tuple(case.file.spacing_m or ())
    write_record(
        path,
        outcome.record,
        case=case.id,
        system={"name": system.name, "version": system.version},
        run=outcome.run.model_dump(exclude={"wall_s"}),
        further=_further_keys(case, outcome, spacing),
    )
    record = load_assessed_record(path, profile, LineTable())
    components = {**record.uncertainty.components, **_select_components(evaluation, record)}
    return RunSide(
        replace(record, uncertainty=Uncertainty(components)),
        dossier.name_line(case.line),
        tuple(dossier.name_pantograph(part) for part in case.pantographs),
        direction,
        spacing,
        span_length(case),
        tuple(case.line.geometry.span_limits),
        evaluation.record_facts,
    )


def _select_components(evaluation: CaseEvaluation, record: AssessedRecord) -> dict[ComponentName, Component]:
    """Uncertainty from other meshes and starts, for the quantities of the record."""
    values = record.values.values
    return {
        name: replace(
            component,
            half_widths={
                owner: {quantity: width for quantity, width in widths.items() if quantity in values.get(owner, {})}
                for owner, widths in component.half_widths.items()
            },
        )
        for name, component in evaluation.uncertainty.components.items()
    }


def _further_keys(case: Case, outcome: Delivered, spacing: tuple[float, ...]) -> Mapping[str, object]:
    return {
        "case_digest": case.digest,
        "spacing_m": list(spacing) or None,
        "start": None if outcome.start is None else outcome.start.model_dump(),
        "line": {"span_m": case.line.geometry.longest_span},
    }
