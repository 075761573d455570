"""Velocity after a release: windows of a velocity that changes in steps, and windows outside the record."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.runs.system import Delivered
from pantocheck.conformance.studies.vovan2015 import release_velocity
from pantocheck.conformance.studies.vovan2015.release_velocity import VelocityWindow, compare_velocities

TIME = np.arange(-200, 1001) / 100
"""From 2 s before the release to 10 s after it [s]."""
STEPS = np.select([(TIME >= 0) & (TIME < 1), (TIME >= 3) & (TIME < 5)], [0.002, -0.005], 0.1)
"""Velocity of 2 mm/s from 0 s to 1 s, -5 mm/s from 3 s to 5 s, 100 mm/s at other times [m/s]."""
FACTORS = {"stand-in": 4.0, "initial": 1.0, "updated": 2.0, "updated-modal": 3.0}
"""Multiples of the steps by name of the model, the record first."""


class StepMotion:
    """Motion of three sensors, of which the second has the velocity in steps; filters leave it as it is."""

    time, rate, record = TIME, 100.0, np.zeros((TIME.size, 3))
    models = dict.fromkeys(list(FACTORS)[1:])

    def filter_record(self, motion: str, band: object) -> RealArray:
        return self.filter_model("stand-in", motion, band)

    def filter_model(self, name: str, motion: str, band: object) -> RealArray:
        columns = np.full((TIME.size, 3), 7.0)
        columns[:, 1] = FACTORS[name] * STEPS
        return columns

    def noise(self, motion: str, band: object) -> None:
        return None


@pytest.fixture
def case(monkeypatch: pytest.MonkeyPatch) -> Case:
    """Record of 11 s with three sensors; windows around the steps."""
    (case,) = select_cases(["vovan2015/release-velocity"])
    (sensor,) = case.file.mass_drop.sensor
    mass_drop = case.file.mass_drop.model_copy(update={"record_s": 11.0, "sensor": (sensor,) * 3})
    study = case.file.study.model_copy(update={"windows_s": ((0.0, 1.0), (3.0, 5.0)), "sensor": 2})
    monkeypatch.setattr(release_velocity, "simulate_models", lambda *_: StepMotion())
    monkeypatch.setattr(release_velocity, "locate_drop", lambda *_: None)
    monkeypatch.setattr(release_velocity, "simulate_drop", lambda *_, line: SimpleNamespace(record=None))
    monkeypatch.setattr(release_velocity, "build_lines", lambda _: dict.fromkeys(FACTORS))
    return replace(case, file=case.file.model_copy(update={"mass_drop": mass_drop, "study": study}))


def run(case: Case, **changes: object) -> Delivered:
    return release_velocity.run_release_velocity(case, case.file.study.model_copy(update=changes))


def test_every_window_has_its_velocity_and_its_rms(case: Case) -> None:
    study = run(case).study
    assert [chart.series[1].label for chart in study.charts] == ["initial"] * 2
    for chart, (start, end), velocity in zip(study.charts, ((0.0, 1.0), (3.0, 5.0)), (2.0, -5.0), strict=True):
        for series, factor in zip(chart.series, FACTORS.values(), strict=True):
            assert (series.x[0], series.x[-1], len(series.x)) == (start, end - 0.01, 100 * (end - start))
            assert set(series.y) == {factor * velocity}
        assert f"{start:g} s to {end:g} s" in chart.caption
    study = run(case).study
    assert study.tables[0].columns[:3] == ["Damping", "0 s to 1 s", "0 s to 1 s, 5 to 20 Hz"]
    shown = [[row[0], row[1], row[3]] for row in study.tables[0].rows]
    assert shown == [[name, f"{2 * factor:g} mm/s", f"{5 * factor:g} mm/s"] for name, factor in FACTORS.items()]
    agreement = study.tables[1]
    assert agreement.columns == ["Window and band", "initial", "updated", "updated-modal"]
    assert agreement.rows[0] == ["0 s to 1 s, 0.3-5 Hz", "0.250, 1.000", "0.500, 1.000", "0.750, 1.000"]


def cut(first: RealArray, last: RealArray) -> list[VelocityWindow]:
    """A window with a velocity, and half of it in the medium frequencies, and a later one."""
    return [VelocityWindow(np.arange(2.0), velocity, velocity / 2) for velocity in (first, last)]


def test_velocities_are_compared_in_the_first_and_the_last_window() -> None:
    """By hand: 0.3 over 3 is 10 %, and 9 over 9 is 100 %; 4 over 2 at the end; 3 over 2 at medium frequency."""
    record = cut(np.array([9.0, 9.0]), np.array([2.0, 2.0]))
    reference = cut(np.array([2.0, -2.0]), np.array([4.0, 4.0]))
    rayleigh = cut(np.array([3.0, -3.0]), np.array([9.0, -9.0]))
    modal = cut(np.array([3.3, -3.3]), np.array([18.0, -18.0]))
    findings = compare_velocities(record, reference, rayleigh, modal)
    assert findings.pop("modal_velocity_difference_pct") == pytest.approx((10.0, 100.0))
    assert findings == pytest.approx(
        {
            "reference_residual_velocity_ratio": 2.0,
            "medium_frequency_velocity_ratio": 1.5,
        }
    )


def test_short_drop_beside_itself_with_less_damping() -> None:
    """Three spans, 7 s: without its damping, the model rings longer; the record is that of the mass."""
    (case,) = select_cases(["vovan2015/release-velocity"])
    sensor = case.file.mass_drop.sensor[0].model_copy(update={"x_m": 85.5})
    drop = case.file.mass_drop.drop[0].model_copy(update={"x_m": 85.5})
    mass_drop = case.file.mass_drop.model_copy(update={"record_s": 8.5, "sensor": (sensor,), "drop": (drop,)})
    study = case.file.study.model_copy(update={"windows_s": ((0.0, 2.0), (5.0, 7.0))})
    steps = case.file.discretisation.model_copy(update={"element_m": 2.25})
    file = case.file.model_copy(update={"mass_drop": mass_drop, "study": study, "discretisation": steps})
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(3)})
    table = {"trust": "provisional", "source": "test", "contact_wire": {}, "messenger_wire": {}}
    undamped = Damping.model_validate(table)
    short = replace(case, file=file, line=line, dampings=case.dampings | {"initial": undamped})
    findings = release_velocity.run_release_velocity(short, study).study.findings[LINE]
    assert findings["reference_residual_velocity_ratio"] > 1.005


def test_window_sensor_and_model_of_the_study_must_exist(case: Case) -> None:
    """The filters fade the last second."""
    assert len(run(case, windows_s=((9.0, 10.0),)).study.charts) == 1
    with pytest.raises(InputError, match=r"key study\.windows_s: a window ends at 10\.5 s, the record at 11 s"):
        run(case, windows_s=((9.0, 10.5),))
    assert len(run(case, sensor=3).study.charts) == 2
    with pytest.raises(InputError, match=r"key study\.sensor: there is no sensor 4"):
        run(case, sensor=4)
    with pytest.raises(InputError, match=r"key study\.test: no model 'other'"):
        run(case, test="other")
