"""Check of results by repetition: quantities are computed from the samples again, or the cases run again."""

import platform as host
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import LIBRARY, Catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.decision import parse_decision
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.packed_samples import list_numbers
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.core.table_sidecar import record_digest
from pantocheck.conformance.documents.authenticity_check import (
    DocumentCheck,
    NumberComparison,
    NumberTree,
    compare_numbers,
    judge_details,
)
from pantocheck.conformance.documents.document_reading import list_suite_differences
from pantocheck.conformance.documents.recomputation import ROUNDING_OF_DRAWS
from pantocheck.conformance.documents.row_check import compare_row
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.grading.results_building import key_by_owner, list_components, select_finite
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.record_reading import list_tables, open_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.results_format import CaseResult, Quantities, Results, UncertaintyComponents
from pantocheck.conformance.runs.record_folder import RecordFolder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study
from pantocheck.model.dynamics.core_choice import core_name

RECORD_COMPONENTS: tuple[ComponentName, ...] = ("section", "length", "alignment")
"""Components of the uncertainty that follow from the record alone; the others need further runs."""

RECORD_TOLERANCE = 1e-6
"""Largest relative difference of a quantity that is computed from a record again.

A table of a record has at least nine significant digits; extremes and filters keep their accuracy."""


@dataclass(frozen=True)
class RecomputedRecord:
    """Quantities of a record with the components of their uncertainty, by owner and name."""

    quantities: dict[str, dict[str, Number]]
    components: UncertaintyComponents
    graded: CaseResult | None = None
    """Case, graded again; None: an assessment by a profile."""


def check_record_quantities(results: Results, path: Path, catalogue: Catalogue = LIBRARY) -> list[DocumentCheck]:
    """Compute the quantities of a record again and compare them with the results.

    Args:
        results: Results of a document.
        path: Record: its sidecar, its table, or a summary record.
        catalogue: Cases at hand.

    Raises:
        InputError: The record cannot be read, or belongs to no case of the results.
    """
    opened = open_record(path)
    result = _find_result(results, opened.case, path)
    sidecar = path.with_suffix(".toml")
    tables = list_tables(sidecar, opened) if isinstance(opened, RecordSidecar) else ()
    computed = _compute(result, results, sidecar, catalogue)
    return [
        *_compare(results, result, computed, path.name),
        *_name_others(result, computed),
        _check_digest(result, record_digest(sidecar, *tables), path),
    ]


def find_record_result(results: Results, path: Path) -> CaseResult:
    """Result that belongs to a record; arguments and errors as for `check_record_quantities`."""
    return _find_result(results, open_record(path).case, path)


def _compare(results: Results, result: CaseResult, computed: RecomputedRecord, name: str) -> Iterator[DocumentCheck]:
    """Compare quantities, the parts of their uncertainty that follow from the record, and its state.

    The joint samples of a folder of records follow from the record alone; those of other systems need further runs.
    """
    stated = _list_values(result)
    pairs = (
        (_select(stated, computed.quantities), _select(computed.quantities, stated)),
        (_keep_components(result.uncertainty_components), _keep_components(computed.components)),
    )
    numbers, widths = (compare_numbers(*pair, RECORD_TOLERANCE) for pair in pairs)
    differences = [*numbers.differences, *(f"uncertainty, {text}" for text in widths.differences)]
    if (graded := computed.graded) is not None and results.system.kind == "record":
        differences += compare_numbers(_select_samples(result), _select_samples(graded), ROUNDING_OF_DRAWS).differences
    differences += [] if graded is None else _compare_record(result, graded, RECORD_TOLERANCE)
    largest = max(numbers.largest, widths.largest)
    yield judge_details(
        f"{result.id}: {numbers.count} quantities follow from the samples of {name} (largest relative difference "
        f"{largest:.1e}).",
        f"{result.id}: the results do not follow from the samples of {name}.",
        differences,
    )


def _compare_record(stated: CaseResult, computed: CaseResult, tolerance: float) -> Iterator[str]:
    """Differences of the rows of the consistency checks, and of the state of the record."""
    if stated.record is None or computed.record is None:
        return
    rows, others = ({row.check: row for row in result.record.checks} for result in (stated, computed) if result.record)
    if list(rows) != list(others):
        yield f"the checks {', '.join(rows)} stated, {', '.join(others)} computed"
    for row, other in ((row, others[name]) for name, row in rows.items() if name in others):
        yield from compare_row(row, other.basis, tolerance)
        if row.outcome != other.outcome:
            yield f"check '{row.check}': outcome '{row.outcome}' stated, '{other.outcome}' computed"
    if stated.record.state != computed.record.state:
        yield f"state of the record '{stated.record.state}' stated, '{computed.record.state}' computed"


