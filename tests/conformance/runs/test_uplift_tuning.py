"""Tuning of the uplift forces: few runs, the run of the tuned forces is kept, and a failure has a name."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from helpers.case_fixtures import EditedCase
from helpers.wave_system import Wave
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs import case_run
from pantocheck.conformance.runs.case_run import PassageRun
from pantocheck.conformance.runs.uplift_tuning import MAX_RUNS, TuningFailed, tune_uplift


@dataclass(frozen=True)
class MeanForces:
    """Result of a made-up run."""

    uplift: tuple[float, ...]
    means: RealArray


class CoupledPantographs:
    """Mean contact forces that depend on the pantograph's own uplift force and a little on the other's; counts runs."""

    def __init__(self, gain: float, cross: float = 0.0) -> None:
        self.matrix, self.runs = np.array([[gain, cross], [cross, gain]]), 0

    def __call__(self, forces: tuple[float, ...]) -> MeanForces:
        self.runs += 1
        return MeanForces(forces, self.matrix @ np.array(forces) + 3.0)


def means(run: MeanForces) -> RealArray:
    return run.means


@pytest.mark.parametrize(
    ("gain", "cross", "most_runs"), [(0.955, 0.0, 2), (0.93, 0.0, 3), (1.6, 0.0, 3), (0.98, 0.05, 5), (0.8, -0.1, 7)]
)
def test_targets_are_met_in_few_runs(gain: float, cross: float, most_runs: int) -> None:
    run = CoupledPantographs(gain, cross)
    tuned = tune_uplift(run, means, (150.0, 150.0), (144.0, 169.0))
    assert np.abs(tuned.means - [144.0, 169.0]).max() <= 0.02  # [N], a thousandth of the spread of published means
    assert run.runs <= most_runs


def test_force_without_a_target_is_kept_after_one_run() -> None:
    run = CoupledPantographs(1.0)
    assert tune_uplift(run, means, (120.0, 130.0), (None, None)).uplift == (120.0, 130.0)
    assert run.runs == 1


def test_last_allowed_run_can_meet_the_target() -> None:
    runs: list[tuple[float, ...]] = []

    def run(forces: tuple[float, ...]) -> MeanForces:
        runs.append(forces)
        return MeanForces(forces, np.array([144.0 if len(runs) == MAX_RUNS else 50.0]))

    assert tune_uplift(run, means, (120.0,), (144.0,)).means[0] == 144.0
    assert len(runs) == MAX_RUNS


def test_mean_that_does_not_follow_its_uplift_force_is_a_failure() -> None:
    with pytest.raises(TuningFailed, match=r"^pantograph 1: .* is 50\.00 N, its target_mean_force_N is 144\.00 N$"):
        tune_uplift(lambda forces: MeanForces(forces, np.full(1, 50.0)), means, (120.0,), (144.0,))


def test_failure_names_the_pantograph_that_is_farthest_from_its_target() -> None:
    """The second one is 6 N above its target, the first one 1 N below, the third one has none."""
    values = np.array([143.0, 175.0, 300.0])
    with pytest.raises(TuningFailed, match=r"^pantograph 2: after 12 runs the mean contact force is 175\.00 N"):
        tune_uplift(lambda forces: MeanForces(forces, values), means, (120.0,) * 3, (144.0, 169.0, None))


@pytest.fixture
def untunable(edited_case: EditedCase, wave: type[Wave], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case with a target that no run meets: every run has a mean contact force of 119 N."""
    changes = {"pantograph.0.uplift_force_N": None, "pantograph.0.target_mean_force_N": 150.0}

    def run_once(case: Case, line: object, steps: object, uplift_forces: tuple[float, ...], _: object) -> PassageRun:
        return PassageRun(wave().record(case), RunTable(), uplift_forces)

    monkeypatch.setattr(case_run, "_run_once", run_once)
    return edited_case("250.toml", changes)


def test_simulate_reports_failed_tuning_with_exit_code_2(untunable: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["simulate", str(untunable), "--out", str(tmp_path / "record.csv")])
    assert done.exit_code == 2
    assert "mean contact force is 119.00 N, its target_mean_force_N is 150.00 N" in done.output
    assert "Traceback" not in done.output


def test_run_reports_failed_tuning_as_the_error_of_the_case(untunable: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["run", str(untunable), "--formats", "json", "--out", str(tmp_path / "report")])
    assert done.exit_code == 2
    assert "TuningFailed: pantograph 1: after 12 runs" in " ".join(done.output.split())
