"""Gain of damping by dampers at the steady arms: it fades with frequency, and other damping is detected."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.computed_modes import ELEMENT, grade_findings
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.studies.vovan2015.steady_arm_damper import damping_gains, run_steady_arm_damper
from pantocheck.model import Catenary, Kind, Rayleigh, discretise
from pantocheck.model.modal.modes import compute_modes_below, damping_ratios

LineChange = Callable[[Catenary], Catenary]
Grading = Callable[[LineChange], dict[tuple[str, int | None], str]]


@pytest.fixture(scope="module")
def case() -> Case:
    (case,) = select_cases(["vovan2015/steady-arm-damper"])
    return case


@pytest.fixture(scope="module")
def verdicts_for(case: Case) -> Grading:
    """Function that grades a change of the line in place of the dampers: verdicts by quantity and band."""
    line = build_catenary(case.line)
    mesh = discretise(line, ELEMENT)
    shapes = compute_modes_below(mesh, case.file.study.bands_Hz[-1][1])

    def medians(variant: Catenary) -> list[float]:
        ratio = damping_ratios(discretise(variant, ELEMENT), shapes)
        inside = [(shapes.frequency >= low) & (shapes.frequency < high) for low, high in case.file.study.bands_Hz]
        return [float(np.median(ratio[band])) for band in inside]

    def grade_change(change: LineChange) -> dict[tuple[str, int | None], str]:
        rows = grade_findings(case, {LINE: damping_gains(medians(line), medians(change(line)))})
        return {(name.removeprefix("damping_gain_"), band): row.verdict for (name, band), row in rows.items()}

    return grade_change


def with_dampers(damper: float) -> LineChange:
    return lambda line: replace(
        line, steady_arms=tuple(replace(arm, vertical_damper=damper) for arm in line.steady_arms)
    )


def test_gains_by_hand_fade_from_the_second_to_the_last_band() -> None:
    findings = damping_gains([0.002, 0.004, 0.003], [0.003, 0.006, 0.003])
    assert_allclose(findings["damping_gain_pct"], [50, 50, 0], atol=1e-9)
    assert_allclose(findings["damping_gain_fading_pct"], 50)
    # Gains of 60 %, 50 %, 20 % and 10 % by hand: the first band has the largest gain but does not count.
    findings = damping_gains([0.002] * 4, [0.0032, 0.003, 0.0024, 0.0022])
    assert_allclose(findings["damping_gain_pct"], [60, 50, 20, 10])
    assert_allclose(findings["damping_gain_fading_pct"], 40)
    # The second band is the last.
    assert set(damping_gains([0.002, 0.002], [0.003, 0.0025])) == {"damping_gain_pct"}
    findings = damping_gains([0.002, np.nan, 0.003], [0.003, 0.006, 0.003])
    assert_allclose(findings["damping_gain_pct"], [50])
    assert "damping_gain_fading_pct" not in findings


def test_every_band_has_the_modes_from_its_lower_edge_on(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """The dampers raise the median mode of each band by 10 % times its number; six digits are 1e-5 of 10 %."""
    bands = case.file.study.bands_Hz

    def build_drops(gain: float) -> SimpleNamespace:
        modes = [
            Mode(
                frequency_Hz=low + share * (high - low),
                damping_ratio=0.001 * number * (1 + share) ** 4 * (1 + gain * number * (share == 0.5)),
                damping_ratio_std=1e-5,
                sensor_shape=(),
            )
            for number, (low, high) in enumerate(bands, 1)
            for share in (0.0, 0.5, 0.99)
        ]
        return SimpleNamespace(certain_modes=modes, drops=(None,), identification=SimpleNamespace(warnings=()))

    results = iter([build_drops(0.0), build_drops(0.1)])
    monkeypatch.setattr(
        "pantocheck.conformance.studies.vovan2015.steady_arm_damper.identify_drops", lambda *_: next(results)
    )
    study = run_steady_arm_damper(case, case.file.study).study
    assert study.charts[0].marks[0].low == bands[-1][0]
    assert_allclose(study.findings[LINE]["damping_gain_pct"], 10.0 * np.arange(1, len(bands) + 1), rtol=1e-4)


def test_computed_damping_reproduces_the_findings_and_wrong_damping_does_not(verdicts_for: Grading, case: Case) -> None:
    """The first group is not tested: the computed gain misses the finding of the paper there."""
    verdicts = verdicts_for(with_dampers(case.file.study.damper_N_s_m))
    assert [verdicts["pct", band] for band in range(2, 7)] == ["pass"] * 5
    assert verdicts["fading_pct", None] == "pass"
    assert verdicts["pct", 9] == "pass"
    verdicts = verdicts_for(lambda line: line)
    assert [verdicts["pct", band] for band in range(2, 7)] == ["fail"] * 5
    assert verdicts["pct", 9] == "pass"
    # Twice the damping of every component changes the band without a visible effect, too.
    verdicts = verdicts_for(lambda line: replace(line, damping={kind: Rayleigh(0.2, 2e-4) for kind in Kind}))
    assert verdicts["pct", 9] == "fail"
    verdicts = verdicts_for(lambda line: replace(line, damping={kind: Rayleigh(0.1, 5e-4) for kind in Kind}))
    assert verdicts["fading_pct", None] == "fail"
