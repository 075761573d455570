"""Findings of publications: only a held-out finding inside its bounds is reproduced, and counts."""

from dataclasses import replace
from typing import Any

import pytest

from helpers.shown_page import shown_certificate
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.findings import PublishedFinding, Role
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.case_identity import describe_limit_change, limits_digest
from pantocheck.conformance.grading.results_building import build_results
from pantocheck.conformance.pages.certificate_page import build_summary
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.results_format import CaseResult, Results, SystemIdentity
from pantocheck.conformance.runs.system import Delivered, StudyResult

SYSTEM = SystemIdentity(name="test", version="1", kind="builtin")
QUANTITIES = ("damping_gain_step", "dropper_locked_force_pct", "damping_rise_pct", "damping_decrease_pct")


def build_limit(quantity: str, role: Role, trust: Any = "primary") -> Limit:
    """Limit of at most 10 that grades a finding."""
    texts = {"section": "5.1", "printed": "10 %", "tolerance": "by choice", "sensitivity": "it depends on the speed"}
    finding = PublishedFinding(sentence=f"Sentence on {quantity}.", role=role, **texts)
    return Limit(quantity=quantity, upper=10.0, trust=trust, source="vovan2015", finding=finding)


def grade(values: dict[str, float], *limits: Limit) -> CaseResult:
    """Result of a study of the library with other limits."""
    (case,) = select_cases(["vovan2015/steady-arm-damper"])
    return grade_case(replace(case, limits=limits), Delivered(study=StudyResult({LINE: dict(values)})), "primary")


@pytest.mark.parametrize(
    ("role", "value", "outcome", "verdict"),
    [
        ("held_out", 9.0, "reproduced", "pass"),
        ("held_out", 11.0, "not_reproduced", "fail"),
        ("held_out", None, "not_evaluated", "skip"),
        ("imposed", 9.0, "imposed", "info"),
        ("imposed", 11.0, "not_reproduced", "fail"),
        ("imposed", None, "not_evaluated", "skip"),
        ("inferred", 9.0, "inferred_met", "pass"),
        ("inferred", 11.0, "inferred_not_met", "fail"),
    ],
)
def test_outcome_of_a_finding(role: Role, value: float | None, outcome: str, verdict: str) -> None:
    """An imposed finding never makes a case pass, but a contradicted one makes it fail."""
    result = grade({} if value is None else {QUANTITIES[0]: value}, build_limit(QUANTITIES[0], role))
    (row,) = result.criteria
    assert (row.finding.outcome, row.verdict, result.verdict) == (outcome, verdict, verdict)


def test_outcome_does_not_depend_on_the_trust_that_counts() -> None:
    (row,) = grade({QUANTITIES[0]: 9.0}, build_limit(QUANTITIES[0], "held_out", trust="provisional")).criteria
    assert (row.finding.outcome, row.verdict) == ("reproduced", "info")


@pytest.fixture
def results() -> dict[str, Any]:
    """One imposed, one reproduced, one contradicted and one missing finding, in the order of `QUANTITIES`."""
    roles: tuple[Role, ...] = ("imposed", "held_out", "held_out", "held_out")
    limits = [build_limit(name, role) for name, role in zip(QUANTITIES, roles, strict=True)]
    case = grade(dict(zip(QUANTITIES, (1.0, 2.0, 30.0), strict=False)), *limits)
    return build_results([case], SYSTEM, "primary", "2026-01-01T00:00:00Z").to_dict()


def test_findings_are_counted_and_listed_with_the_reason_of_a_contradiction(results: dict[str, Any]) -> None:
    counts = {"imposed": 1, "reproduced": 1, "not_reproduced": 1, "not_evaluated": 1}
    assert results["findings"] == counts | {"inferred_met": 0, "inferred_not_met": 0}
    sentence = "Findings: 1 imposed, 1 reproduced, 1 not reproduced, 1 not evaluated."
    assert sentence in build_headline(Results.model_validate(results))
    assert find_discrepancies(Results.model_validate(results)) == []
    # The sensitivity explains a contradicted finding only.
    pages = (shown_certificate(results), render_markdown(build_summary(Results.model_validate(results))))
    for page in pages:
        assert page.count("it depends on the speed") == 1
        assert page.count("not reproduced") >= 2  # in the headline and in the table
    for name in QUANTITIES:
        assert f"Sentence on {name}." in pages[0]
    results["cases"][0]["criteria"][0]["finding"]["outcome"] = "not_reproduced"
    assert "imposed, not reproduced" in shown_certificate(results)


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (lambda row: row["finding"].update(outcome="reproduced"), "finding 'reproduced' stated, 'imposed' follows"),
        (lambda row: row["finding"].update(role="held_out"), "finding 'imposed' stated, 'reproduced' follows"),
        (lambda row: row.update(verdict="pass"), "verdict 'pass' stated, 'info' follows"),
        (lambda row: row.update(finding=None), "the numbers of findings do not follow"),
    ],
)
def test_falsified_finding_is_found(results: dict[str, Any], change: Any, found: str) -> None:
    change(results["cases"][0]["criteria"][0])
    assert any(found in text for text in find_discrepancies(Results.model_validate(results)))


def test_digest_and_change_of_a_limit_follow_the_role_of_its_finding() -> None:
    """The digest of limits is stored with results; texts of a finding do not change it, its role does."""
    imposed, held_out = (build_limit(QUANTITIES[0], role) for role in ("imposed", "held_out"))
    bare = imposed.model_copy(update={"finding": None})
    assert "finding" not in bare.model_dump(mode="json")
    reworded = imposed.model_copy(update={"finding": imposed.finding.model_copy(update={"sentence": "Another."})})
    assert limits_digest([reworded]) == limits_digest([imposed])
    assert len({limits_digest([limit]) for limit in (imposed, held_out, bare)}) == 3
    imposed, held_out = (build_limit(QUANTITIES[0], role) for role in ("imposed", "held_out"))
    assert "an imposed finding counts" in (describe_limit_change(imposed, held_out) or "")
    assert describe_limit_change(held_out, imposed) is None
