"""The two sides of a pair of runs, and whether they are runs of the same passage."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.cases.start_and_section import span_length
from pantocheck.conformance.comparison.force_difference import COPY_CORRELATION, compare_likeness
from pantocheck.conformance.comparison.profile_grading import describe_other_section, list_run_supports
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.dossier.dossier_file import RecordRun
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.grading.assessed_record import AssessedRecord, find_equal_pantograph, load_assessed_record
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.quantities.uncertainty import Component, Uncertainty
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.runs.record_folder import SPACING_TOLERANCE_M
from pantocheck.conformance.runs.system import Delivered, System, missing_record_reason


@dataclass(frozen=True)
class RunSide:
    """Run of a pair with the passage that it belongs to."""

    record: AssessedRecord
    """Record with its quantities."""
    line: str
    """Name of the line."""
    pantographs: tuple[str, ...]
    """Names of the pantographs in running order."""
    direction: str
    """Direction of the train."""
    spacing_m: tuple[float, ...] | None
    """Distances of successive pantographs [m]; None if they are not known."""
    span_m: float
    """Length of a span of the line [m]."""
    supports: tuple[float, ...] = ()
    """Positions of the supports [m]."""
    facts: RecordFacts | None = None
    """State of the record from the checks with its case; None without a case."""


def measure_spacing(record: AssessedRecord) -> tuple[float, ...] | None:
    """Distances of successive pantographs: stated, or from positions that were sampled together; None if unknown."""
    stated = getattr(record.header, "spacing_m", None)
    if stated is not None or len(record.pantographs) == 1:
        return tuple(stated or ())
    if record.prepared is None:
        return None
    positions = [signals.position for _, signals in sorted(record.prepared.pantographs.items())]
    if len({position.size for position in positions}) > 1:
        return None
    return tuple(float(np.median(ahead - behind)) for ahead, behind in pairwise(positions))


def find_dependence(simulated: RunSide, measured: RunSide) -> str | None:
    """Reason why two records are not independent of each other; None if they are."""
    first, second = simulated.record, measured.record
    if first.record_digest == second.record_digest or first.digest == second.digest:
        return "the simulated and the measured record are the same file"
    if first.pantographs == second.pantographs and (number := find_equal_pantograph(first, second)) is not None:
        return f"the contact force of pantograph {number} is the same in both records: one is a copy of the other"
    likeness = compare_likeness(first, second)
    if likeness is not None and likeness.exceeds(COPY_CORRELATION):
        return f"{likeness.describe()}: one record is a copy of the other, with small changes"
    return None


def list_mismatches(simulated: RunSide, measured: RunSide, profile: Profile) -> Iterator[str]:
    """Differences between the passages of two runs, in words; the rules of the line tests state the speed tolerance."""
    for name, other, own in (
        ("line", measured.line, simulated.line),
        ("pantographs", ", ".join(measured.pantographs), ", ".join(simulated.pantographs)),
        ("direction", measured.direction, simulated.direction),
    ):
        if other != own:
            yield f"the {name} of the measured run: {other}; of the simulated run: {own}"
    speeds = [side.record.header.speed_km_h for side in (measured, simulated)]
    if not abs(speeds[0] / speeds[1] - 1) <= profile.speed_tolerance_pct / 100:
        yield f"the speed of the measured run: {speeds[0]:g} km/h; of the simulated run: {speeds[1]:g} km/h"
    for side, run in ((simulated, "simulated"), (measured, "measured")):
        if len(side.record.pantographs) != len(side.pantographs):
            recorded = count_noun(len(side.record.pantographs), "pantograph")
            yield f"the {run} record has {recorded}, {len(side.pantographs)} named"
    yield from _compare_spacing(simulated, measured)
    if (sections := describe_other_section(simulated.record, measured.record, simulated.span_m)) is not None:
        yield sections


def _compare_spacing(simulated: RunSide, measured: RunSide) -> Iterator[str]:
    if simulated.spacing_m is None or measured.spacing_m is None:
        yield "the spacing of the pantographs is not known for both runs (key spacing_m of the sidecar)"
    elif len(simulated.spacing_m) == len(measured.spacing_m):
        pairs = zip(simulated.spacing_m, measured.spacing_m, strict=True)
        for own, other in pairs:
            if abs(own - other) > SPACING_TOLERANCE_M:
                yield f"the spacing of the measured run: {other:g} m; of the simulated run: {own:g} m"


# Runs of a pair: a case that the system under test runs, or a record.
def read_run(run: RecordRun, dossier: Dossier, profile: Profile) -> RunSide:
    """Read a recorded run of a pair by the rules of the line tests.

    Raises:
        InputError: The record cannot be read or is impossible.
    """
    span = dossier.lines[run.line].geometry.longest_span
    record = load_assessed_record(dossier.locate(run.record), profile, LineTable(span_m=span))
    return RunSide(
        record, run.line, run.pantographs, run.direction, measure_spacing(record), span, list_run_supports(record)
    )


def run_and_read(case: Case, direction: str, system: System, dossier: Dossier, profile: Profile, path: Path) -> RunSide:
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
