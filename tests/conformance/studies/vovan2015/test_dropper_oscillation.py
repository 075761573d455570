"""Oscillation of a dropper after a release: decay of a known signal, and a short drop."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.studies.vovan2015.dropper_coefficient import (
    compare_oscillations,
    find_oscillation,
    run_dropper_oscillation,
)

TIME = np.arange(0, 2, 5e-4)


def decay(rate: float) -> np.ndarray:
    """Oscillation at 100 Hz that decays with a rate [1/s]."""
    return np.exp(-rate * TIME) * np.sin(2 * np.pi * 100 * TIME)


def test_decay_of_known_oscillations() -> None:
    """RMS in 0.8-1.6 s over that in 0-0.1 s, by the integrals of exp(-2 r t); the velocity changes by 1 % and 3 %."""

    def share(rate: float) -> float:
        def energy(start: float, end: float) -> float:
            return (np.exp(-2 * rate * start) - np.exp(-2 * rate * end)) / (2 * rate * (end - start))

        return float(np.sqrt(energy(0.8, 1.6) / energy(0.0, 0.1)))

    velocity = [factor * np.full(TIME.size, 2.0) for factor in (1.0, 1.01, 0.97)]
    found = compare_oscillations([decay(1.0), decay(1.5), decay(3.0)], velocity, TIME)
    assert found["dropper_oscillation_decay_ratio"] == pytest.approx(share(1.5) / share(1.0), rel=0.01)
    assert found["dropper_velocity_change_pct"] == pytest.approx((1.0, 3.0))
    early = np.sqrt(np.mean(decay(1.0)[TIME < 0.1] ** 2)) / 2.0
    assert found["dropper_oscillation_pct"] == pytest.approx(100 * early)
    slower = compare_oscillations([decay(1.0), decay(3.0), decay(2.0)], velocity, TIME)
    assert slower["dropper_oscillation_decay_ratio"] > 1


def test_oscillation_is_the_extension_above_50_hertz_after_the_release() -> None:
    """Both wires move at 1 Hz; the messenger wire alone has 0.5 at 120 Hz. The filter takes 1.2 % of it."""
    time = np.arange(-1, 2, 5e-4)
    slow, fast = np.sin(2 * np.pi * time), 0.5 * np.sin(2 * np.pi * 120 * time)
    found = find_oscillation(np.stack([slow, slow + fast]), time)
    assert found.size == np.sum(time >= 0)
    middle = slice(found.size // 4, 3 * found.size // 4)
    assert np.sqrt(np.mean(found[middle] ** 2)) == pytest.approx(0.5 / np.sqrt(2), rel=0.015)


@pytest.fixture
def case() -> Case:
    """Three spans, coarse elements, three coefficients."""
    (case,) = select_cases(["vovan2015/dropper-oscillation"])
    steps = case.file.discretisation.model_copy(update={"element_m": 2.25, "time_step_s": 1e-3})
    sensors = tuple(sensor.model_copy(update={"x_m": 87.75}) for sensor in case.file.mass_drop.sensor)
    drop = case.file.mass_drop.drop[0].model_copy(update={"x_m": 85.5})
    mass_drop = case.file.mass_drop.model_copy(update={"sensor": sensors, "drop": (drop,), "record_s": 1.7})
    study = case.file.study.model_copy(update={"coefficients_s": (0.0, 1e-5, 1e-3)})
    file = case.file.model_copy(update={"discretisation": steps, "mass_drop": mass_drop, "study": study})
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(3)})
    return replace(case, file=file, line=line)


def test_more_damping_shortens_the_oscillation_of_a_drop(case: Case) -> None:
    outcome = run_dropper_oscillation(case, case.file.study)
    findings = outcome.study.findings[LINE]
    assert findings["dropper_oscillation_decay_ratio"] < 1
    small, large = findings["dropper_velocity_change_pct"]
    assert 0 < small < 1 < large
    assert [row[0] for row in outcome.study.tables[0].rows] == ["0 s", "1e-05 s", "0.001 s"]


@pytest.mark.parametrize("change", [{"x_m": 90.0}, {"wire": "contact_wire"}])
def test_sensors_of_one_dropper_are_needed(case: Case, change: dict[str, object]) -> None:
    first, second = case.file.mass_drop.sensor
    mass_drop = case.file.mass_drop.model_copy(update={"sensor": (first, second.model_copy(update=change))})
    other = replace(case, file=case.file.model_copy(update={"mass_drop": mass_drop}))
    with pytest.raises(InputError, match="the first two sensors are not at one dropper"):
        run_dropper_oscillation(other, case.file.study)
