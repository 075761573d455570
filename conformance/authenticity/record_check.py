"""Check of results against their record: every quantity is computed from the samples again."""

from pathlib import Path
from typing import Any

from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck, judge_details
from pantocheck.conformance.authenticity.number_comparison import compare_numbers
from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record_reading import open_record, record_digest
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.results_building import key_by_owner, select_finite
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.systems.record_folder import RecordFolder

RECORD_TOLERANCE = 1e-6
"""Largest relative difference of a quantity that is computed from a record again.

A table of a record has at least nine significant digits; extremes and filters keep their accuracy."""


def check_record_quantities(results: Results, path: Path) -> list[DocumentCheck]:
    """Compute the quantities of a record again and compare them with the results.

    Parameters
    ----------
    results : Results
        Results of a document.
    path : Path
        Record: its sidecar, its table, or a summary record.

    Raises
    ------
    InputError
        The record cannot be read, or belongs to no case of the results.
    """
    opened = open_record(path)
    result = _find_result(results, opened.case, path)
    sidecar = path.with_suffix(".toml")
    files = (sidecar, sidecar.parent / opened.file) if isinstance(opened, RecordSidecar) else (sidecar,)
    computed = _compute(result, results, sidecar)
    stated = result.model_dump(mode="json")["quantities"]
    comparison = compare_numbers(_select(stated, computed), _select(computed, stated), RECORD_TOLERANCE)
    proved = (
        f"{result.id}: {comparison.count} quantities follow from the samples of {path.name} "
        f"(largest relative difference {comparison.largest:.1e})."
    )
    contradicted = f"{result.id}: quantities do not follow from the samples of {path.name}."
    checks = [judge_details(proved, contradicted, comparison.differences)]
    others = {
        owner: [name for name in values if name not in computed.get(owner, {})] for owner, values in stated.items()
    }
    lines = tuple(
        f"{'the line' if owner == '0' else f'pantograph {owner}'}: {', '.join(names)}"
        for owner, names in others.items()
        if names
    )
    if lines:
        checks.append(DocumentCheck("open", f"{result.id}: these quantities need more than the record.", lines))
    return [*checks, _check_digest(result, record_digest(*files), path)]


def _select(quantities: dict[str, Any], others: dict[str, Any]) -> dict[str, Any]:
    """Quantities that are among others, too."""
    return {
        owner: {name: value for name, value in values.items() if name in others[owner]}
        for owner, values in quantities.items()
        if owner in others
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


def _compute(result: CaseResult, results: Results, sidecar: Path) -> dict[str, Any]:
    if result.profile is not None:
        values = load_assessed_record(sidecar, load_profile(result.profile), LineTable()).values.values
        return key_by_owner(select_finite(values))
    known = list_library(library_folder())
    if result.id not in known:
        hint = "Only records of library cases and of assessments can be compared."
        raise InputError(f"record '{sidecar.name}'", f"{result.id} is not in the installed library", hint)
    system = RecordFolder(results.system.name, results.system.version, ((result.id, sidecar),))
    case = load_case(known[result.id])
    quantities: dict[str, Any] = grade_case(case, system.run(case), results.trust).model_dump(mode="json")["quantities"]
    return quantities
