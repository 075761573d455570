"""Findings on the modes of the line: the stand-in meets them, other damping models do not."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from helpers.computed_modes import computed_modes, grade_findings
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.population_format import PopulationFile, Variability
from pantocheck.conformance.studies.vovan2015.line_damping import (
    compare_reference,
    compute_group_findings,
    compute_population_findings,
)
from pantocheck.model import Catenary, Kind, Rayleigh

LineChange = Callable[[Catenary], Catenary]
OF_THE_DROPS = {
    "damping_dispersion_correlation",
    "outliers_above_pct",
    "repeat_correlation",
    "half_power_record_s",
    "group_merging_Hz",
    "smallest_phase_collinearity",
    "lateral_modes_in_group",
    "identification_scatter_correlation",
}
"""Quantities that need more than the modes of the line."""
FREQUENCIES = {("modes_in_group", 1), ("mode_frequency_Hz", 1), ("mode_frequency_Hz", 2)}
CRITERIA = FREQUENCIES | {
    ("damping_ratio", 1),
    ("damping_ratio", 3),
    ("largest_damping_ratio", None),
    ("damping_decrease_pct", None),
    ("largest_damping_decrease_pct", None),
    ("damping_variation_pct", None),
    ("reference_over_identified_damping", 1),
    ("reference_over_identified_damping", 6),
}
HIGHEST = 6.6
"""Between the seventh and the eighth group [Hz]."""


@cache
def find_reference() -> tuple[RealArray, RealArray]:
    """Frequencies [Hz] and damping ratios of the reference model."""
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    model = build_catenary(case.with_damping("initial", case.dampings["initial"]).line)
    modes = computed_modes(model, 6, HIGHEST)
    return np.array([mode.frequency_Hz for mode in modes]), np.array([mode.damping_ratio for mode in modes])


def grade_line(line: Catenary, highest: float = HIGHEST) -> dict[tuple[str, int | None], Criterion]:
    """Criteria of the stand-in for the modes of a line, as an exact identification would find them."""
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    modes = computed_modes(line, 6, highest)
    values = compute_group_findings(modes)
    values["reference_over_identified_damping"] = compare_reference(modes, *find_reference())
    rows = grade_findings(case, {LINE: values})
    return {key: row for key, row in rows.items() if key[0] not in OF_THE_DROPS}


def failed_criteria(change: LineChange = lambda line: line, highest: float = HIGHEST) -> set[tuple[str, int | None]]:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    rows = grade_line(change(build_catenary(case.line)), highest)
    assert set(rows) == CRITERIA
    assert all(row.margin is not None or row.verdict == "skip" for row in rows.values())
    return {key for key, row in rows.items() if row.finding.outcome in ("not_reproduced", "inferred_not_met")}


@pytest.mark.parametrize(
    ("damping_pct", "decrease", "rise"),
    [
        ((1.0, 0.8, 0.7, 0.75, 0.72, 1.4), 12.5, 7.142857),  # 20 % and 12.5 %; 0.75 % over 0.70 %
        ((1.0, 0.9, 0.6, 0.54, 0.57, 1.4), 10.0, -5.0),  # 10 % and 33 %; 0.57 % over 0.60 %
        ((1.0, 1.2, 0.6, 0.57, 0.54, 0.1), -20.0, -5.0),  # the first step rises
        ((1.0, 0.5, 0.6, 0.6, 0.9, 0.1), -20.0, 50.0),  # the second step rises
    ],
)
def test_findings_of_groups_calculated_by_hand(damping_pct: tuple[float, ...], decrease: float, rise: float) -> None:
    """Groups at 1 Hz to 5 Hz, and one at 6.1 Hz, above the range of the finding.

    The smallest decrease from group to group counts, and the largest later damping over that of the third group. Each
    group has three certain modes, an uncertain one and a lateral one with ten times its damping.
    """
    frequencies = (1.0, 2.0, 3.0, 4.0, 5.0, 6.1)
    modes = []
    for number, (frequency, damping) in enumerate(zip(frequencies, damping_pct, strict=True), 1):
        for share in (0.9, 1.0, 1.1):
            modes.append(build_mode(share * frequency, 0.01 * share * damping, number))
        modes.append(build_mode(frequency, 0.1 * damping, number).model_copy(update={"certain": False}))
        modes.append(build_mode(frequency, 0.1 * damping, number).model_copy(update={"lateral": True}))
    findings = compute_group_findings(modes)
    assert findings["modes_in_group"] == (4.0,) * 6
    assert findings["mode_frequency_Hz"] == pytest.approx(frequencies)
    assert findings["damping_ratio"] == pytest.approx([0.01 * damping for damping in damping_pct])
    assert findings["largest_damping_ratio"] == pytest.approx(0.011 * max(damping_pct))
    assert findings["damping_decrease_pct"] == pytest.approx(decrease)
    assert findings["damping_rise_pct"] == pytest.approx(rise)


def test_three_groups_give_a_decrease_but_no_rise() -> None:
    modes = [build_mode(float(number), damping, number) for number, damping in enumerate((0.010, 0.008, 0.006), 1)]
    findings = compute_group_findings(modes)
    assert findings["damping_decrease_pct"] == pytest.approx(20.0)
    assert "damping_rise_pct" not in findings
    assert "damping_decrease_pct" not in compute_group_findings(modes[:2])


def build_mode(frequency: float, damping: float, group: int) -> Mode:
    return Mode(
        frequency_Hz=frequency, damping_ratio=damping, damping_ratio_std=1e-5, group=group, sensor_shape=(), record="T"
    )


def test_group_findings_of_a_strong_and_a_weak_step() -> None:
    """Steps of 20 % and 40 %; later groups within 25 % of the third, above and below."""
    damping = (1.0, 0.8, 0.48, 0.6, 0.36)
    findings = compute_group_findings([build_mode(float(n), 0.01 * z, n) for n, z in enumerate(damping, 1)])
    assert findings["damping_decrease_pct"] == pytest.approx(20.0)
    assert findings["largest_damping_decrease_pct"] == pytest.approx(40.0)
    assert findings["damping_variation_pct"] == pytest.approx(25.0)


@pytest.mark.parametrize(
    ("correlation", "share", "expected"),
    [
        (-0.8, 0.75, {"damping_dispersion_correlation": -0.8, "outliers_above_pct": 75.0}),
        (None, None, {}),  # too few tests, no outlier
    ],
)
def test_findings_over_tests(correlation: float | None, share: float | None, expected: dict[str, float]) -> None:
    variability = Variability(
        groups=8, rank_correlation=correlation, last_over_first=None, outliers=4, outliers_above_share=share
    )
    population = PopulationFile.model_construct(variability=variability)
    assert compute_population_findings(population) == expected


def test_reference_is_compared_at_the_frequency_of_each_mode() -> None:
    """A reference of 1 % per Hz: 1 % over 2 % in group 1; in group 2, 1.9, 2.0 and 2.1 % over 1 %; none in group 4."""
    modes = [build_mode(1.0, 0.02, 1), *(build_mode(f, 0.01, 2) for f in (1.9, 2.0, 2.1)), build_mode(4.0, 0.01, 4)]
    modes += [modes[0].model_copy(update={"lateral": True, "damping_ratio": 1.0})]
    assert compare_reference(modes, np.array([0.0, 10.0]), np.array([0.0, 0.1])) == pytest.approx((0.5, 2.0))


def test_stand_in_meets_every_imposed_finding_and_only_those_that_are_imposed_count_as_such() -> None:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    rows = grade_line(build_catenary(case.line))
    assert {row.finding.outcome for row in rows.values()} == {"imposed", "reproduced", "inferred_met"}
    assert {key for key, row in rows.items() if row.finding.outcome == "reproduced"} == {("mode_frequency_Hz", 2)}
    assert {key for key, row in rows.items() if row.finding.outcome == "inferred_met"} == {("damping_ratio", 3)}


def test_example_coefficients_of_figure_6_contradict_the_paper_as_a_measured_line() -> None:
    """They have 0.71, 0.39 and 0.29 % in the first groups: the paper calls them arbitrary.

    Four findings fail: below 0.5 %, slight decrease, no variation after it, and a reference that is slightly too small.
    """
    (printed,) = select_cases(["vovan2015/mass-drop/printed"])
    rows = grade_line(build_catenary(printed.line))
    failed = {key for key, row in rows.items() if row.finding.outcome == "not_reproduced"}
    assert failed == {
        ("damping_ratio", 1),
        ("largest_damping_decrease_pct", None),
        ("damping_variation_pct", None),
        ("reference_over_identified_damping", 1),
    }


def with_tension(factor: float) -> LineChange:
    """Change of the tension of every wire; frequencies are proportional to its square root."""
    return lambda line: replace(
        line, wires=tuple(replace(wire, tension=factor * wire.tension) for wire in line.wires)
    )  # fmt: skip


def with_rayleigh(mass: float, stiffness: float) -> LineChange:
    damping = dict.fromkeys((Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE), Rayleigh(mass, stiffness))
    return lambda line: replace(line, damping=damping, modal_damping=())


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (with_rayleigh(0.15, 1e-4), {("largest_damping_ratio", None), ("damping_ratio", 1)}),  # 1.5 % at 0.8 Hz
        (
            with_rayleigh(0.001, 1e-4),  # stiffness damping alone
            {("damping_decrease_pct", None), ("damping_variation_pct", None), ("reference_over_identified_damping", 1)},
        ),
        (
            with_rayleigh(1e-3, 1e-6),  # 0.004 % at 2.6 Hz
            {("damping_ratio", 3), ("reference_over_identified_damping", 1)},
        ),
        (with_rayleigh(0.05, 3e-4), {("reference_over_identified_damping", 6)}),
    ],
)
def test_wrong_damping_fails_the_findings_of_its_fault(
    change: LineChange, expected: set[tuple[str, int | None]]
) -> None:
    failed = failed_criteria(change)
    assert expected <= failed
    assert not failed & FREQUENCIES


def test_wrong_frequencies_are_detected() -> None:
    """A tension 1.3 times too high raises 0.87 Hz to 1.0 Hz; one four times too high 1.75 Hz to 3.5 Hz."""
    assert ("mode_frequency_Hz", 1) in failed_criteria(with_tension(1.3))
    assert {("mode_frequency_Hz", 1), ("mode_frequency_Hz", 2)} <= failed_criteria(with_tension(4.0), highest=13.0)


def test_missing_mode_of_the_first_group_is_detected() -> None:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    modes = computed_modes(build_catenary(case.line), 6, HIGHEST)[1:]
    rows = grade_findings(case, {LINE: compute_group_findings(modes)})
    assert rows["modes_in_group", 1].verdict == "fail"


def test_damping_against_group_is_skipped_without_enough_groups() -> None:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    rows = grade_line(build_catenary(case.line), 2.0)
    for quantity in ("damping_decrease_pct", "largest_damping_decrease_pct", "damping_variation_pct"):
        assert rows[quantity, None].verdict == "skip"
