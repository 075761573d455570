"""Messages of a run that an adapter must answer beside those of one pantograph: the line at rest, two pantographs."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.results.outcome import Delivered, Errored, Skipped
from pantocheck.conformance.self_test.adapter_cases import build_case_at_rest, build_twin_case
from pantocheck.conformance.self_test.adapter_finding import AdapterFinding
from pantocheck.conformance.systems.system import System

REST_SUBJECT = "line at rest"
"""Subject of the finding on a check of the line at rest."""

TWIN_SUBJECT = "two pantographs"
"""Subject of the finding on a passage with two pantographs."""


def check_line_at_rest(system: System) -> AdapterFinding:
    """Send a check of the line at rest, and name the answer: values, a refusal or an error.

    Args:
        system: The adapter.
    """
    case = build_case_at_rest()
    outcome = system.run(case)
    if not isinstance(outcome, Delivered):
        return _describe_no_delivery(
            REST_SUBJECT,
            outcome,
            "Checks of the line at rest are skipped.",
            "In this message, speed_km_h and derived.train are null, and pantographs is empty. `run` sends it before "
            "cases that require it, and does not run them after an error. Answer with values in `static`, or 'skipped'",
        )
    result = grade_case(case, outcome, "secondary")
    if result.verdict == "error":
        return AdapterFinding("wrong", REST_SUBJECT, f"{result.reason}.")
    if not outcome.static:
        text = "'delivered' without a value. Put the quantities into `static`, or answer 'skipped'."
        return AdapterFinding("missing", REST_SUBJECT, text)
    return AdapterFinding("ok", REST_SUBJECT, f"values were delivered: {', '.join(sorted(outcome.static))}.")


def check_two_pantographs(system: System) -> AdapterFinding:
    """Send the short case with two pantographs, and name the answer: a record of both, a refusal or an error.

    Args:
        system: The adapter.
    """
    case = build_twin_case()
    outcome = system.run(case)
    if not isinstance(outcome, Delivered):
        return _describe_no_delivery(
            TWIN_SUBJECT,
            outcome,
            "Cases with several pantographs are skipped.",
            "Answer with a record of all pantographs, or 'skipped'",
        )
    return _check_twin_record(case, outcome)


def _describe_no_delivery(subject: str, outcome: Skipped | Errored, consequence: str, remedy: str) -> AdapterFinding:
    """Finding on an answer without a delivery; a refusal is no fault of an adapter."""
    if isinstance(outcome, Skipped):
        return AdapterFinding("note", subject, f"refused: {outcome.reason}. {consequence}")
    return AdapterFinding("wrong", subject, f"error: {outcome.reason}. {remedy}.")


def _check_twin_record(case: Case, delivered: Delivered) -> AdapterFinding:
    if delivered.record is None:
        return AdapterFinding("missing", TWIN_SUBJECT, "'delivered' without a record. Write one, or answer 'skipped'.")
    result = grade_case(case, delivered, "secondary")
    if result.record is None:
        text = (
            f"{result.reason}. Write position, force and contact height of every pantograph, in running order, or "
            "answer 'skipped'."
        )
        return AdapterFinding("wrong", TWIN_SUBJECT, text)
    if result.record.state == "contradicted":
        return AdapterFinding("wrong", TWIN_SUBJECT, f"the record is contradicted: {result.record.reason}.")
    return AdapterFinding("ok", TWIN_SUBJECT, "a record of both pantographs was delivered.")
