"""Estimate of the uplift forces: close to those that give the required mean contact forces, whatever the speed."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.short_cases import shorten_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import run_passage, start_forces
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces, moving_factor
from pantocheck.model import DiscretisedLine, discretise

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
    untuned = mean_forces(case, line, start_forces(case)) - target
    assert np.abs(error).max() < 2.0
    assert np.abs(error).max() < np.abs(untuned).min()


def test_stated_uplift_force_is_the_start() -> None:
    case = short_case("ac-simple/320", 320.0, stated=171.0)
    assert estimate_uplift_forces(case, discretised(case)) == (171.0, 171.0)


def test_uplift_grows_with_the_speed_up_to_the_wave_speed() -> None:
    """A contact wire of 22 kN and 1.35 kg/m has a wave speed of 127.7 m/s; at 0.6 of it the factor is 1 / 0.8."""
    line = discretised(short_case("ac-simple/320", 320.0))
    assert moving_factor(0.6 * np.sqrt(22e3 / 1.35), line) == pytest.approx(1.25, abs=1e-12)
    assert moving_factor(0.0, line) == 1.0
    assert np.isfinite(moving_factor(200.0, line))
