"""Tuning of the uplift forces: few runs, the run of the tuned forces is kept, and a failure has a name."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from helpers.listed_spans import list_spans
from helpers.short_cases import change_case, shorten_case
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import MatricesTable, ModesTable, PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs import case_run
from pantocheck.conformance.runs.case_run import PassageRun, build_passage, list_start_forces, run_passage
from pantocheck.conformance.runs.static_quantities import sample_span
from pantocheck.conformance.runs.uplift_tuning import (
    MAX_RUNS,
    TuningFailed,
    estimate_uplift_forces,
    moving_factor,
    tune_uplift,
)
from pantocheck.model import DiscretisedLine, History, Passage, discretise, simulate_passage
from pantocheck.model.description.pantograph import equilibrium
from pantocheck.model.statics.elasticity import static_uplift


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


def test_force_without_a_target_needs_one_run_and_the_last_one_can_meet_it() -> None:
    run = CoupledPantographs(1.0)
    assert tune_uplift(run, means, (120.0, 130.0), (None, None)).uplift == (120.0, 130.0)
    assert run.runs == 1
    runs: list[tuple[float, ...]] = []

    def run(forces: tuple[float, ...]) -> MeanForces:
        runs.append(forces)
        return MeanForces(forces, np.array([144.0 if len(runs) == MAX_RUNS else 50.0]))

    assert tune_uplift(run, means, (120.0,), (144.0,)).means[0] == 144.0
    assert len(runs) == MAX_RUNS


def test_failure_names_the_pantograph_that_is_farthest_from_its_target_and_both_forces() -> None:
    """The second one is 6 N above its target, the first one 1 N below, the third one has none."""
    values = np.array([143.0, 175.0, 300.0])
    with pytest.raises(TuningFailed, match=r"^pantograph 2: after 12 runs the mean contact force is 175\.00 N"):
        tune_uplift(lambda forces: MeanForces(forces, values), means, (120.0,) * 3, (144.0, 169.0, None))
    with pytest.raises(TuningFailed, match=r"^pantograph 1: .* is 50\.00 N, its target_mean_force_N is 144\.00 N$"):
        tune_uplift(lambda forces: MeanForces(forces, np.full(1, 50.0)), means, (120.0,), (144.0,))


@pytest.fixture
def untunable(edited_case: EditedCase, wave: type[Wave], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case with a target that no run meets: every run has a mean contact force of 119 N."""
    changes = {"pantograph.0.uplift_force_N": None, "pantograph.0.target_mean_force_N": 150.0}

    def run_once(case: Case, line: object, steps: object, uplift_forces: tuple[float, ...], *_: object) -> PassageRun:
        return PassageRun(wave().record(case), RunTable(), uplift_forces)

    monkeypatch.setattr(case_run, "_run_once", run_once)
    return edited_case("250.toml", changes)


def test_failed_tuning_ends_a_command_with_exit_code_2(untunable: Path, tmp_path: Path) -> None:
    done = pantocheck("simulate", untunable, "--out", tmp_path / "record.csv")
    assert done.exit_code == 2
    assert "mean contact force is 119.00 N, its target_mean_force_N is 150.00 N" in done.output
    assert "Traceback" not in done.output
    done = pantocheck("run", untunable, "--formats", "json", "--out", tmp_path / "report")
    assert done.exit_code == 2
    assert "TuningFailed: pantograph 1: after 12 runs" in " ".join(done.output.split())


# Estimate of the uplift forces: close to those that give the required mean contact forces, whatever the speed.
PER_UNIT_MASS = 0.3
"""Damping of both wires [1/s]: waves decay within a few spans, so that the train of a short line is settled."""


def short_case(name: str, speed_km_h: float, stated: float | None = None) -> Case:
    """Two pantographs on ten spans of a line of the library."""
    *_, case = select_cases([f"en50318-2018/{name}"])
    case = shorten_case(case, speed_km_h, PER_UNIT_MASS, 2)
    pantographs = tuple(p.model_copy(update={"uplift_force_N": stated}) for p in case.file.pantograph)
    return replace(case, file=case.file.model_copy(update={"pantograph": pantographs}))


def discretised(case: Case) -> DiscretisedLine:
    return discretise(build_catenary(case.line), 2.0)


