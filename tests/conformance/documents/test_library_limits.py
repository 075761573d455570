"""Limits of a result beside those of the installed case: every limit that differs is named, and no other."""

import pytest
from pydantic import ValidationError

from helpers.example_results import passing_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.findings import GradedFinding
from pantocheck.conformance.documents.library_check import compare_limits, list_own_limits
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.grading.criterion_grading import GradedValues, criterion_name, grade_limit
from pantocheck.conformance.quantities.evaluation import Evaluation
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
