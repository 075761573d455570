"""Velocity after a release: windows of a velocity that changes in steps, and windows outside the record."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.simulation.drop_simulation import ORDER
from pantocheck.conformance.studies.vovan2015 import release_velocity
from pantocheck.conformance.studies.vovan2015.release_velocity import VelocityWindow, compare_velocities

TIME = np.arange(-200, 1001) / 100
"""From 2 s before the release to 10 s after it [s]."""
STEPS = np.select([(TIME >= 0) & (TIME <= 1), (TIME >= 3) & (TIME <= 5)], [0.002, -0.005], 0.1)
"""Velocity of 2 mm/s from 0 s to 1 s, -5 mm/s from 3 s to 5 s, 100 mm/s at other times [m/s]."""


MODELS = {"initial": 1.0, "updated": 2.0, "updated-modal": 3.0}


@pytest.fixture
def case(monkeypatch: pytest.MonkeyPatch) -> Case:
    """Record of 10 s with three sensors, of which the second has the velocity in steps; windows around the steps.

    The models have 1, 2 and 3 times the steps.
    """
    (case,) = select_cases(["vovan2015/release-velocity"])
    (sensor,) = case.file.mass_drop.sensor
    mass_drop = case.file.mass_drop.model_copy(update={"record_s": 10.0, "sensor": (sensor,) * 3})
    study = case.file.study.model_copy(update={"windows_s": ((0.0, 1.0), (3.0, 5.0)), "sensor": 2})

    def simulate_drop(case: Case, number: int, line: float) -> SimpleNamespace:
        motion = np.full((3, TIME.size, 3), 7.0)
        motion[1, :, ORDER["velocity"]] = line * STEPS
        assert number == 1
        return SimpleNamespace(decay=SimpleNamespace(time=TIME, motion=motion))

    monkeypatch.setattr(release_velocity, "simulate_drop", simulate_drop)
    monkeypatch.setattr(release_velocity, "build_lines", lambda _: MODELS)
    return replace(case, file=case.file.model_copy(update={"mass_drop": mass_drop, "study": study}))


def run(case: Case, **changes: object) -> Delivered:
    return release_velocity.run_release_velocity(case, case.file.study.model_copy(update=changes))


def test_every_window_has_the_velocity_of_its_time(case: Case) -> None:
    study = run(case).study
    assert study is not None
    assert [chart.series[1].label for chart in study.charts] == ["updated"] * 2
    for chart, (start, end), velocity in zip(study.charts, ((0.0, 1.0), (3.0, 5.0)), (2.0, -5.0), strict=True):
        for series, factor in zip(chart.series, MODELS.values(), strict=True):
            assert (series.x[0], series.x[-1], len(series.x)) == (start, end, 100 * (end - start) + 1)
            assert set(series.y) == {factor * velocity}
        assert f"{start:g} s to {end:g} s" in chart.caption


def test_table_has_the_rms_of_every_window(case: Case) -> None:
    study = run(case).study
    assert study is not None
    assert study.tables[0].columns[:2] == ["Damping", "0 s to 1 s"]
    shown = [[row[0], row[1], row[3]] for row in study.tables[0].rows]
    assert shown == [[name, f"{2 * factor:g} mm/s", f"{5 * factor:g} mm/s"] for name, factor in MODELS.items()]


def cut(first: RealArray, last: RealArray) -> list[VelocityWindow]:
    """A window with a velocity, and half of it in the medium frequencies, and a later one."""
    return [VelocityWindow(np.arange(2.0), velocity, velocity / 2) for velocity in (first, last)]


def test_velocities_are_compared_in_the_first_and_the_last_window() -> None:
    """By hand: 0.3 over 3 is 10 %; 4 over 2 at the end; 3 over 2 at medium frequency at the start."""
    reference = cut(np.array([2.0, -2.0]), np.array([4.0, 4.0]))
    rayleigh = cut(np.array([3.0, -3.0]), np.array([2.0, -2.0]))
    modal = cut(np.array([3.3, -3.3]), np.array([9.0, 9.0]))
    assert compare_velocities(reference, rayleigh, modal) == pytest.approx(
        {
            "modal_velocity_difference_pct": 10.0,
            "reference_residual_velocity_ratio": 2.0,
            "medium_frequency_velocity_ratio": 1.5,
        }
    )


def test_medium_frequencies_are_those_from_5_to_20_hertz(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unit amplitudes at 0.9, 10 and 50 Hz: only that at 10 Hz is left, to 1 % of the flank of the filters."""
    instant = np.arange(0, 12, 2e-3)
    waves = sum(np.sin(2 * np.pi * f * instant) for f in (0.9, 10.0, 50.0))
    motion = np.zeros((2, instant.size, 3))
    motion[1, :, ORDER["velocity"]] = waves
    drop = SimpleNamespace(decay=SimpleNamespace(time=instant, motion=motion))
    window = case.file.study.model_copy(update={"windows_s": ((2.0, 10.0),)})
    (found,) = release_velocity._cut_windows(drop, window)
    assert np.sqrt(np.mean(found.medium**2)) == pytest.approx(np.sqrt(0.5), rel=0.01)


def test_window_can_end_with_the_record_but_not_after_it(case: Case) -> None:
    assert len(run(case, windows_s=((9.0, 10.0),)).study.charts) == 1
    with pytest.raises(InputError, match=r"key study\.windows_s: a window ends at 10\.5 s, the record at 10 s"):
        run(case, windows_s=((9.0, 10.5),))


def test_sensor_must_exist(case: Case) -> None:
    assert len(run(case, sensor=3).study.charts) == 2
    with pytest.raises(InputError, match=r"key study\.sensor: there is no sensor 4"):
        run(case, sensor=4)