def mean_forces(case: Case, line: DiscretisedLine, uplift: tuple[float, ...]) -> np.ndarray:
    """Mean contact forces over the analysis section with given uplift forces [N]."""
    run = run_passage(case, line, case.file.discretisation, uplift)
    signals = RecordSignals(run.record, case.file.filter)
    return np.array([pantograph.delivered.mean() for pantograph in signals.pantographs.values()])


@pytest.mark.parametrize(("name", "speed"), [("ac-simple/320", 320.0), ("ac-stitched/320", 275.0)])
def test_estimate_gives_nearly_the_required_mean_forces(name: str, speed: float) -> None:
    """Within 2 N for both pantographs, of which the second runs through the waves of the first one."""
    case = short_case(name, speed)
    line, target = discretised(case), case.lift_forces[0].target_mean_force
    error = mean_forces(case, line, estimate_uplift_forces(case, line)) - target
    untuned = mean_forces(case, line, list_start_forces(case)) - target
    assert np.abs(error).max() < 2.0
    assert np.abs(error).max() < np.abs(untuned).min()


def test_estimate_starts_at_a_stated_force_and_grows_with_the_speed() -> None:
    case = short_case("ac-simple/320", 320.0, stated=171.0)
    assert estimate_uplift_forces(case, discretised(case)) == (171.0, 171.0)
    # A contact wire of 22 kN and 1.35 kg/m has a wave speed of 127.7 m/s; at 0.6 of it the factor is 1 / 0.8.
    line = discretised(short_case("ac-simple/320", 320.0))
    assert moving_factor(0.6 * np.sqrt(22e3 / 1.35), line) == pytest.approx(1.25, abs=1e-12)
    assert moving_factor(0.0, line) == 1.0
    assert np.isfinite(moving_factor(200.0, line))


# Working height: one convention for a chain and for the same pantograph given by matrices or modes.
UPLIFT_FORCE = 150.0
PROVENANCE = {"trust": "primary", "source": "rig"}


@pytest.fixture(scope="module")
def chain() -> PantographFile:
    """Pantograph of EN 50318:2018 with dampers proportional to its springs, which modes can represent."""
    file = read_model(library_folder() / "en50318-2018" / "pantograph.toml", PantographFile, "pantograph")
    dampers = tuple(1e-3 * k for k in file.chain.stiffness_N_m)
    return file.model_copy(update={"chain": file.chain.model_copy(update={"damping_N_s_m": dampers})})


@pytest.fixture(scope="module")
def descriptions(chain: PantographFile) -> dict[str, PantographFile]:
    """The chain, the same pantograph by its matrices, and by its modes; the uplift force acts on the lowest mass."""
    model = build_pantograph(chain, 0.0, 0.0)
    w2, shapes = eigh(model.stiffness, model.mass)
    omega = np.sqrt(w2)
    tables = {"mass_kg": model.mass, "damping_N_s_m": model.damping, "stiffness_N_m": model.stiffness}
    rows = {key: tuple(map(tuple, matrix.tolist())) for key, matrix in tables.items()}
    matrices = MatricesTable(**rows, head=(0.0, 0.0, 1.0), uplift_force_on=(1.0, 0.0, 0.0), **PROVENANCE)
    modes = ModesTable(
        frequency_Hz=tuple((omega / (2 * np.pi)).tolist()),
        damping_ratio=tuple((1e-3 * omega / 2).tolist()),
        head_shape=tuple(shapes[2].tolist()),
        uplift_force_on=tuple(shapes[0].tolist()),
        **PROVENANCE,
    )
    return {
        "chain": chain,
        "matrices": chain.model_copy(update={"chain": None, "matrices": matrices}),
        "modes": chain.model_copy(update={"chain": None, "modes": modes}),
    }


def simulate(case: Case, file: PantographFile) -> np.ndarray:
    """Contact force of an untuned passage over two spans of the line of EN 50318:2002."""
    case = change_case(replace(case, pantographs=(file,)), 4, (2.0, 2e-3), evaluated_spans=(2, 3), run_out_m=0.0)
    line = discretise(build_catenary(case.line), 2.0)
    return simulate_passage(line, build_passage(case, line, case.file.discretisation, (UPLIFT_FORCE,))).force[0]