def _name_others(result: CaseResult, computed: RecomputedRecord) -> Iterator[DocumentCheck]:
    """Quantities that need more than the record, such as those of the line at rest."""
    others = {
        owner: [name for name in values if name not in computed.quantities.get(owner, {})]
        for owner, values in result.quantities.items()
    }
    lines = tuple(
        f"{'the line' if owner == '0' else f'pantograph {owner}'}: {', '.join(names)}"
        for owner, names in others.items()
        if names
    )
    if lines:
        yield DocumentCheck("open", f"{result.id}: these quantities need more than the record.", lines)


def _select(quantities: Quantities, others: Quantities) -> NumberTree:
    """Quantities that are among others, too."""
    return {
        owner: {name: value for name, value in values.items() if name in others[owner]}
        for owner, values in quantities.items()
        if owner in others
    }


def _keep_components(components: UncertaintyComponents) -> NumberTree:
    """Half-widths that follow from a record, by pantograph, quantity and component."""
    return {
        f"{owner} {name} {part}": parts[part]
        for owner, quantities in components.items()
        for name, parts in quantities.items()
        for part in RECORD_COMPONENTS
        if part in parts
    }


def _check_digest(result: CaseResult, digest: str, path: Path) -> DocumentCheck:
    stated = None if result.record is None else result.record.digest
    if stated is None:
        return DocumentCheck("open", f"{result.id}: the document states no digest of its record.")
    text = f"digest {stated[:19]} stated, {path.name} has {digest[:19]}"
    proved, contradicted = f"{path.name} is the graded record.", f"{path.name} is not the graded record."
    return judge_details(proved, contradicted, [] if stated == digest else [text])


def _find_result(results: Results, case: str | None, path: Path) -> CaseResult:
    """Result that belongs to a record: the case that its sidecar names, else the only assessment by a profile."""
    matching = [result for result in results.cases if result.profile is None and result.id == case]
    matching = matching or [result for result in results.cases if result.profile is not None]
    if len(matching) != 1:
        hint = f"The document has the cases {', '.join(result.id for result in results.cases)[:200]}."
        raise InputError(f"record '{path.name}', key case", f"found {case!r}, which the document does not grade", hint)
    return matching[0]


def _compute(result: CaseResult, results: Results, sidecar: Path, catalogue: Catalogue) -> RecomputedRecord:
    if result.profile is not None:
        assessed = load_assessed_record(sidecar, load_profile(result.profile), LineTable())
        parts = list_components(assessed.uncertainty)
        return RecomputedRecord(key_by_owner(select_finite(assessed.values.values)), parts)
    if (entry := catalogue.find_id(result.id)) is None:
        hint = "Give the folder of the case by --cases, or install the distribution that offers it."
        raise InputError(f"record '{sidecar.name}'", f"{result.id} is not in the installed library", hint)
    system = RecordFolder(results.system.name, results.system.version, ((result.id, sidecar),))
    case = _add_own_limits(load_entry(entry), result)
    graded = grade_case(
        case, system.run(case), results.trust, parse_decision(results.decision, "results, key decision")
    )
    return RecomputedRecord(_list_values(graded), graded.uncertainty_components, graded)


def _add_own_limits(case: Case, stated: CaseResult) -> Case:
    """Case with the limits of the user that a result states, so that its criteria are graded again."""
    own = [row for row in stated.criteria if row.trust == "own" and row.quantity in QUANTITIES]
    rows = [row.model_dump(include={"quantity", "item", "lower", "upper", "trust", "source"}) for row in own]
    owners = [row.pantograph or None for row in own]
    return case.with_limits(
        tuple(Limit.model_construct(pantograph=n, **row) for n, row in zip(owners, rows, strict=True))
    )


def _select_samples(result: CaseResult) -> NumberTree:
    """Joint samples of the criteria, and the number of starts with all counted values inside their limits."""
    verified = () if result.verification is None else result.verification.criteria
    rows = {criterion_name(row): row.draws for row in result.criteria if not row.is_drift}
    rows |= {f"verification, {criterion_name(row)}": row.draws for row in verified}
    of = result.conformity
    starts = {} if of is None else {"starts": of.starts, "starts that pass": of.passing_starts}
    return {"joint sample": rows, "conformity": starts}


def _list_values(result: CaseResult) -> dict[str, dict[str, Number]]:
    """Quantities of a result by owner, and those under its further readings by owner and reading."""
    others = {
        f"{owner} under the reading {reading.id}": values
        for reading in result.readings
        for owner, values in reading.quantities.items()
    }
    return {**result.quantities, **others}


# Check of results by a new run of the built-in simulator.
OTHER_PLATFORM = 1e-6
"""Largest relative difference of a new run on another processor or with other versions of the numerical packages.

The same run without the vector instructions of the processor differs by less than 1e-9 (docs/verify.md)."""

MOST_NUMBERS = 10
"""Largest number of differing numbers that are listed."""

