"""Further runs of the reference simulator, from which the uncertainty follows: two meshes and other starts."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.cases.start_and_section import list_other_starts
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs import case_run, reference_simulator
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import discretise
from pantocheck.model.description.failures import SimulationError


@pytest.fixture(scope="module")
def case() -> Case:
    """Two pantographs 60 m apart on six spans of the 2002 model, analysis section in spans 4 and 5: a run-in of 1 span.

    The elements of 1 m make the four meshes of this test cheap.
    """
    loaded = load_case(library_folder() / "en50318-2002" / "250.toml")
    geometry = loaded.line.geometry.model_copy(update={"spans": 6})
    file = loaded.file.model_copy(
        update={
            "evaluated_spans": (4, 5),
            "spacing_m": (60.0,),
            "run_out_m": 0.0,
            "pantograph": loaded.file.pantograph * 2,
            "discretisation": loaded.file.discretisation.model_copy(update={"element_m": 1.0}),
        }
    )
    line = loaded.line.model_copy(update={"geometry": geometry})
    return replace(loaded, file=file, line=line, pantographs=loaded.pantographs * 2)


@pytest.fixture(scope="module")
def delivered(case: Case) -> Delivered:
    return ReferenceSimulator().run(case)


def test_runs_have_other_meshes_and_starts(case: Case, delivered: Delivered) -> None:
    assert delivered.refined is not None
    assert delivered.coarse is not None
    steps = [(run.run.element_m, run.run.dt_s) for run in (delivered.coarse, delivered, delivered.refined)]
    assert steps == [(2.0, 0.002), (1.0, 0.001), (0.5, 0.0005)]
    starts = [run.record for run in delivered.starts]
    assert len(starts) == len(list_other_starts(case)) == 6
    step = case.speed * 0.001
    places = [record.position[1, 0] - step for record in starts if record is not None]
    assert places == pytest.approx([20.0, 40.0, 80.0, 100.0, 60.0, 60.0])
    first = [np.abs(record.force[:, 0]).max() for record in starts if record is not None]
    assert min(first[:4]) > 100  # the static force acts at once
    assert max(first[4:]) < 1  # a ramp begins without contact force


def test_both_pantographs_have_an_uncertainty_from_mesh_start_and_section(case: Case, delivered: Delivered) -> None:
    """Every force quantity of both; the two pantographs differ, because the second runs in the wake of the first."""
    found = CaseEvaluation(case, delivered).uncertainty
    for pantograph in (1, 2):
        for quantity in ("mean_force_N", "std_force_N", "rms_20_50_N", "max_force_N", "min_force_N"):
            parts = found.list_components(pantograph, quantity)
            assert parts.keys() == {"discretisation", "start", "section"}
            assert parts["start"] > 0  # type: ignore[operator]
    assert found.combined[1]["std_force_N"] != found.combined[2]["std_force_N"]


def test_coarse_run_that_does_not_converge_leaves_two_meshes(
    case: Case, delivered: Delivered, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run of the case counts all the same; the half-width has the large safety factor."""

    def deliver(
        case: Case, discretisation: Discretisation, uplift_forces: object = None, *_: object, **__: object
    ) -> object:
        if discretisation.element_m > 1.0:
            raise SimulationError("the forces of a time step did not converge")
        return (delivered, (120.0, 120.0)) if uplift_forces is None else (delivered.refined, (120.0, 120.0))

    monkeypatch.setattr(reference_simulator, "_deliver", deliver)
    monkeypatch.setattr(reference_simulator, "_run_other_starts", lambda *_: ())
    without = ReferenceSimulator().run(case)
    assert without.coarse is None
    found = CaseEvaluation(case, replace(without, starts=())).uncertainty
    assert "doubled" not in found.components["discretisation"].basis
    values = [CaseEvaluation(case, replace(run, refined=None)).values.evaluation.values[2]["std_force_N"]
              for run in (delivered, delivered.refined) if run is not None]  # fmt: skip
    expected = 3 * abs(values[0] - values[1])  # type: ignore[operator]
    assert found.list_components(2, "std_force_N")["discretisation"] == pytest.approx(expected, rel=1e-12)


def test_runs_are_reproducible(case: Case, delivered: Delivered) -> None:
    """The same start twice gives the same samples, whether the line served other runs before or is new."""
    start = list_other_starts(case)[-1]
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    (again,) = case_run.run_starts([start], case, line, discretisation, (120.0, 120.0))
    before = delivered.starts[-1].record
    assert before is not None
    np.testing.assert_array_equal(again.force, before.force)
