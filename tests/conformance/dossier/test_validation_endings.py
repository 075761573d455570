"""Interrupted validation, steps for information, and systems whose runs are records without a case."""

import shutil
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from helpers.example_dossier import EXAMPLE, CachedSimulator, copy_example, edit_column, list_verdicts, validate_example
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.dossier.dossier_reading import read_dossier
from pantocheck.conformance.dossier.validation import Validation
from pantocheck.conformance.execution.runner import RunInterrupted
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.system import Delivered


@dataclass(frozen=True)
class InterruptedSimulator(CachedSimulator):
    """System that the user interrupts in its second run of the line under validation."""

    started: list[str] = field(default_factory=list)

    def run(self, case: Case) -> Delivered:
        """Run a case, or end as after Ctrl-C."""
        self.started.append(case.id)
        if len(self.started) == 3:
            raise KeyboardInterrupt
        return super().run(case)


def test_interrupted_validation_keeps_the_finished_part(system: CachedSimulator, tmp_path: Path) -> None:
    """One reference model and one pair are kept; what follows was not done, and the verdict is not better than skip."""
    dossier = read_dossier(copy_example(tmp_path / "in"))
    with pytest.raises(RunInterrupted) as interruption:
        Validation(dossier, InterruptedSimulator(runs=system.runs), tmp_path / "out").run()
    results = interruption.value.results
    assert interruption.value.exit_code == 130
    assert [case.id for case in results.cases] == ["en50318-2002/250", "pair/160-up"]
    assert list_verdicts(results) == {
        "pantograph_model": "pass", "static_check": "pass", "simulation_parameters": "skip",
        "reference_models": "pass", "line_test": "skip", "limits_of_validity": "skip",
    }  # fmt: skip
    assert results.verdict == "skip"
    assert find_discrepancies(results) == []


def test_steps_that_are_not_required_decide_nothing(system: CachedSimulator, tmp_path: Path) -> None:
    """A failing step for information is shown as such; its cases are listed for information."""
    changes = {"required": ["reference_models"], "line_test.tolerance.1.tolerance_pct": 1.0, "validity": None}
    results = validate_example(copy_example(tmp_path / "in", changes), system, tmp_path / "out")
    assert (list_verdicts(results)["line_test"], results.verdict) == ("fail", "pass")
    assert results.information == ["pair/160-up", "pair/200-up", "pair/200-up-two"]
    assert find_discrepancies(results) == []


@dataclass(frozen=True)
class ForeignSystem:
    """System that delivers nothing by itself: its runs are records."""

    name: str = "Other simulator"
    version: str = "1"
    kind: Literal["builtin", "record", "command"] = "record"

    def run(self, case: Case) -> Delivered:
        """Deliver nothing."""
        raise AssertionError(case)


def validate_record(folder: Path, system: CachedSimulator, accepted: bool) -> Results:
    """Line test of a record of another simulator, which names neither case nor digest."""
    run = {
        "record": "simulated/run-160.toml", "line": "example line", "pantographs": ["example pantograph"],
        "direction": "up",
    }  # fmt: skip
    changes: dict[str, Any] = {"pair.2": None, "pair.1": None, "pair.0.simulated": run, "reference": None}
    changes |= {"required": ["line_test"], "validity.spacing_m": None}
    changes |= {"validity.speed_km_h": [160.0, 160.0]}
    changes |= {"accept_unconfirmed": [ForeignSystem.name]} if accepted else {}
    path = copy_example(folder / "in", changes)
    (case,) = select_cases([str(EXAMPLE / "run-160.toml")])
    delivered = system.run(case)
    (folder / "in" / "simulated").mkdir()
    table = folder / "in" / "simulated" / "run-160.h5"
    sidecar = write_record(table, delivered.record, system={"name": ForeignSystem.name, "version": "1"})
    shutil.copy(table, folder / "in" / "measured" / "copy.h5")
    edit_toml(sidecar, {"file": "copy.h5"})
    shutil.copy(sidecar, folder / "in" / "measured" / "copy.toml")
    edit_toml(sidecar, {"file": "run-160.h5"})
    return Validation(read_dossier(path), ForeignSystem(), folder / "out").run()