def test_chain_matrices_and_modes_have_one_mean_force(case_250: Case, descriptions: dict[str, PantographFile]) -> None:
    """One linear system: equal to the convergence of the contact forces, 1e-9 N per step, hence 1e-5 N in a run."""
    # Without the point of the uplift force, it acts on the head: 160 N/m times the compression of the head springs, 31
    # mm, that is 5 N less on the base spring; on a flexible line 4.5 N remain.
    forces = {name: simulate(case_250, file) for name, file in descriptions.items()}
    for force in forces.values():
        assert np.abs(force - forces["chain"]).max() < 1e-5
    table = descriptions["matrices"].matrices.model_copy(update={"uplift_force_on": None})
    on_head = simulate(case_250, descriptions["matrices"].model_copy(update={"matrices": table}))
    assert on_head.mean() - forces["chain"].mean() == pytest.approx(4.5, abs=0.5)


@pytest.mark.parametrize("name", ["chain", "matrices", "modes"])
def test_static_contact_force_at_the_working_height(descriptions: dict[str, PantographFile], name: str) -> None:
    """Base spring k1 in series with the others: F = F0 (1/k1) / (1/k1 + 1/k2 + 1/k3) at zero displacement."""
    file = descriptions[name]
    pantograph = build_pantograph(file, UPLIFT_FORCE, 0.06)
    _, contact = equilibrium(pantograph, 0.06)
    expected = UPLIFT_FORCE / 160 / (1 / 160 + 1 / 15500 + 1 / 7000)
    assert contact == pytest.approx(expected, rel=1e-9)


def test_wrong_number_of_values_is_refused(descriptions: dict[str, PantographFile]) -> None:
    table = descriptions["matrices"].matrices.model_dump()
    with pytest.raises(ValueError, match="2 values for 3 degrees of freedom"):
        MatricesTable(**table | {"uplift_force_on": (1.0, 0.0)})


@pytest.mark.parametrize("convention", ["working_height", "wire_height"])
def test_height_of_the_line_does_not_change_the_forces(case_250: Case, chain: PantographFile, convention: str) -> None:
    """A contact wire at 5.3 m above the rail: the nominal height of the wire moves with it, in both conventions."""
    # To 1e-6 N; heights of 5 m leave rounding errors of 1e-15 m times 5e4 N/m, which sweeps amplify.
    table = chain.chain.model_copy(update={"base_spring_unstretched": convention})
    pantograph = chain.model_copy(update={"chain": table})
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    forces = []
    for height in (0.0, 5.3):
        tables["geometry"]["contact_wire_height_m"] = height
        forces.append(simulate(replace(case_250, line=LineFile.model_validate(tables)), pantograph))
    assert np.abs(forces[1] - forces[0]).max() < 1e-6
    assert forces[0].mean() > 100.0


# Passage of a case: working height of the pantographs.


def test_working_height_is_the_mean_static_height_in_the_first_evaluated_span(two_pantograph_case: Case) -> None:
    """The frame spring is unstretched at the working height: its preload is 50 N/m times this height."""
    # The height is the mean static uplift of the contact wire plus the compression of the contact spring, 50 kN/m. The
    # first span ends at an anchor, so that its mean uplift differs by millimetres from that of the second span.
    sections = {"evaluated_spans": (1, 2), "spacing_m": (20.0,), "run_out_m": 0.0}
    case = change_case(two_pantograph_case, 4, **sections)
    line, forces = discretise(build_catenary(case.line), 2.0), (120.0, 150.0)
    passage = build_passage(case, line, case.file.discretisation, forces)
    for pantograph, force in zip(passage.pantographs, forces, strict=True):
        first, second = (static_uplift(line, sample_span(*case.line.geometry.span(n)), force).mean() for n in (1, 2))
        assert abs(first - second) > 1e-3
        assert pantograph.static_force == force
        assert (pantograph.force[0] - force) / 50.0 == pytest.approx(first + force / 50e3)


def test_computing_time_begins_after_a_first_step(two_pantograph_case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """A passage without a step would leave the compilation of the time step to the run that is timed."""
    steps = []

    def simulate(line: DiscretisedLine, passage: Passage, *others: Any) -> History:
        steps.append(round(passage.duration / passage.time_step))
        return simulate_passage(line, passage, *others)

    monkeypatch.setattr(case_run, "integrate_passage", simulate)
    line, discretisation = discretise(build_catenary(two_pantograph_case.line), 5.0), Discretisation(time_step_s=0.004)
    run_passage(two_pantograph_case, line, discretisation)
    duration = (two_pantograph_case.end - two_pantograph_case.start) / two_pantograph_case.speed
    assert steps == [1, round(duration / discretisation.time_step_s)]
