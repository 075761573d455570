"""Check of results against their record: every quantity is computed from the samples again."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pantocheck.conformance.cases.catalogue import LIBRARY, Catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.core.table_sidecar import record_digest
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, judge_details
from pantocheck.conformance.documents.number_comparison import NumberTree, compare_numbers
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.results_building import key_by_owner, list_components, select_finite
from pantocheck.conformance.records.record_reading import open_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.case_facts_format import RecordState
from pantocheck.conformance.results.results_format import CaseResult, Quantities, Results, UncertaintyComponents
from pantocheck.conformance.runs.record_folder import RecordFolder

RECORD_COMPONENTS: tuple[ComponentName, ...] = ("section", "length")
"""Components of the uncertainty that follow from the record alone; the others need further runs."""

RECORD_TOLERANCE = 1e-6
"""Largest relative difference of a quantity that is computed from a record again.

A table of a record has at least nine significant digits; extremes and filters keep their accuracy."""


@dataclass(frozen=True)
class RecomputedRecord:
    """Quantities of a record with the components of their uncertainty, by owner and name; its state, if judged."""

    quantities: dict[str, dict[str, Number]]
    components: UncertaintyComponents
    state: RecordState | None


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
    files = (sidecar, sidecar.parent / opened.file) if isinstance(opened, RecordSidecar) else (sidecar,)
    computed = _compute(result, results, sidecar, catalogue)
    return [
        *_compare(result, computed, path.name),
        *_name_others(result, computed),
        _check_digest(result, record_digest(*files), path),
    ]


def _compare(result: CaseResult, computed: RecomputedRecord, name: str) -> Iterator[DocumentCheck]:
    """Compare quantities, the parts of their uncertainty that follow from the record, and its state."""
    stated = result.quantities
    pairs = (
        (_select(stated, computed.quantities), _select(computed.quantities, stated)),
        (_keep_components(result.uncertainty_components), _keep_components(computed.components)),
    )
    numbers, widths = (compare_numbers(*pair, RECORD_TOLERANCE) for pair in pairs)
    differences = [*numbers.differences, *(f"uncertainty, {text}" for text in widths.differences)]
    if computed.state is not None and result.record is not None and result.record.state != computed.state:
        differences.append(f"state of the record '{result.record.state}' stated, '{computed.state}' computed")
    largest = max(numbers.largest, widths.largest)
    yield judge_details(
        f"{result.id}: {numbers.count} quantities follow from the samples of {name} (largest relative difference "
        f"{largest:.1e}).",
        f"{result.id}: the results do not follow from the samples of {name}.",
        differences,
    )


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
        return RecomputedRecord(key_by_owner(select_finite(assessed.values.values)), parts, None)
    if (entry := catalogue.find_id(result.id)) is None:
        hint = "Give the folder of the case by --cases, or install the distribution that offers it."
        raise InputError(f"record '{sidecar.name}'", f"{result.id} is not in the installed library", hint)
    system = RecordFolder(results.system.name, results.system.version, ((result.id, sidecar),))
    case = load_entry(entry)
    graded = grade_case(case, system.run(case), results.trust)
    state = None if graded.record is None else graded.record.state
    return RecomputedRecord(graded.quantities, graded.uncertainty_components, state)
