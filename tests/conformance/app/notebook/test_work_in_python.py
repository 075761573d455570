"""Public interface for comparison, verification, validation and the fit of a pantograph."""

from pathlib import Path

import numpy as np
import pytest

from helpers import response_records as rig
from helpers.example_dossier import CachedSimulator, copy_example
from helpers.wave_system import SIGMA, Wave
from pantocheck.conformance import (
    InputError,
    OpenedCase,
    SimulatedRun,
    compare_runs,
    fit_pantograph,
    validate_dossier,
    verify_report,
)
from pantocheck.conformance.app.notebook import graded_results, opened_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.comparison.compared_run import describe_delivery
from pantocheck.conformance.execution.runner import run_cases


@pytest.fixture
def run(two_pantograph_case: Case) -> SimulatedRun:
    """Run of two pantographs with known quantities."""
    system = Wave()
    delivered = system.run(two_pantograph_case)
    assert delivered.record is not None
    described = describe_delivery(two_pantograph_case, system, delivered)
    return SimulatedRun(described, two_pantograph_case, system, delivered.record)


def test_a_run_agrees_with_its_record(run: SimulatedRun, tmp_path: Path) -> None:
    """The record holds nine digits."""
    compared = compare_runs(run, run.write(tmp_path / "run.csv"))
    agreement = compared.agreement(pantograph=2)
    assert compared.agreement() == compared.agreement(pantograph=1, subject=2) != agreement
    assert agreement.correlation == pytest.approx(1, abs=1e-9)
    assert agreement.rms_difference_N < 1e-6 * SIGMA
    assert repr(compared) == f"<ComparedRuns {', '.join(compared.subjects)}>"
    table = compared.to_dataframe()
    rows = zip(*(table[name] for name in ("pantograph", "quantity", "subject", "value")), strict=True)
    values = {row[:3]: row[3] for row in rows}
    std = [values[2, "std_force_N", name] for name in compared.subjects]
    np.testing.assert_allclose(std, SIGMA, rtol=1e-3)
    assert len(compared.plot(2).lines) == 2
    names = [path.name for path in compared.write(tmp_path / "out")]
    assert names == [f"comparison.{suffix}" for suffix in ("json", "html", "pdf", "csv")]
    with pytest.raises(KeyError):
        compared.agreement(pantograph=0)


def test_a_case_is_graded_as_it_was_changed(two_pantograph_case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opened_case, "choose_system", lambda text: Wave())
    graded = OpenedCase(Path("case.toml"), two_pantograph_case).grade()
    assert [case.id for case in graded.results.cases] == [two_pantograph_case.id]
    assert graded.results.system.name == Wave().name


def test_a_changed_number_is_found(two_pantograph_case: Case, tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_bytes(run_cases([two_pantograph_case], Wave()).to_json())
    genuine = verify_report(path)
    assert not genuine.authentic  # consistent at best: nobody has signed it
    assert genuine.contradictions == ()
    value = next(row.value for row in genuine.verification.results.cases[0].criteria if row.quantity == "std_force_N")
    path.write_text(path.read_text("utf-8").replace(repr(value), repr(value + 1)), "utf-8")
    forged = verify_report(path)
    assert (forged.state, forged.verdict) == ("contradicted", genuine.verdict)
    assert any("std_force_N" in line for line in forged.contradictions)
    assert "contradicted" in list(forged.to_dataframe()["outcome"])
    assert repr(forged).startswith("<VerifiedReport contradicted, verdict ")


def test_fit_finds_the_pantograph_of_a_response(tmp_path: Path) -> None:
    """Noise of 0.1 %; 95 % intervals, so that a value may lie at twice its half-width by chance only."""
    pantograph = rig.read_pantograph("en50318-2002/pantograph.toml")
    response = rig.add_noise(rig.chain_stiffness(pantograph), seed=1, modulus=1e-3, phase_deg=0.05)
    table = rig.write_response(tmp_path, rig.polar_columns(response, "N_m"), kind="dynamic_stiffness")
    fit = fit_pantograph(table, masses=len(pantograph.chain.masses_kg))
    for number, mass in enumerate(pantograph.chain.masses_kg, 1):
        fitted = fit.parameter("masses_kg", number)
        assert abs(fitted.value - mass) < 2 * fitted.half_width
    np.testing.assert_allclose(fit.dynamic_stiffness(rig.FREQUENCY), rig.chain_stiffness(pantograph), rtol=3e-3)
    assert len(fit.to_dataframe()["value"]) == 3 * fit.report.masses
    assert repr(fit) == f"<FittedPantograph {fit.report.masses} masses>"
    assert len(fit.plot().lines) == 2
    assert [path.name for path in fit.write(tmp_path / "mine.toml")] == [
        *("mine.toml", "mine-fit.json", "mine-fit.html", "mine-fit.pdf")
    ]
    with pytest.raises(InputError, match=r"ends in \.toml"):
        fit.write(tmp_path / "mine.json")
    with pytest.raises(InputError, match="5 is not possible"):
        fit_pantograph(table, masses=5)


@pytest.mark.thorough
def test_a_dossier_is_validated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The example dossier passes all steps; the reference models are one case, to be short."""
    monkeypatch.setattr(graded_results, "choose_system", lambda text, timeout: CachedSimulator())
    graded = validate_dossier(copy_example(tmp_path / "dossier"), tmp_path / "out")
    assert graded.verdict == "pass"
    assert set(graded.steps()["verdict"]) == {"pass"}
