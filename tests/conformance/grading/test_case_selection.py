"""Selection: requested verdicts by system, and the cases of a run without a list of cases."""

import pytest

from helpers.converged_fixtures import StateConverged
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.plan import Plan, PreparedPlan, prepare_plan
from pantocheck.conformance.grading.case_selection import VerdictChoice, choose_verdicts

TWIN, PUBLISHED = "en50318-2018/ac-simple/320-twin", "en50318-2002/250"
BOTH = ("criteria", "verification")


@pytest.fixture
def verifiable(state_converged: StateConverged, case_250: Case) -> None:
    """Converged values for a case with published limits and for one without any."""
    for name in (PUBLISHED, TWIN):
        renamed = case_250.file.model_copy(update={"id": name})
        state_converged(Case(renamed, case_250.line, case_250.pantographs, ()), {})


@pytest.mark.parametrize(
    ("choice", "system", "cases", "expected"),
    [
        (None, "builtin", [PUBLISHED], ("criteria",)),
        (None, "record:folder", [PUBLISHED], BOTH),
        (None, "command:program", ["own", PUBLISHED], BOTH),
        (None, "record:folder", ["own"], ("criteria",)),
        ("both", "builtin", ["own"], BOTH),
        ("verification", "builtin", [PUBLISHED], ("verification",)),
        ("criteria", "record:folder", [PUBLISHED], ("criteria",)),
    ],
)
@pytest.mark.usefixtures("verifiable")
def test_requested_verdicts_by_system(
    choice: VerdictChoice | None, system: str, cases: list[str], expected: tuple[str, ...]
) -> None:
    assert choose_verdicts(choice, system, cases) == expected


def ids(prepared: PreparedPlan) -> set[str]:
    return {case.id for case in prepared.cases}


@pytest.mark.usefixtures("verifiable")
def test_default_run_of_another_system_takes_the_cases_with_converged_values() -> None:
    builtin, foreign = (prepare_plan(Plan(system=system)) for system in ("builtin", "record:folder"))
    assert ids(foreign) - ids(builtin) == {TWIN}
    assert builtin.participation.requested == ("criteria",)
    assert builtin.participation.verification_only == ()
    assert foreign.participation.requested == BOTH
    assert foreign.participation.verification_only == (TWIN,)
    assert foreign.participation.information == builtin.participation.information


@pytest.mark.usefixtures("verifiable")
def test_verification_takes_no_other_case_than_required_or_named_ones() -> None:
    """The static check that the twin requires has no converged values here: it is shown for information."""
    prepared = prepare_plan(Plan(verdicts="verification"))
    assert ids(prepared) == {PUBLISHED, TWIN, "en50318-2018/ac-simple/static"}
    assert prepared.participation.information == ("en50318-2018/ac-simple/static",)
    # A case that the user names has no limit that counts: the criteria stay informative.
    assert prepare_plan(Plan(cases=(TWIN,), verdicts="both")).participation.verification_only == ()


def test_default_run_without_converged_values_needs_a_limit(state_converged: StateConverged) -> None:
    with pytest.raises(InputError, match="no limit counts"):
        prepare_plan(Plan(verdicts="verification"))