@pytest.mark.parametrize("accepted", [False, True])
def test_record_without_a_case_is_unconfirmed(system: CachedSimulator, tmp_path: Path, accepted: bool) -> None:
    """Only the user can accept a record that no check confirms; the runs of the claims are those that then pass."""
    # The claims do not pass without reference models, although the dossier does not require them.
    results = validate_record(tmp_path, system, accepted)
    assert list_verdicts(results)["line_test"] == results.verdict == ("pass" if accepted else "unconfirmed")
    assert {claim.verdict for claim in results.procedure.claims} == {"skip"}
    assert {tuple(claim.evidence) for claim in results.procedure.claims} == {("pair/160-up",) if accepted else ()}
    assert results.cases[0].verdict == "unconfirmed"
    assert find_discrepancies(results) == []


def test_same_samples_in_another_file_are_refused(system: CachedSimulator, tmp_path: Path) -> None:
    """The record that is called simulated is a copy of the measured one, under another name of the system."""
    dossier = tmp_path / "in" / "dossier.toml"
    validate_record(tmp_path, system, accepted=True)
    edit_toml(dossier, {"pair.0.measured.record": "measured/copy.toml"})
    edit_toml(tmp_path / "in" / "measured" / "copy.toml", {"system.name": "Measuring train"})
    results = Validation(read_dossier(dossier), ForeignSystem(), tmp_path / "out").run()
    assert results.cases[0].verdict == results.verdict == "error"
    assert "copy" in results.cases[0].reason


def test_measurement_that_is_the_simulation_with_noise_is_refused(system: CachedSimulator, tmp_path: Path) -> None:
    """Noise of 0.5 N changes every statistic, and leaves the correlation from 20 to 50 Hz above 0.999."""
    dossier = tmp_path / "in" / "dossier.toml"
    validate_record(tmp_path, system, accepted=True)
    (case,) = select_cases([str(EXAMPLE / "run-160.toml")])
    record = system.run(case).record
    assert record is not None
    force = record.force + 0.5 * np.random.default_rng(1).standard_normal(record.force.shape)
    noisy = tmp_path / "in" / "measured" / "noisy.h5"
    write_record(noisy, replace(record, force=force), system={"name": "Measuring train", "version": "1"})
    edit_toml(dossier, {"pair.0.measured.record": "measured/noisy.toml"})
    results = Validation(read_dossier(dossier), ForeignSystem(), tmp_path / "out").run()
    assert results.verdict == "error"
    assert "with small changes" in results.cases[0].reason


def test_measured_run_of_another_pair_is_refused(system: CachedSimulator, tmp_path: Path) -> None:
    """The same run with noise of 0.5 N, beside a simulated run at another speed."""
    case = {"case": "faster.toml", "direction": "up"}
    changes: dict[str, Any] = {"pair.2": None, "pair.1.simulated": case, "reference": None, "validity": None}
    path = copy_example(tmp_path / "in", {**changes, "required": ["line_test"]})
    shutil.copy(tmp_path / "in" / "run-160.toml", tmp_path / "in" / "faster.toml")
    edit_toml(tmp_path / "in" / "faster.toml", {"id": "example/faster", "speed_km_h": 160.4})
    measured = tmp_path / "in" / "measured"
    for name in ("run-160.csv", "run-160.toml"):
        shutil.copy(measured / name, measured / name.replace("run-160", "again"))
    noise = np.random.default_rng(1)
    edit_column("again.csv", "force_1_N", lambda force: force + 0.5 * noise.standard_normal())(tmp_path / "in")
    edit_toml(measured / "again.toml", {"file": "again.csv"})
    edit_toml(path, {"pair.1.measured.record": "measured/again.csv"})
    first, second = Validation(read_dossier(path), system, tmp_path / "out").run().cases
    assert first.verdict != "error"
    assert (second.verdict, second.reason) == ("error", "the measured run is that of another pair")
