"""Check of cases, inputs and limits against the installed library."""

from collections.abc import Iterator

from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck, judge_details, shorten_details
from pantocheck.conformance.authenticity.limit_comparison import (
    compare_limits,
    compare_verification_limits,
    list_own_limits,
)
from pantocheck.conformance.authenticity.profile_comparison import compare_profile
from pantocheck.conformance.authenticity.version_differences import list_suite_differences
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.library_list import list_library
from pantocheck.conformance.cases.profile_file import list_profiles, load_profile
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.extended_band import find_unvalidated
from pantocheck.conformance.grading.validity_warnings import validity_warnings
from pantocheck.conformance.quantities.evaluation import Evaluation, Value
from pantocheck.conformance.results.results_format import CaseResult, Results

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
    known = list_profiles() if result.profile is not None else list_library(library_folder())
    name = result.profile or result.id
    if name not in known:
        if result.library in ("identical", "modified"):
            yield f"stated as '{result.library}': the installed library has no case or profile of this name"
    elif result.library == "own":
        yield "stated as an own case: the installed library has a case or profile of this name"
    elif result.library == "modified":
        return
    elif result.profile is not None:
        yield from compare_profile(load_profile(result.profile), result)
    else:
        yield from compare_with_case(load_case(known[name]), result)


def compare_with_case(case: Case, result: CaseResult) -> Iterator[str]:
    """Differences of a result from the facts and limits of its case, one sentence each."""
    expected = build_ungraded(case, "skip", "only the facts of the case are compared")
    for key, words in STATED_FACTS.items():
        if (stated := getattr(result, key)) != (wanted := getattr(expected, key)) and stated is not None:
            yield f"{words}: {_name(wanted)} in the library, {_name(stated)} in the certificate"
    for key, words in RUN_FACTS.items():
        if getattr(result.run, key) != getattr(expected.run, key):
            yield f"the {words} differs from that of the library"
    missing = [group.group for group in expected.inputs if group not in result.inputs]
    if missing:
        yield f"sources or trust of the inputs differ from those of the library: {', '.join(missing)}"
    others = [fact.name for fact in expected.derived if fact not in result.derived]
    if others:
        yield f"derived values differ from those of the library: {', '.join(others)}"
    if not set(case.notes) <= set(result.notes):
        yield "a note of the library case is missing"
    if result.changes:
        yield "changed inputs are stated, but the inputs are stated as those of the library"
    yield from compare_limits(case, result)
    yield from compare_verification_limits(case, result)
    yield from _compare_warnings(case, result)


def _compare_warnings(case: Case, result: CaseResult) -> Iterator[str]:
    """Warnings on the limits of validity that follow from the case and the stated quantities."""
    if not result.quantities or result.reason:
        return
    values: dict[int, dict[str, Value]] = {
        int(owner): {name: tuple(value) if isinstance(value, list) else value for name, value in quantities.items()}
        for owner, quantities in result.quantities.items()
    }
    evaluation = Evaluation(values, {})
    for warning in (*validity_warnings(case, evaluation), *find_unvalidated(evaluation)):
        if warning not in result.warnings:
            yield f"the warning '{warning.split(':')[0]}' is missing"


def _describe_others(result: CaseResult) -> Iterator[str]:
    """Cases whose inputs or limits are not those of the library, as the results state them."""
    known = list_library(library_folder())
    if result.profile is not None:
        if result.library != "identical":
            yield f"profile {result.profile}: its rules are not those of the library"
    elif result.library == "modified" and result.id in known:
        case = load_case(known[result.id])
        inputs = "other inputs" if result.input_digest != case.digest else "the inputs of the library"
        yield f"modified copy of the library case, with {inputs}"
        yield from (f"limit {text}" for text in list_own_limits(case, result))
    elif result.library == "own":
        yield "an own case" if result.origin is None else f"an own case, {result.origin.text}"
    elif result.id in known and result.limits_digest != result.stated_limits_digest:
        yield from (f"limit of a limits file: {text}" for text in list_own_limits(load_case(known[result.id]), result))


def _name(value: object) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:24]}…"
