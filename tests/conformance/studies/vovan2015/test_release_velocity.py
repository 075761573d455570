"""Velocity after a release: windows of a velocity that changes in steps, and windows outside the record."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.simulation.drop_simulation import ORDER
from pantocheck.conformance.studies.vovan2015 import release_velocity

TIME = np.arange(-20, 101) / 10
"""From 2 s before the release to 10 s after it [s]."""
STEPS = np.select([(TIME >= 0) & (TIME <= 1), (TIME >= 3) & (TIME <= 5)], [0.002, -0.005], 0.1)
"""Velocity of 2 mm/s from 0 s to 1 s, -5 mm/s from 3 s to 5 s, 100 mm/s at other times [m/s]."""


@pytest.fixture
def case(monkeypatch: pytest.MonkeyPatch) -> Case:
    """Record of 10 s with three sensors, of which the second has the velocity in steps; windows around the steps."""
    (case,) = select_cases(["vovan2015/release-velocity"])
    (sensor,) = case.file.mass_drop.sensor
    mass_drop = case.file.mass_drop.model_copy(update={"record_s": 10.0, "sensor": (sensor,) * 3})
    study = case.file.study.model_copy(update={"windows_s": ((0.0, 1.0), (3.0, 5.0)), "sensor": 2})

    def simulate_drop(case: Case, number: int, line: object) -> SimpleNamespace:
        motion = np.full((3, TIME.size, 3), 7.0)
        motion[1, :, ORDER["velocity"]] = STEPS
        assert number == 1
        return SimpleNamespace(decay=SimpleNamespace(time=TIME, motion=motion))

    monkeypatch.setattr(release_velocity, "simulate_drop", simulate_drop)
    monkeypatch.setattr(release_velocity, "build_lines", lambda _: {"initial": None, "updated": None})
    return replace(case, file=case.file.model_copy(update={"mass_drop": mass_drop, "study": study}))


def run(case: Case, **changes: object) -> Delivered:
    return release_velocity.run_release_velocity(case, case.file.study.model_copy(update=changes))


def test_every_window_has_the_velocity_of_its_time(case: Case) -> None:
    study = run(case).study
    assert study is not None
    assert [chart.series[1].label for chart in study.charts] == ["updated"] * 2
    for chart, (start, end), velocity in zip(study.charts, ((0.0, 1.0), (3.0, 5.0)), (2.0, -5.0), strict=True):
        for series in chart.series:
            assert (series.x[0], series.x[-1], len(series.x)) == (start, end, 10 * (end - start) + 1)
            assert set(series.y) == {velocity}
        assert f"{start:g} s to {end:g} s" in chart.caption


def test_table_has_the_rms_of_every_window(case: Case) -> None:
    study = run(case).study
    assert study is not None
    assert study.tables[0].columns == ["Damping", "0 s to 1 s", "3 s to 5 s"]
    assert study.tables[0].rows == [[name, "2 mm/s", "5 mm/s"] for name in ("initial", "updated")]


def test_window_can_end_with_the_record_but_not_after_it(case: Case) -> None:
    assert len(run(case, windows_s=((9.0, 10.0),)).study.charts) == 1
    with pytest.raises(InputError, match=r"key study\.windows_s: a window ends at 10\.5 s, the record at 10 s"):
        run(case, windows_s=((9.0, 10.5),))


def test_sensor_must_exist(case: Case) -> None:
    assert len(run(case, sensor=3).study.charts) == 2
    with pytest.raises(InputError, match=r"key study\.sensor: there is no sensor 4"):
        run(case, sensor=4)
