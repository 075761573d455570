"""Gain of damping by dampers at the steady arms: its course over frequency, and detection of other damping."""

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
from pantocheck.conformance.studies.vovan2015.steady_arm_damper import damping_gains, locate_end, run_steady_arm_damper
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
        centres = [(low + high) / 2 for low, high in case.file.study.bands_Hz]
        rows = grade_findings(case, {LINE: damping_gains(medians(line), medians(change(line)), centres)})
        return {(name.removeprefix("damping_gain_"), band): row.finding.outcome for (name, band), row in rows.items()}

    return grade_change


def with_dampers(damper: float) -> LineChange:
    return lambda line: replace(
        line, steady_arms=tuple(replace(arm, vertical_damper=damper) for arm in line.steady_arms)
    )


def test_gains_by_hand_fade_from_the_second_to_the_last_band() -> None:
    """Gains of 20, 60, 40 and 2 %: the smaller growth is 40 over 60, and 6 % lie at 34 / 38 of the last step."""
    findings = damping_gains([0.002] * 4, [0.0024, 0.0032, 0.0028, 0.00204], [1.0, 2.0, 3.0, 4.0])
    assert_allclose(findings["damping_gain_pct"], [20, 60, 40, 2])
    assert_allclose(findings["damping_gain_ratio"], [1, 3, 2, 0.1])
    assert_allclose(findings["damping_gain_step"], 2 / 3)
    assert_allclose(findings["damping_gain_correlation"], -1)
    assert_allclose(findings["damping_gain_end_Hz"], 3 + 34 / 38)
    assert_allclose(locate_end([20, 60, 40, 2], [1.0, 2.0, 3.0, 4.0], 0.3), 3 + 22 / 38)  # 18 % remain
    assert locate_end([20, 60, 40, 2], [1.0, 2.0, 3.0, 4.0], 0.03) is None
    assert "damping_gain_end_Hz" not in damping_gains([0.002] * 4, [0.0024, 0.0032, 0.0028, 0.0022], [1.0, 2, 3, 4])
    none = damping_gains([0.002] * 4, [0.00199, 0.0032, 0.0028, 0.00204], [1.0, 2.0, 3.0, 4.0])
    assert none.keys() == {"damping_gain_pct"}  # no gain in the first band: -0.5 %
    findings = damping_gains([0.002, np.nan, 0.003, 0.003], [0.003, 0.006, 0.003, 0.003], [1.0, 2, 3, 4])
    assert_allclose(findings.pop("damping_gain_pct"), [50])
    assert findings == {}


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


def test_outcomes_do_not_depend_on_the_size_of_the_damper(verdicts_for: Grading) -> None:
    """A damper of a tenth and the assumed one give the same outcomes; the paper prints no damper."""
    expected = {
        ("ratio", 2): "inferred_not_met",
        ("ratio", 3): "reproduced",
        ("correlation", None): "reproduced",
        ("end_Hz", None): "reproduced",
        ("step", None): "reproduced",
    }
    assert verdicts_for(with_dampers(0.6)) == verdicts_for(with_dampers(6.0)) == expected


def test_other_damping_is_detected(verdicts_for: Grading) -> None:
    """Without a change nothing has a course; mass damping gains most in the first group and has no growth."""
    assert set(verdicts_for(lambda line: line).values()) == {"not_evaluated"}
    outcomes = verdicts_for(lambda line: replace(line, damping={kind: Rayleigh(0.2, 7e-5) for kind in Kind}))
    assert outcomes["ratio", 3] == outcomes["step", None] == "not_reproduced"
    outcomes = verdicts_for(lambda line: replace(line, damping={kind: Rayleigh(0.03, 5e-4) for kind in Kind}))
    assert outcomes["correlation", None] == "not_reproduced"
    assert outcomes["end_Hz", None] == "not_evaluated"  # the effect lasts up to the last band
