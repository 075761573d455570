"""`pantocheck pantograph check`: a good FMU, and broken ones, each refused with its reason."""

import pytest

from helpers.command_line import pantocheck
from helpers.fmu_fixtures import WriteFmu
from pantocheck.conformance.app.self_test.fmu_check import check_fmu
from pantocheck.conformance.runs import fmu_process

STEP = 0.004
"""Time step of the coupling [s]; half of it is checked, too."""


def findings(file: object) -> dict[str, tuple[str, str]]:
    return {found.subject: (found.state, found.text) for found in check_fmu(file, 120.0, STEP).findings}


def test_a_chain_as_fmu_passes(write_fmu: WriteFmu) -> None:
    found = findings(write_fmu())
    assert [state for state, _ in found.values()] == ["ok"] * 8 + ["note"]
    assert "differs from the linear model of the file by 0.00%" in found["response"][1]


def test_an_fmu_without_rollback_is_told_so(write_fmu: WriteFmu) -> None:
    found = findings(write_fmu(has_state=False, version=3))
    assert found["rollback"][0] == "note"
    assert "wrong" not in {state for state, _ in found.values()}


@pytest.mark.parametrize(
    ("fault", "subject", "reason"),
    [
        ("sign", "run", "check the sign of its force"),
        ("delay", "run", "whether its height answers within the step"),
        ("energy", "energy", "the head delivers energy"),
        ("crash", "run", "was ended by SIGSEGV"),
        ("hang", "run", "gave no answer within 1 s"),
        ("abort", "run", "failed with status 3"),
        ("not a number", "run", "must be finite numbers"),
        ("noise", "rollback", "the state is not restored"),
    ],
)
def test_a_broken_fmu_is_refused_with_its_reason(
    write_fmu: WriteFmu, monkeypatch: pytest.MonkeyPatch, fault: str, subject: str, reason: str
) -> None:
    monkeypatch.setattr(fmu_process, "STEP_LIMIT", 1.0)
    state, text = findings(write_fmu(fault=fault))[subject]
    assert state == "wrong"
    assert reason in text


def test_a_wrong_mass_is_found_by_the_response(write_fmu: WriteFmu) -> None:
    file = write_fmu()
    heavier = file.chain.model_copy(update={"masses_kg": (15.0, 9.0)})
    state, text = findings(file.model_copy(update={"chain": heavier}))["response"]
    assert state == "wrong"
    assert "Correct mass, springs and dampers" in text


def test_a_wrong_static_force_is_found(write_fmu: WriteFmu) -> None:
    """The FMU has its own 120 N, the check asks for 130 N."""
    file = write_fmu()
    own = file.model_copy(update={"fmu": file.fmu.model_copy(update={"uplift_force_N": None})})
    found = {finding.subject: finding for finding in check_fmu(own, 130.0, STEP).findings}
    assert found["static force"].state == "wrong"


def test_the_command_needs_an_fmu(write_fmu: WriteFmu, tmp_path: object) -> None:
    write_fmu()
    answer = pantocheck("pantograph", "check", tmp_path / "fmu" / "model.fmu", "--step", STEP)
    assert answer.exit_code == 0, answer.output
    assert "Nothing is wrong." in answer.output
    answer = pantocheck("pantograph", "check", tmp_path / "other.fmu")
    assert answer.exit_code == 2
    assert "other.toml or fmu.toml" in answer.output
