"""Uncertainty of the values of a case: each component against a closed form, for two pantographs."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.wave_system import Wave, cut_bare
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.record_uncertainty import draw_lengths
from pantocheck.conformance.quantities.uncertainty import Uncertainty
from pantocheck.conformance.records.length_uncertainty import SubRecordRange
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.runs.system import Delivered


@pytest.fixture(scope="module")
def twin() -> Case:
    """Two pantographs; the run-in of the first is 25.4 spans, the analysis section has ten spans."""
    name = "en50318-2018/ac-simple/320-twin"
    (case,) = (case for case in select_cases([name]) if case.id == name)
    return case


def record(case: Case, mean: float = 119.0, growth: float = 0.0) -> Record:
    """A wave whose mean grows along the line [N per span]; the second pantograph has twice the growth."""
    made = Wave(mean=mean).record(case)
    rise = growth * np.arange(1, made.pantographs + 1)[:, None] * made.position / case.line.geometry.span_m
    return replace(made, force=made.force + rise)


def uncertainty(case: Case, delivered: Delivered) -> Uncertainty:
    return CaseEvaluation(case, delivered).uncertainty


def mean_width(found: Uncertainty, component: str, pantograph: int) -> float:
    return found.list_components(pantograph, "mean_force_N")[component]


def test_discretisation_follows_from_three_or_two_runs(twin: Case) -> None:
    """Means of 119 + 0.4 h^2: half-width 1.25 times 0.4; the uplift does not differ between the runs."""
    coarse, value, fine = (Delivered(record(twin, 119.0 + 0.4 * h**2)) for h in (2.0, 1.0, 0.5))
    found = uncertainty(twin, replace(value, coarse=coarse, refined=fine))
    for pantograph in (1, 2):
        assert mean_width(found, "discretisation", pantograph) == pytest.approx(0.5, rel=1e-9)
    assert found.list_components(0, "max_uplift_at_support_mm")["discretisation"] == 0.0
    assert "doubled" in found.components["discretisation"].basis
    value, fine = Delivered(record(twin, 119.0)), Delivered(record(twin, 119.1))
    found = uncertainty(twin, replace(value, refined=fine))
    assert mean_width(found, "discretisation", 2) == pytest.approx(0.3, rel=1e-9)
    assert "doubled" not in found.components["discretisation"].basis


def test_items_of_the_line_at_rest_have_their_own_discretisation(twin: Case) -> None:
    """The first dropper converges with order 2, the second oscillates: three times 0.1. Other items are left out."""
    runs = [
        Delivered(record(twin), {"dropper_length_m": lengths}) for lengths in ((1.4, 0.9), (1.1, 0.7), (1.025, 0.8))
    ]
    found = uncertainty(twin, replace(runs[1], coarse=runs[0], refined=runs[2]))
    assert found.list_components(0, "dropper_length_m")["discretisation"] == pytest.approx((0.125, 0.3), rel=1e-9)
    one_item = Delivered(record(twin), {"dropper_length_m": (1.025,)})
    found = uncertainty(twin, replace(runs[1], coarse=runs[0], refined=one_item))
    assert "discretisation" not in found.list_components(0, "dropper_length_m")


def test_start_of_a_short_run_in_follows_from_other_starts(case_250: Case) -> None:
    """1.25 times the largest of the changes 0.2 N, 0.6 N and 0.4 N."""
    starts = tuple(Delivered(record(case_250, 119.0 + change)) for change in (0.2, -0.6, 0.4))
    found = uncertainty(case_250, Delivered(record(case_250), starts=starts))
    assert mean_width(found, "start", 1) == pytest.approx(0.75, rel=1e-6)
    assert found.components["start"].basis == "3 runs with other starts and ramps, after a run-in of 3 spans"


def test_starts_inside_every_limit_are_counted_with_that_of_the_case(case_250: Case) -> None:
    """Changes of the mean by 0.2, -0.6 and 0.4 N against limits of 0.3 N around it: the case and the first one pass."""
    limit = Limit(quantity="mean_force_N", pantograph=1, lower=118.7, upper=119.3, trust="secondary", source="test")
    case = replace(case_250, limits=(limit,))
    starts = tuple(Delivered(record(case, 119.0 + change)) for change in (0.2, -0.6, 0.4))
    found = grade_case(case, Delivered(record(case), starts=starts), "secondary").conformity
    assert found is not None
    assert (found.starts, found.passing_starts) == (4, 2)


def test_long_run_in_has_a_reproducible_start_and_section(twin: Case) -> None:
    """12 of 25.4 spans earlier, the mean is lower by 12 N, and by 24 N for the second pantograph."""
    found = uncertainty(twin, Delivered(record(twin, growth=1.0)))
    for pantograph in (1, 2):
        assert mean_width(found, "start", pantograph) == pytest.approx(12.0 * pantograph, rel=1e-3)
        # 1.25 times three quarters of the growth of a span. One sample of 89 mm more or less gives 1e-3 N.
        assert mean_width(found, "section", pantograph) == pytest.approx(1.25 * 0.75 * pantograph, rel=5e-3)
    # Every section of whole spans of a sine is the same, apart from single samples, 3e-3 N.
    found = uncertainty(twin, Delivered(record(twin)))
    for component in ("start", "section", "length"):
        for pantograph in (1, 2):
            assert mean_width(found, component, pantograph) < 0.05
    few = "fewer than 60 spans are too few for an interval of stated coverage"
    basis = f"range of the values of half records, spans of 55 m; {few}"
    assert found.components["length"].basis == basis
    first, second = (uncertainty(twin, Delivered(record(twin, growth=0.3))).combined for _ in range(2))
    assert first == second
    assert first[1]["std_force_N"] != first[2]["std_force_N"]


def test_record_of_the_section_alone_names_what_is_not_known(case_250: Case) -> None:
    """A foreign record without a second mesh, another start or track outside the section: nothing is zero."""
    whole = record(case_250)
    start, end = case_250.analysis_section
    inside = (whole.position[0] >= start) & (whole.position[0] < end)
    cut = cut_bare(whole, inside)
    found = uncertainty(case_250, Delivered(cut))
    assert {name: part.basis for name, part in found.components.items() if not part.half_widths} == {
        "discretisation": "not known: the system delivered one mesh and one time step only",
        "start": "not known: after a run-in of 3 spans, it needs runs with other starts",
        "section": "not known: the record does not extend beyond the analysis section",
        "length": "not known: the analysis section is shorter than 5 spans",
        "line": "does not apply: the line file states no tolerances",
    }
    result = grade_case(case_250, Delivered(cut), "secondary")
    assert {row.uncertainty for row in result.criteria} <= {0.0, None}  # the record has rate and digits of the case
    assert result.uncertainty_basis["start"].startswith("not known")


def test_range_of_a_short_record_is_drawn_evenly_to_both_sides() -> None:
    """Quartiles of 1,000 equally likely deviations within 0.4 N: three standard errors of the median are 0.04 N."""
    draws = draw_lengths({1: {"std_force_N": SubRecordRange(0.4)}}, 32 * "ab")[1]["std_force_N"]
    assert np.quantile(draws, [0.0, 0.25, 0.5, 0.75, 1.0]) == pytest.approx([-0.4, -0.2, 0.0, 0.2, 0.4], abs=0.04)


def test_static_case_has_the_discretisation_only() -> None:
    name = "en50318-2018/ac-simple/static"
    (case,) = select_cases([name])
    runs = [Delivered(static={"wave_speed_m_s": speed}) for speed in (122.0, 121.0, 120.75)]
    found = uncertainty(case, replace(runs[1], coarse=runs[0], refined=runs[2]))
    assert found.combined[0]["wave_speed_m_s"] == pytest.approx(1.25 / 3, rel=1e-9)
    assert {found.components[name].basis for name in ("start", "section", "length")} == {  # type: ignore[index]
        "does not apply: the line is at rest"
    }


def test_runs_left_out_change_no_verdict_and_add_no_certainty(case_250: Case) -> None:
    """Without other meshes and starts the verdicts are the same; the components are missing, not smaller."""
    bare = Delivered(record(case_250))
    starts = tuple(Delivered(record(case_250, 119.0 + change)) for change in (0.2, -0.6, 0.4))
    full = replace(bare, coarse=Delivered(record(case_250, 121.0)), refined=Delivered(record(case_250)), starts=starts)
    results = [grade_case(case_250, delivered, "secondary") for delivered in (full, bare)]
    assert results[0].verdict == results[1].verdict
    assert all(row.components for row in results[0].criteria)
    for known, less in zip(results[0].criteria, results[1].criteria, strict=True):
        assert known.verdict == less.verdict
        assert less.components.items() <= known.components.items()
