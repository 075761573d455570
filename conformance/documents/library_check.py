"""Check of cases, inputs and limits against the installed library."""

from collections.abc import Iterable, Iterator

from pantocheck.conformance.cases.case import Case, CaseOrigin
from pantocheck.conformance.cases.catalogue import CaseEntry, Catalogue
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.library import find_library_case, list_library_limits, load_entry, source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import Profile, list_profiles, load_profile
from pantocheck.conformance.core.criterion import Criterion, LimitTarget
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, judge_details, shorten_details
from pantocheck.conformance.documents.document_reading import list_suite_differences
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.case_identity import (
    describe_limit_change,
    limits_digest,
    name_limit,
    profile_limits_digest,
)
from pantocheck.conformance.grading.case_verification import (
    build_requirements,
    find_obstacle,
    include_start,
    verification_digest,
    verify_ungraded,
)
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.grading.input_sensitivity import list_possible_sentences
from pantocheck.conformance.grading.supported_frequencies import list_case_frequencies
from pantocheck.conformance.grading.validity_warnings import validity_warnings, warn_of_unvalidated_band
from pantocheck.conformance.quantities.evaluation import Evaluation, Value
from pantocheck.conformance.quantities.limit_text import format_bounds
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.runs.resolution import list_mesh_frequencies
from pantocheck.conformance.runs.system import note_case_version

STATED_FACTS = {
    "title": "title",
    "input_digest": "digest of the inputs",
    "stated_limits_digest": "digest of the limits of the case file",
    "edition": "edition",
    "superseded_by": "superseding edition",
    "steps": "steps of the procedure",
}
"""Keys of a result that follow from the case alone."""

RUN_FACTS = {
    "speed_km_h": "speed",
    "filter": "filter",
    "evaluated_m": "analysis section",
    "law_forces": "forces of the force law",
}
"""Keys of the run that follow from the case alone."""


def check_library(results: Results) -> list[DocumentCheck]:
    """Check the cases of results against the installed library.

    A case that the results state as identical to the library must agree with it. Cases that they state as own or as
    modified copies are named, because nothing shows that their inputs and limits are those of a standard.
    """
    differences = [f"{case.id}, {text}" for case in results.cases for text in _compare_case(case)]
    differences += [f"{case.id}, {text}" for case in results.cases for text in list_claimed_limits(case)]
    if results.system.kind != "command":  # a program may state notes of its own
        differences += [f"{case.id}, {text}" for case in results.cases for text in _list_foreign_notes(case)]
    differences += [f"{case.id}, {text}" for case in results.cases for text in _compare_supported(case)]
    others = [f"{case.id}: {text}" for case in results.cases for text in _describe_others(case)]
    checks = []
    if differences and list_suite_differences(results):
        checks.append(
            DocumentCheck(
                "incomplete", "The installed library has other cases or limits.", shorten_details(differences)
            )
        )
    elif differences or any(case.library not in {"own", "modified"} for case in results.cases):
        proved = "Inputs, limits and texts of the library cases are those of the installed library."
        checks.append(judge_details(proved, "Cases or limits are not those of the library.", differences))
    if others:
        checks.append(DocumentCheck("open", "These inputs and limits are not those of the library.", tuple(others)))
    return checks


def _compare_case(result: CaseResult) -> Iterator[str]:
    """Contradictions of a result with the library case of its id."""
    case = find_library_case(result.id)
    is_known = case is not None if result.profile is None else result.profile in list_profiles()
    if not is_known:
        if result.library in ("identical", "modified"):
            yield f"stated as '{result.library}': the installed library has no case or profile of this name"
    elif result.library == "own":
        yield "stated as an own case: the installed library has a case or profile of this name"
    elif result.library == "modified":
        return
    elif result.profile is not None:
        yield from compare_profile(load_profile(result.profile), result)
    elif case is not None:
        yield from compare_with_case(case, result)