NUMBER_PARTS = (
    *("quantities", "readings", "uncertainty", "uncertainty_components", "spread"),
    *("derived", "traces", "uplift", "charts", "tables"),
)
"""Parts of a result with the computed numbers. Limits and verdicts follow from them and are checked without a run."""

TEXT_PARTS = (
    *("warnings", "notes", "model_uncertainty", "skipped", "uncertainty_basis", "record", "run"),
    "line_shape",
)
"""Parts with texts or rounded numbers, compared where the numbers are equal bit for bit."""


def check_rerun(results: Results, catalogue: Catalogue = LIBRARY) -> list[DocumentCheck]:
    """Run the cases of results again and compare all computed numbers; cases that are not at hand are named.

    Raises:
        InputError: Another system than the built-in simulator made the results.
    """
    simulator = ReferenceSimulator()
    if (results.system.kind, results.system.name) != (simulator.kind, simulator.name):
        raise InputError(
            "option --rerun",
            f"the system '{results.system.name}' is not the built-in simulator",
            "Run this system again with 'pantocheck run --system', or give its record with --record.",
        )
    for case in results.cases:
        for fmu in case.fmus:
            found = f"{case.id} was run with the FMU {fmu.file}, SHA-256 {fmu.sha256}, whose code is not run here"
            raise InputError("option --rerun", found, "Run the case again with 'pantocheck run --pantograph'.")
    computed = [case for case in results.cases if case.quantities]
    entries = {case.id: catalogue.find_id(case.id) for case in computed}
    tolerance = 0.0 if _is_same_platform(results) else OTHER_PLATFORM
    reruns = {
        case.id: _rerun(load_entry(entry), case, results, simulator, tolerance)
        for case in computed
        if (entry := entries[case.id]) is not None
    }
    return [*_judge(results, reruns, tolerance), *_name_skipped([name for name in entries if entries[name] is None])]


def list_known_cases(results: Results, catalogue: Catalogue) -> set[str]:
    """Ids of the cases of results that are at hand."""
    return {case.id for case in results.cases if catalogue.find_id(case.id) is not None}


def _rerun(
    case: Case, stated: CaseResult, results: Results, simulator: ReferenceSimulator, tolerance: float
) -> NumberComparison:
    with_study = add_damping_study(case) if stated.tables else case
    rule = parse_decision(results.decision, "results, key decision")
    result = run_case(_add_own_limits(with_study, stated), simulator, results.trust, rule)
    keys = (*NUMBER_PARTS, *(() if tolerance else TEXT_PARTS))
    numbers = compare_numbers(_select_parts(stated, keys), _select_parts(result, keys), tolerance)
    rounding = ROUNDING_OF_DRAWS if tolerance else 0.0
    samples = compare_numbers(_select_samples(stated), _select_samples(result), rounding)
    return NumberComparison(
        numbers.count + samples.count,
        max(numbers.largest, samples.largest),
        (*samples.differences, *_compare_record(stated, result, tolerance), *numbers.differences),
    )


def _select_parts(result: CaseResult, keys: Sequence[str]) -> NumberTree:
    """Parts of a result that a new run repeats; the computing time is left out."""
    untimed = result.model_copy(update={"run": result.run.model_copy(update={"wall_s": None})})
    parts: dict[str, NumberTree] = {key: untimed.model_dump(mode="json", include={key}).get(key) for key in keys}
    return parts if result.signals is None else {**parts, "signals": list_numbers(result.signals)}


def _judge(results: Results, reruns: dict[str, NumberComparison], tolerance: float) -> Iterator[DocumentCheck]:
    if not reruns:
        return
    numbers, largest = sum(run.count for run in reruns.values()), max(run.largest for run in reruns.values())
    differences = [f"{name}: {text}" for name, run in reruns.items() for text in run.differences]
    agreement = "bit for bit" if largest == 0 else f"within {tolerance:g} (largest relative difference {largest:.1e})"
    proved = f"A new run of the built-in simulator gives the same {numbers} values, {agreement}."
    contradicted = f"A new run of the built-in simulator gives other values ({len(differences)} of {numbers})."
    if differences and (versions := list_suite_differences(results)):
        yield DocumentCheck("incomplete", contradicted, (*versions, *differences[:MOST_NUMBERS]))
    else:
        yield judge_details(proved, contradicted, differences[:MOST_NUMBERS])


def _name_skipped(skipped: list[str]) -> Iterator[DocumentCheck]:
    if skipped:
        text = "These cases were not run again: neither the installed library nor a given folder has them."
        yield DocumentCheck("open", text, tuple(skipped))


def _is_same_platform(results: Results) -> bool:
    """Whether the numerical packages, the core and the kind of processor are those of the results."""
    stated = results.platform
    versions = {name: version(name) for name in ("numpy", "scipy")} | {"core": core_name()}
    machine = (stated.machine, stated.system) == (host.machine(), host.system())
    return machine and all(getattr(stated, name) == number for name, number in versions.items())
