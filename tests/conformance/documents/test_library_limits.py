"""Limits of a result beside those of the installed case: every limit that differs is named, and no other."""

from types import SimpleNamespace

import pytest
from pydantic import ValidationError

from helpers.example_results import passing_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.findings import GradedFinding
from pantocheck.conformance.documents.library_check import (
    compare_limits,
    compare_profile,
    compare_with_case,
    list_claimed_limits,
    list_own_limits,
)
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.case_identity import limits_digest, profile_limits_digest
from pantocheck.conformance.grading.criterion_grading import GradedValues, criterion_name, grade_limit
from pantocheck.conformance.quantities.evaluation import Evaluation
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.results.results_format import CaseResult


@pytest.fixture
def result(case_250: Case) -> CaseResult:
    """Result with the limits of the case; the limits do not depend on its values."""
    rows = [grade_limit(limit, GradedValues(Evaluation({}, {})), "secondary") for limit in case_250.limits]
    identity = {"id": case_250.id, "limits_digest": limits_digest(case_250.limits), "criteria": rows}
    return CaseResult.model_validate(passing_case()).model_copy(update=identity)


def widen(row: Criterion) -> Criterion:
    return row.model_copy(update={"upper": 1.0 + (row.upper or 0.0)})


def test_own_limits_are_named_alone(case_250: Case, result: CaseResult) -> None:
    assert len(result.criteria) > 2
    assert list_own_limits(case_250, result) == []
    assert list(compare_limits(case_250, result)) == []
    for number, row in enumerate(result.criteria):
        rows = [*result.criteria[:number], widen(row), *result.criteria[number + 1 :]]
        changed = result.model_copy(update={"criteria": rows})
        for found in (list_own_limits(case_250, changed), list(compare_limits(case_250, changed))):
            assert len(found) == 1
            assert found[0].startswith(row.quantity)
    with pytest.raises(ValidationError, match="frozen"):
        result.verdict = "fail"
    # A case that was not graded has no rows; any rows must have the limits of the case.
    skipped = result.model_copy(update={"verdict": "skip", "reason": "no record", "criteria": []})
    assert list(compare_limits(case_250, skipped)) == []
    weakened = skipped.model_copy(update={"criteria": [widen(result.criteria[0]), *result.criteria[1:]]})
    assert len(list(compare_limits(case_250, weakened))) == 1
    finding = GradedFinding(section="4", sentence="s", role="imposed", tolerance="t", outcome="imposed")
    graded = [result.criteria[0].model_copy(update={"finding": finding}), *result.criteria[1:]]
    (found,) = compare_limits(case_250, result.model_copy(update={"criteria": graded}))
    assert "finding 'None' in the library, 'imposed' in the certificate" in found
    added = result.criteria[0].model_copy(update={"pantograph": 7})
    changed = result.model_copy(update={"criteria": [*result.criteria, added]})
    for found in (list_own_limits(case_250, changed), list(compare_limits(case_250, changed))):
        assert [text.startswith(criterion_name(added)) for text in found] == [True]


def test_each_fact_of_a_case_is_compared(case_250: Case) -> None:
    stated = build_ungraded(case_250, "skip", "not run")
    known = set(compare_with_case(case_250, stated))
    faster = stated.run.model_copy(update={"speed_km_h": 260.0})
    for changes, text in (
        ({"title": "Other"}, "title: EN 50318:2002 reference model, 250 km/h in the library, Other in the certificate"),
        ({"run": faster}, "the speed differs"),
        ({"readings": [SimpleNamespace(id="other", filter=None)]}, "the readings of the evaluation differ"),
        ({"inputs": stated.inputs[1:]}, f"inputs differ from those of the library: {stated.inputs[0].group}"),
        ({"derived": stated.derived[1:]}, f"derived values differ from those of the library: {stated.derived[0].name}"),
        ({"notes": []}, "a note of the library case is missing"),
        ({"changes": ["speed_km_h = 260 (file: 250)"]}, "changed inputs are stated"),
    ):
        (found,) = set(compare_with_case(case_250, stated.model_copy(update=changes))) - known
        assert text in found


def test_each_fact_of_an_assessment_is_compared(result: CaseResult) -> None:
    profile = load_profile("acceptance-ac")
    rows = [result.criteria[0].model_copy(update={"quantity": r.quantity, "trust": r.trust}) for r in profile.rule]
    digest = profile_limits_digest(profile)
    facts = {"run": result.run.model_copy(update={"filter": profile.filter}), "criteria": rows, "record": None}
    assessed = result.model_copy(update=facts | {"limits_digest": digest, "stated_limits_digest": digest})
    assert list(compare_profile(profile, assessed)) == []
    own = rows[0].model_copy(update={"trust": "own"})
    for changes, text in (
        ({"limits_digest": "0", "stated_limits_digest": "0"}, "digest of the rules"),
        ({"run": result.run.model_copy(update={"filter": Filter(cutoff_Hz=10.0)})}, "the filter differs"),
        ({"criteria": rows[1:]}, f"{rows[0].quantity}: a rule in the library, no criterion"),
        ({"criteria": [own, *rows[1:]]}, f"'{rows[0].trust}' in the library, 'own' in the certificate"),
    ):
        (found,) = compare_profile(profile, assessed.model_copy(update=changes))
        assert text in found
    without_rows = {"criteria": [], "limits_digest": "own"}  # the limits of a user replace the rules
    assert list(compare_profile(profile, assessed.model_copy(update=without_rows))) == []


@pytest.mark.parametrize("library", ["identical", "modified", "own"])
def test_limit_of_a_user_with_another_trust_is_found(case_250: Case, result: CaseResult, library: str) -> None:
    """A limits file, a modified copy and an own case: whatever a limit claims, its trust is that of the user."""
    stated = result.model_copy(update={"library": library, "id": "own/250" if library == "own" else case_250.id})
    rows = [widen(result.criteria[0]), *result.criteria[1:]]
    claimed = list(list_claimed_limits(stated.model_copy(update={"criteria": rows})))
    assert len(claimed) == (len(rows) if library == "own" else 1)
    assert claimed[0].startswith(
        "mean_force_N of pantograph 1: trust 'secondary' of a limit that is not in the library"
    )
    own = [row.model_copy(update={"trust": "own"}) for row in rows]
    assert list(list_claimed_limits(stated.model_copy(update={"criteria": own}))) == []
    assert library == "own" or list(list_claimed_limits(stated)) == []