def compare_with_case(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of a result from the facts and limits of its case, one sentence each."""
    expected = build_ungraded(case, "skip", "only the facts of the case are compared")
    for key, words in STATED_FACTS.items():
        if (stated := getattr(result, key)) != (wanted := getattr(expected, key)):
            yield f"{words}: {_name(wanted)} in the library, {_name(stated)} in the certificate"
    for key, words in RUN_FACTS.items():
        if getattr(result.run, key) != getattr(expected.run, key):
            yield f"the {words} differs from that of the library"
    read = [(reading.id, reading.filter or case.file.filter) for reading in case.file.reading] if result.traces else []
    if [(reading.id, reading.filter) for reading in result.readings] != read:
        yield "the readings of the evaluation differ from those of the library"
    missing = [group.group for group in expected.inputs if group not in result.inputs]
    if missing:
        yield f"sources or trust of the inputs differ from those of the library: {', '.join(missing)}"
    others = [fact.name for fact in expected.derived if fact not in result.derived]
    if others:
        yield f"derived values differ from those of the library: {', '.join(others)}"
    if result.signals is not None and result.signals.line_supports_m != [float(x) for x in case.line.geometry.supports]:
        yield "the supports of the embedded signals differ from those of the library"
    if result.conditions != expected.conditions:
        yield "the conditions of the values differ from those of the library"
    if not set(result.input_studies) <= list_possible_sentences(case):
        yield "the sentences on errors of the inputs differ from those of the library"
    if not set(case.notes) <= set(result.notes):
        yield "a note of the library case is missing"
    if result.changes:
        yield "changed inputs are stated, but the inputs are stated as those of the library"
    yield from compare_limits(case, result)
    yield from compare_verification_limits(case, result)
    yield from _compare_warnings(case, result)


def _compare_supported(result: CaseResult) -> Iterator[str]:
    """Difference of the supported frequencies from those of the library case; a simulator may state its mesh, too."""
    case = find_library_case(result.id)
    if case is None or result.library != "identical" or result.profile is not None:
        return
    rows = list(list_case_frequencies(case))
    mesh = [] if case.is_static else list(list_mesh_frequencies(case, case.file.discretisation))
    if result.supported not in (rows, rows + mesh):
        yield "the supported frequencies differ from those of the library"


def _list_foreign_notes(result: CaseResult) -> Iterator[str]:
    """Notes of a library case that follow neither from it nor from its record, whose samples were checked."""
    case, record = find_library_case(result.id), result.record
    if case is None or result.library != "identical" or result.profile or record is None or not record.checks:
        return
    if result.charts or result.tables:
        return  # a study states notes of its own
    known = {*case.notes, record.start_text, *(row.text for row in record.checks), *note_case_version(None)}
    yield from (f"the note '{_name(note)}' is not in the library" for note in result.notes if note not in known)


def _compare_warnings(case: Case, result: CaseResult) -> Iterator[str]:
    """Warnings on the limits of validity that follow from the case and the stated quantities."""
    if not result.quantities or result.reason:
        return
    values: dict[int, dict[str, Value]] = {
        int(owner): {name: tuple(value) if isinstance(value, list) else value for name, value in quantities.items()}
        for owner, quantities in result.quantities.items()
    }
    evaluation = Evaluation(values, {})
    for warning in (*validity_warnings(case, evaluation), *warn_of_unvalidated_band(evaluation)):
        if warning not in result.warnings:
            yield f"the warning '{warning.split(':')[0]}' is missing"


def _describe_others(result: CaseResult) -> Iterator[str]:
    """Cases whose inputs or limits are not those of the library, as the results state them."""
    case = find_library_case(result.id)
    if result.profile is not None:
        if result.library != "identical":
            yield f"profile {result.profile}: its rules are not those of the library"
    elif result.library == "modified" and case is not None:
        inputs = "other inputs" if result.input_digest != case.digest else "the inputs of the library"
        yield f"modified copy of the library case, with {inputs}"
        yield from (f"limit {text}" for text in list_own_limits(case, result))
    elif result.library == "own":
        yield "an own case" if result.origin is None else f"an own case, {result.origin.text}"
    elif case is not None and result.limits_digest != result.stated_limits_digest:
        yield from (f"limit of a limits file: {text}" for text in list_own_limits(case, result))


def _name(value: object) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:24]}…"


# Assessment of a record against the installed profile of its name.
def compare_profile(profile: Profile, result: CaseResult) -> Iterator[str]:
    """Differences of an assessment from the profile of the library.

    The bounds of most rules depend on the record, so that only `--record` recomputes them.
    """
    if result.stated_limits_digest != profile_limits_digest(profile):
        yield "digest of the rules: another one in the library"
    if result.run.filter.model_dump() != profile.filter.model_dump():
        yield "the filter differs from that of the library"
    if result.record is not None and result.record.demanded != (profile.verification == "demanded"):
        yield "whether verification is demanded differs from the library"
    if result.limits_digest != result.stated_limits_digest:
        return  # limits of a user replace rules; `limit_changes` names the weakened ones
    graded = {row.quantity for row in result.criteria}
    for rule in profile.rule:
        if rule.quantity not in graded:
            yield f"{rule.quantity}: a rule in the library, no criterion in the certificate"
    trusts = {rule.quantity: rule.trust for rule in profile.rule}
    for row in result.criteria:
        if row.quantity in trusts and row.trust != trusts[row.quantity] and not row.is_drift:
            yield f"{row.quantity}: trust '{trusts[row.quantity]}' in the library, '{row.trust}' in the certificate"


# Check of cases from outside against the distribution or folder that holds them.
SOURCE_REMEDIES = {
    "file": "only the digest of its file is stated",
    "folder": "give its folder by --cases",
    "distribution": "install the distribution",
}
"""Way to compare a case whose source is not at hand, by the kind of the source."""


def check_outside_cases(results: Results, catalogue: Catalogue) -> list[DocumentCheck]:
    """Compare the cases from outside with the sources that are at hand.

    A source is written by its author, so that a proved comparison shows the origin of inputs and limits, not their
    quality.

    Args:
        results: Results of a document.
        catalogue: Folders of the user; installed distributions are searched for the ids of the results.
    """
    return [_check(case, case.origin, catalogue) for case in results.cases if case.origin is not None]


def _check(result: CaseResult, stated: CaseOrigin, catalogue: Catalogue) -> DocumentCheck:
    try:
        entry = catalogue.find_id(result.id)
    except InputError as error:
        return DocumentCheck("open", f"{result.id} was not compared: {stated.text} is refused.", (error.message,))
    if entry is None or entry.origin is None or (entry.origin.kind, entry.origin.name) != (stated.kind, stated.name):
        return DocumentCheck(
            "open", f"{result.id} was not compared with {stated.text}: {SOURCE_REMEDIES[stated.kind]}."
        )
    if entry.origin.version != stated.version:
        text = f"{result.id} was not compared with {stated.text}: version {entry.origin.version} is installed."
        return DocumentCheck("open", text)
    return judge_details(
        f"Inputs, limits and texts of {result.id} are those of {stated.text}, as its author states them.",
        f"{result.id} is not the case of {stated.text}.",
        _list_differences(result, entry, stated),
    )


def _list_differences(result: CaseResult, entry: CaseEntry, stated: CaseOrigin) -> Iterator[str]:
    # The sentences of the comparison call the place of the case the library.
    yield from (text.replace("the library", stated.text) for text in compare_with_case(load_entry(entry), result))
    if entry.origin is not None and entry.origin.digest != stated.digest:
        yield f"digest of all files: {entry.origin.digest[:19]} at hand, {stated.digest[:19]} in the certificate"


# Limits of a result against those of the installed case.
def compare_limits(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of the limits of a result from those of the installed case.

    Limits of a user may replace those of the case. The result must then state each limit that they weaken.
    """
    rows = _by_target(row for row in result.criteria if not row.is_drift)
    limits = {limit.target: limit for limit in case.limits}
    if not rows and result.verdict in ("skip", "error") and result.reason:
        return  # not graded
    if result.limits_digest == limits_digest(case.limits):
        for target in rows.keys() - limits.keys():
            yield f"{criterion_name(rows[target])}: no limit in the library, {_bounds(rows[target])} in the certificate"
        for target, limit in limits.items():
            yield from _compare_limit(limit, rows.get(target))
        yield from (
            f"'{_name(text)}' is stated, but the limits are those of the library" for text in result.limit_changes
        )
        return
    if not list_own_limits(case, result) and not limits.keys() - rows.keys():
        yield "digest of the limits: another one in the certificate, but every limit is that of the library"
    changes = [
        describe_limit_change(limit, _replacing_limit(limit, rows.get(target))) for target, limit in limits.items()
    ]
    yield from (
        f"{text}, which the certificate does not state" for text in changes if text and text not in result.limit_changes
    )
    yield from (
        f"'{_name(text)}' does not follow from the limits" for text in result.limit_changes if text not in changes
    )


def list_own_limits(case: Case, result: CaseResult) -> list[str]:
    """Limits of a result that are not those of the installed case, although it is not stated as modified."""
    limits = {limit.target: limit for limit in case.limits}
    rows = _by_target(row for row in result.criteria if not row.is_drift)
    return [
        f"{criterion_name(row)}: {_bounds(row)}"
        for target, row in rows.items()
        if target not in limits or list(_compare_limit(limits[target], row))
    ]


def list_claimed_limits(result: CaseResult) -> Iterator[str]:
    """Limits of a case that are not in the library, but claim another trust than that of a user."""
    limits = {limit.target: limit for limit in list_library_limits(result.id)}
    rows = _by_target(row for row in result.criteria if not row.is_drift and result.profile is None)
    for target, row in rows.items():
        is_library = target in limits and not list(_compare_limit(limits[target], row))
        if row.trust != "own" and not is_library:
            yield f"{criterion_name(row)}: trust '{row.trust}' of a limit that is not in the library; expected 'own'"


def compare_verification_limits(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of the verification limits from the converged values of the installed case; as `compare_limits`."""
    converged, stated = find_converged(case.id), result.verification
    if converged is None:
        if stated is not None:
            yield "the library has no converged values of this case, the certificate has a verification"
        return
    if stated is None:
        yield "the library has converged values of this case, the certificate has no verification"
        return
    if stated.digest != verification_digest(converged):
        yield "the converged values of the library are others than those of the certificate (digest)"
    graded = not (result.reason and result.verdict in ("skip", "error"))
    if find_obstacle(case, converged) is not None or not graded or stated.verdict == "error":
        return
    requirements = build_requirements(converged, case.is_static)
    if result.record is not None and result.record.start == "differs":
        requirements = tuple(include_start(requirement, converged) for requirement in requirements)
    again = verify_ungraded(case, stated.verdict, "")
    if again is not None and (stated.omitted, stated.confirmed_by, stated.reason) != (
        again.omitted,
        again.confirmed_by,
        None,
    ):
        yield "verification: omitted quantities, second formulation or reason are not those of the library"
    rows, wanted = _by_target(stated.criteria), {item.target: item for item in requirements}
    for target in rows.keys() - wanted.keys():
        yield f"{criterion_name(rows[target])}: no converged value in the library, a limit in the certificate"
    for target, requirement in wanted.items():
        row = rows.get(target)
        if row is None:
            yield f"{requirement.quantity}: the verification of the certificate lacks this quantity"
        elif (row.lower, row.upper) != (requirement.lower, requirement.upper):
            bounds = format_bounds(requirement.lower, requirement.upper)
            name = criterion_name(row)
            yield f"verification of {name}: {bounds} in the library, {_bounds(row)} in the certificate"
        elif any(getattr(row, key) != part for key, part in requirement if key != "finding"):
            yield f"verification of {criterion_name(row)}: trust or source of the limit is not that of the library"


def _compare_limit(limit: Limit, row: Criterion | None) -> Iterator[str]:
    name = name_limit(limit)
    if row is None:
        bounds = format_bounds(limit.lower, limit.upper)
        yield f"{name}: limit {bounds} in the library, no criterion in the certificate"
        return
    if (row.lower, row.upper) != (limit.lower, limit.upper):
        bounds = format_bounds(limit.lower, limit.upper)
        yield f"{name}: limit {bounds} {row.unit} in the library, {_bounds(row)} {row.unit} in the certificate"
    if row.trust != limit.trust:
        yield f"{name}: trust '{limit.trust}' in the library, '{row.trust}' in the certificate"
    if row.source != source_text(limit.source):
        yield f"{name}: the source of the limit is another one than in the library"
    roles = [None if item is None else item.role for item in (limit.finding, row.finding)]
    if roles[0] != roles[1]:
        yield f"{name}: finding '{roles[0]}' in the library, '{roles[1]}' in the certificate"


def _replacing_limit(limit: Limit, row: Criterion | None) -> Limit | None:
    """Limit of the case with the bounds and trust of a criterion; None without a criterion."""
    if row is None:
        return None
    finding = limit.finding if row.finding is not None else None
    return limit.model_copy(update={"lower": row.lower, "upper": row.upper, "trust": row.trust, "finding": finding})


def _by_target(rows: Iterable[Criterion]) -> dict[LimitTarget, Criterion]:
    return {row.target: row for row in rows}


def _bounds(row: Criterion) -> str:
    return format_bounds(row.lower, row.upper)
