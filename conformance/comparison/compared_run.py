"""Compared runs: records, results and simulations, read into one form."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.figure_data import LineShape, Traces
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.supported_frequencies import list_supported_frequencies
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value, ValuesByOwner
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.motion_format import PassageMotion
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.results.supported_frequency import SupportedFrequency
from pantocheck.conformance.runs.system import Delivered, System

RECORD_PROFILE = "line-test"
"""Profile whose filter and speed tolerance hold for records that are compared."""

RESULTS_FILE = "results.json"


@dataclass(frozen=True)
class ComparedRun:
    """One run of a case or one record."""

    kind: Literal["record", "results", "system"]
    """Origin: files of a record, results.json, or a run of a system."""
    name: str
    """Name of the record or of the system."""
    source: str
    """Kind and origin in words."""
    digest: str
    """SHA-256 of the files; empty for a simulation."""
    case: str
    """Id of the case; empty if a record states none."""
    speed_km_h: float | None
    """Speed of the train [km/h]; None if it is not known."""
    values: ValuesByOwner
    """Quantities by pantograph (0: the line) and name."""
    uncertainty: ValuesByOwner
    """Half-widths of their 95 % intervals."""
    signals: Mapping[int, PantographSignals] = field(default_factory=dict)
    """Signals of the pantographs; empty for results."""
    traces: Mapping[int, Traces] = field(default_factory=dict)
    """Thinned curves; empty unless the run was read from results."""
    supports: tuple[float, ...] = ()
    """Positions of the supports [m]; empty if they are not known."""
    supported: tuple[SupportedFrequency, ...] = ()
    """Highest frequencies that the parts of its model support; empty for a record."""
    unknown_components: tuple[str, ...] = ()
    """Components of the uncertainty that are not part of the half-widths."""
    shape: LineShape | None = None
    motion: PassageMotion | None = None
    """Line at rest and moving picture of the passage; None: not known."""
    reason: str = ""
    """Reason why no pantograph has a quantity; empty if one has."""


def read_record_run(path: Path) -> ComparedRun:
    """Read a record with its quantities.

    Raises:
        InputError: The record cannot be read or is invalid.
    """
    record = load_assessed_record(path, load_profile(RECORD_PROFILE), LineTable())
    prepared, header = record.prepared, record.header
    return ComparedRun(
        kind="record",
        name=record.name,
        source=f"record of {record.system.name} {record.system.version}".strip(),
        digest=record.record_digest,
        case=header.case or "",
        speed_km_h=header.speed_km_h,
        values=record.values.values,
        uncertainty=record.uncertainty.combined,
        signals={} if prepared is None else prepared.pantographs,
        supports=() if prepared is None else prepared.line.line_supports or (),
        unknown_components=record.uncertainty.unknown_components,
        reason=_find_reason(record.values),
    )


def read_results_runs(path: Path) -> list[ComparedRun]:
    """Read the cases of a results.json that have quantities; the path may be that of its folder.

    Raises:
        InputError: The file cannot be read, or none of its cases has quantities.
    """
    path = path / RESULTS_FILE if path.is_dir() else path
    results = read_results(path)
    runs = [_read_case_run(case, results) for case in results.cases if any(case.quantities.values())]
    if not runs:
        raise InputError(f"results '{path.name}'", "no case has quantities", "Give the results of a run.")
    return runs


def simulate_run(case: Case, system: System) -> ComparedRun:
    """Run a case on a system; errors as of `deliver_case` and `describe_delivery`."""
    return describe_delivery(case, system, deliver_case(case, system))


def deliver_case(case: Case, system: System) -> Delivered:
    """Run a case on a system that must deliver data.

    Raises:
        InputError: The system does not run the case, or fails.
    """
    outcome = system.run(case)
    if not isinstance(outcome, Delivered):
        raise InputError(f"system '{system.name}'", outcome.reason, "Choose another case or system.")
    return outcome


def describe_delivery(case: Case, system: System, delivered: Delivered) -> ComparedRun:
    """Quantities, uncertainty and signals of a delivery.

    Raises:
        InputError: The delivery does not belong to the case.
    """
    evaluation = CaseEvaluation(case, delivered)
    if evaluation.mismatch is not None:
        raise InputError(f"system '{system.name}'", evaluation.mismatch, "Choose another case or system.")
    return ComparedRun(
        kind="system",
        name=system.name,
        source=f"{system.kind} {system.name} {system.version}".strip(),
        digest=delivered.digest or "",
        case=case.id,
        speed_km_h=3.6 * case.speed,
        values=evaluation.evaluation.values,
        uncertainty=evaluation.uncertainty.combined,
        signals={} if evaluation.signals is None else evaluation.signals.pantographs,
        supports=case.line.geometry.supports,
        supported=tuple(list_supported_frequencies(case, delivered)),
        unknown_components=evaluation.uncertainty.unknown_components,
        shape=delivered.line_shape,
        motion=delivered.motion,
        reason=_find_reason(evaluation.evaluation),
    )


def _read_case_run(case: CaseResult, results: Results) -> ComparedRun:
    supports = {support for traces in case.traces.values() for support in traces.supports_m}
    return ComparedRun(
        kind="results",
        name=f"{results.system.name} {results.system.version}".strip(),
        source=f"results of {results.started or 'an unknown date'}",
        digest=case.record.digest or "" if case.record is not None else "",
        case=case.id,
        speed_km_h=None,
        values=_read_values(case.quantities),
        uncertainty=_read_values(case.uncertainty),
        traces={int(owner): traces for owner, traces in case.traces.items()},
        supports=tuple(sorted(supports)),
        supported=tuple(case.supported),
        shape=case.line_shape,
        motion=case.motion,
    )


def _find_reason(evaluation: Evaluation) -> str:
    """Reason why no pantograph has a quantity: the first one of the first pantograph; empty if one has."""
    if any(values for owner, values in evaluation.values.items() if owner != LINE):
        return ""
    return next((reason for skipped in evaluation.skipped.values() for reason in skipped.values()), "")


def _read_values(quantities: Mapping[str, Mapping[str, Number]]) -> dict[int, dict[str, Value]]:
    """Values of results.json by the number of the pantograph."""
    return {
        int(owner): {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
        for owner, values in quantities.items()
    }
