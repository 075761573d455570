"""Compensation force of a dropper against its stiffness coefficient: transition, and locking by the graded law."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.computed_modes import grade_findings
from helpers.lines import PANTOGRAPH_2002, simple_line
from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.studies.vovan2015.dropper_coefficient import (
    GRADED,
    _largest_force,
    compare_bands,
    compare_oscillations,
    find_oscillation,
    find_transition,
    locate_transition,
    run_dropper_damping,
    run_dropper_oscillation,
)
from pantocheck.model import Kind, Passage, Rayleigh, build_chain, discretise, simulate_passage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_viscous_part, with_damping

COEFFICIENTS = np.geomspace(1e-6, 1e-1, 51)


def low_pass_curve(corner: float) -> RealArray:
    """Force proportional to 1 / (1 + (a / corner)^2) for a coefficient a."""
    return 1000 / (1 + (COEFFICIENTS / corner) ** 2)


def test_levels_and_changes_of_known_curves() -> None:
    """The force falls to 90 % at a third of the corner, to half at the corner, to 10 % at three times the corner."""
    # The coefficients lie 26 % apart.
    findings = find_transition(COEFFICIENTS, low_pass_curve(2e-3))
    assert_allclose(findings["dropper_transition_start_s"], 2e-3 / 3, rtol=0.03)
    half = locate_transition(COEFFICIENTS, low_pass_curve(2e-3), 0.5)
    assert_allclose(list(half.values()), [2e-3, 2e-3], rtol=0.01)
    assert_allclose(findings["dropper_transition_end_s"], 6e-3, rtol=0.03)
    assert_allclose(findings["dropper_locked_force_pct"], 100 / (1 + 50**2), rtol=1e-3)
    # By hand: 2 % of the rear in 5-20 Hz, 1 % of the front; other quantities and missing bands do not count.
    chosen = {1: {"rms_0_5_N": 10.1, "mean_force_N": 150.0}, 2: {"rms_5_20_N": 9.8, "rms_20_50_N": 5.0}, 0: {}}
    least = {1: {"rms_0_5_N": 10.0, "mean_force_N": 100.0}, 2: {"rms_5_20_N": 10.0}}
    assert_allclose(compare_bands(chosen, least)["dropper_force_change_pct"], 2.0)
    assert compare_bands(chosen, {}) == {}


def grade_force(force: RealArray) -> dict[str, str]:
    (case,) = select_cases(["vovan2015/dropper-damping"])
    rows = grade_findings(case, {LINE: find_transition(COEFFICIENTS, force)})
    rows.pop(("dropper_force_change_pct", None))
    return {quantity.removeprefix("dropper_"): row.verdict for (quantity, _), row in rows.items()}


def test_wrong_or_missing_transition_is_detected() -> None:
    """Onset and end are a factor of nine apart in this curve, a factor of 100 in the paper: one of them can fit."""
    start, end, locked = "transition_start_s", "transition_end_s", "locked_force_pct"
    assert grade_force(low_pass_curve(3e-4)) == {start: "pass", end: "fail", locked: "info"}
    assert grade_force(low_pass_curve(3e-3)) == {start: "fail", end: "pass", locked: "info"}
    assert grade_force(low_pass_curve(0.06)) == {start: "fail", end: "skip", locked: "info"}  # the end is not reached
    verdicts = grade_force(np.full(COEFFICIENTS.size, 1000.0))
    assert verdicts[start] == verdicts[end] == "skip"
    with np.errstate(all="raise"):
        assert find_transition(COEFFICIENTS, np.zeros(COEFFICIENTS.size)) == {}


def test_only_compensation_of_the_elastic_force_locks_a_dropper() -> None:
    (case,) = select_cases(["vovan2015/dropper-damping"])
    study = case.file.study.model_copy(update={"coefficients_s": (1e-8, 3e-3, 1e-1), "x_m": 283.5})
    coarse = change_case(case, mesh=(1.5, 0.002), study=study, evaluated_spans=(4, 5), run_out_m=0.0)
    outcome = run_dropper_damping(coarse, study)
    (chart,) = outcome.study.charts
    nothing, elastic = (series.y for series in chart.series)
    assert [(mark.low, mark.high) for mark in chart.marks] == [(3.3e-5, 3e-4), (3.3e-3, 3e-2), (1e-5, None)]
    # Without damping the laws are the same. A dropper slackens within a time step: 4 % at 2 ms, 2 % at 1 ms.
    assert_allclose(nothing[0], elastic[0], rtol=0.05)
    assert nothing[-1] > nothing[0]
    assert elastic[-1] < 0.1 * elastic[0]
    assert outcome.study.findings[LINE]["dropper_locked_force_pct"] < 10
    # The run of the record, one with the smallest coefficient, and one of every coefficient under each law.
    assert outcome.run.simulated_s == pytest.approx((2 + 2 * 3) * outcome.record.time[-1], rel=0.01)


def test_motion_of_a_dropper_far_behind_the_train_is_known_until_the_end() -> None:
    """The last pantograph stops 1.5 spans behind the dropper; without its motion there, no force would be found."""
    (case,) = select_cases(["vovan2015/dropper-damping"])
    study = case.file.study.model_copy(update={"coefficients_s": (1e-6, 1e-1)})
    outcome = run_dropper_damping(change_case(case, mesh=(2.25, 0.004)), study)
    assert outcome.study.findings[LINE]["dropper_locked_force_pct"] < 10


def test_both_laws_are_the_same_while_every_dropper_is_taut() -> None:
    """The laws give two linear systems with the same matrices until one dropper becomes slack."""
    # The measured difference is rounding, 1e-13 of the displacement. A dashpot with an error of 0.1 % would give 2e-5.
    line = simple_line(damping={Kind.DROPPER: Rayleigh(stiffness_coefficient=1e-3)})
    mesh = discretise(line, 2.0)
    kept = keep_viscous_part(mesh)
    assert kept.connectors.damping.sum() == pytest.approx(mesh.connectors.damping.sum(), rel=1e-12)
    assert not kept.connectors.unilateral[mesh.connectors.station.size :].any()
    # `with_damping` builds new connectors without the law: it must come before the law.
    assert with_damping(kept, line.damping).connectors.station.size == mesh.connectors.station.size
    light, heavy = compare_runs(mesh, kept, 5.0), compare_runs(mesh, kept, 200.0)
    assert light.smallest_force > 0  # every dropper pulls at every time
    still = Passage((PANTOGRAPH_2002,), (20.0,), 0.0, 0.01, 1e-3)
    assert _largest_force(mesh, still, 0, 1e-3, GRADED) == 0.0
    assert light.displacement > 1e-4
    assert light.difference < 1e-10 * light.displacement
    assert heavy.smallest_force < 0
    assert heavy.difference > 1e-3 * heavy.displacement


@dataclass(frozen=True)
class RunComparison:
    """Smallest dropper force [N], and largest displacement and difference of two runs at the droppers [m]."""

    smallest_force: float
    displacement: float
    difference: float


def compare_runs(mesh: DiscretisedLine, other: DiscretisedLine, uplift: float) -> RunComparison:
    """Compare passages of a head with a constant uplift force [N] over most of two lines."""
    head = build_chain(np.array([5.0]), np.array([0.0]), np.array([20.0]), uplift, 0, 50e3)
    droppers = mesh.catenary.droppers
    watched = tuple((wire, dropper.position) for dropper in droppers for wire in (dropper.upper, dropper.lower))
    passage = Passage((head,), (20.0,), 50.0, 1.0, 0.002, watched)
    motion, compared = (simulate_passage(line, passage).motion for line in (mesh, other))
    change = motion[0::2] - motion[1::2]
    bars, count = mesh.connectors, len(droppers)
    assert bars.unilateral[:count].all()
    force = bars.preload[:count, None] + bars.stiffness[:count, None] * change[..., 0]
    force += bars.damping[:count, None] * change[..., 1]
    return RunComparison(force.min(), np.abs(motion[..., 0]).max(), np.abs(compared - motion)[..., 0].max())


# Oscillation of a dropper after a release: decay of a known signal, and a short drop.
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
    """Both wires move at 1 Hz; the messenger wire alone has 0.5 at 30 and 120 Hz. The filter takes 1.2 % of it."""
    time = np.arange(-1, 2, 5e-4)
    slow, low, high = (np.sin(2 * np.pi * frequency * time) for frequency in (1.0, 30.0, 120.0))
    found = find_oscillation(np.stack([slow, slow + 0.5 * low + 0.5 * high]), time)
    assert found.size == np.sum(time >= 0)
    middle = slice(found.size // 4, 3 * found.size // 4)
    assert np.sqrt(np.mean(found[middle] ** 2)) == pytest.approx(0.5 / np.sqrt(2), rel=0.015)


@pytest.fixture
def case() -> Case:
    """Three spans, coarse elements, three coefficients."""
    (case,) = select_cases(["vovan2015/dropper-oscillation"])
    sensors = tuple(sensor.model_copy(update={"x_m": 87.75}) for sensor in case.file.mass_drop.sensor)
    drop = case.file.mass_drop.drop[0].model_copy(update={"x_m": 85.5})
    mass_drop = case.file.mass_drop.model_copy(update={"sensor": sensors, "drop": (drop,), "record_s": 1.7})
    study = case.file.study.model_copy(update={"coefficients_s": (0.0, 1e-5, 1e-3)})
    return change_case(case, 3, (2.25, 1e-3), mass_drop=mass_drop, study=study)


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
