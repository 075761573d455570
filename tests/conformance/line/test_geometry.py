"""Geometry of a line: positions of spans, supports and sections."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.extreme_runs import build_case, list_problems, simulate
from helpers.listed_spans import list_spans
from helpers.section_lines import section_line
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.geometry import EqualSpans
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.support_passing import rest_heights
from pantocheck.conformance.runs.uplift_tuning import compute_working_height
from pantocheck.model import discretise, simulate_passage
from pantocheck.model.statics.elasticity import rest_height


@pytest.fixture
def geometry() -> EqualSpans:
    return EqualSpans(span_m=60.0, spans=5, encumbrance_m=1.2, trust="secondary", source="test")


def test_spans_follow_each_other_from_zero_to_the_length_of_the_line(geometry: EqualSpans) -> None:
    spans = [geometry.span(number) for number in range(1, geometry.spans + 1)]
    assert spans[0][0] == 0.0
    assert spans[-1][1] == geometry.length == 300.0
    assert [end for _, end in spans[:-1]] == [start for start, _ in spans[1:]] == list(geometry.supports)
    assert geometry.span_lengths == tuple(end - start for start, end in spans)
    assert geometry.longest_span == geometry.shortest_span == 60.0
    sections = {(0.0, 60.0): (1, 1), (59.0, 121.0): (1, 3), (60.0, 120.0): (2, 2), (240.0, 300.0): (5, 5)}
    assert {ends: geometry.spans_of_section(*ends) for ends in sections} == sections


def test_section_covers_its_first_and_its_last_span(geometry: EqualSpans) -> None:
    assert geometry.section(2, 4) == (geometry.span(2)[0], geometry.span(4)[1])


def test_middle_span_lies_half_way_along_the_line(geometry: EqualSpans) -> None:
    assert geometry.mid_span(geometry.middle_span) == geometry.length / 2


def test_shorten_keeps_the_first_spans_and_never_adds_any(geometry: EqualSpans) -> None:
    assert geometry.shorten(2).span_limits == geometry.span_limits[:3]
    assert geometry.shorten(9) == geometry


def test_run_ends_at_most_half_a_span_before_the_end_of_the_line() -> None:
    """The first of two pantographs 200 m apart would otherwise run off the line."""
    for case in select_cases(["*"]):
        if not case.is_static and case.file.run_out_m is None:
            geometry, front = case.line.geometry, case.end + case.offsets[-1]
            assert front <= geometry.mid_span(geometry.spans) or case.end == case.recorded_section[1]


# Pantographs under a contact wire that rises: balance of momentum on the slope and over its kinks.
#
# The wire of the EN 50318:2002 line is level for six spans, rises over five, and is level again. With the slope s and
# the speed v, all masses M of a pantograph rise with s v on average, so that over a whole number of spans
#
#     mean(F)  =  F_0 - k_0 mean(z_1 - z_0) - [c_0 z_1 + M s v] / T,        z_1 = z + F / k_1 on average,
#
# with base spring k_0, base damper c_0, head spring k_1, height z_0 at which k_0 is without force, and the brackets for
# the change between the ends of the time T: the first is c_0 s v T on the slope, the second the momentum at a kink.
RAMP = (360.0, 660.0)
UPLIFT_FORCE, MASS, HEAD_SPRING, BASE_DAMPER = 120.0, 22.2, 4200.0, 90.0
SPEED = 100 / 3.6

Run = tuple[Case, Record, float]


def on_ramp(slope: float, base_spring: float) -> Case:
    """Two pantographs of EN 50318:2002, with another base spring, 90 m apart under a line with a ramp."""
    folder = library_folder() / "en50318-2002"
    base = load_case(folder / "250.toml")
    tables = list_spans(read_toml(folder / "line.toml", "line"))
    tables["geometry"]["span_list"] = [{"length_m": 60.0}] * 16
    tables["geometry"]["gradient"] = [{"from_m": RAMP[0], "to_m": RAMP[1], "slope": slope}]
    changes = {"speed_km_h": 3.6 * SPEED, "evaluated_spans": (5, 13), "run_out_m": 0.0, "spacing_m": (90.0,)}
    chain = base.pantographs[0].chain
    assert chain is not None
    chain = chain.model_copy(update={"stiffness_N_m": (base_spring, HEAD_SPRING)})
    pantograph = base.pantographs[0].model_copy(update={"chain": chain})
    file = base.file.model_copy(update={**changes, "pantograph": base.file.pantograph * 2})
    return replace(base, file=file, line=LineFile.model_validate(tables), pantographs=(pantograph,) * 2)


@pytest.fixture(scope="module", params=[(0.01, 0.0), (0.003, 50.0)], ids=["steep, free", "gentle, sprung"])
def run(request: pytest.FixtureRequest) -> Run:
    """Case, record and working height; elements of 2 m and steps of 4 ms move the means by less than 0.1 N."""
    case = on_ramp(*request.param)
    line = discretise(build_catenary(case.line), 2.0)
    coarse = case.file.discretisation.model_copy(update={"element_m": 2.0, "time_step_s": 4e-3})
    passage = build_passage(case, line, coarse, (UPLIFT_FORCE, UPLIFT_FORCE))
    working_height = compute_working_height(case, line, case.pantographs[0], UPLIFT_FORCE)
    return case, record_passage(case, passage, simulate_passage(line, passage)), working_height


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize(
    ("start", "end"),
    [(180.0, 300.0), (480.0, 600.0), (720.0, 780.0), (270.0, 450.0), (570.0, 750.0)],
    ids=["level", "slope", "high", "over the lower kink", "over the upper kink"],
)
def test_mean_force_obeys_the_balance_of_momentum(run: Run, row: int, start: float, end: float) -> None:
    """Over whole numbers of spans, to 0.4 N, because the passage of a span is not quite periodic.

    The terms are 25 N of damper on the steep slope, 45 N of spring above the gentle one, and 1 N of momentum at a steep
    kink.
    """
    case, record, unstretched = run
    assert record.contact_height is not None
    geometry, position, force = case.line.geometry, record.position[row], record.force[row]
    inside = (position >= start) & (position < end)
    mean, duration = force[inside].mean(), (end - start) / SPEED
    frame = record.contact_height[row, inside].mean() + mean / HEAD_SPRING - unstretched
    slope_before, slope_after = (geometry.rise(x + 0.5) - geometry.rise(x - 0.5) for x in (start, end))
    momentum = MASS * SPEED * (slope_after - slope_before)
    damping = BASE_DAMPER * (geometry.rise(end) - geometry.rise(start))
    chain = case.pantographs[0].chain
    assert chain is not None
    expected = UPLIFT_FORCE - chain.stiffness_N_m[0] * frame - (damping + momentum) / duration
    assert mean == pytest.approx(expected, abs=0.4)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("span", [4, 10, 13])
def test_head_lies_above_the_wire_at_rest_by_force_times_elasticity(run: Run, row: int, span: int) -> None:
    """On the level, on the slope and above it; to 4 % of 12 to 47 mm, as the uplift grows slightly with the speed."""
    case, record, working_height = run
    assert record.contact_height is not None
    inside = (record.position[row] >= 60.0 * (span - 1)) & (record.position[row] < 60.0 * span)
    ramp = np.array([case.line.geometry.rise(x) for x in record.position[row, inside]])
    lift = (record.contact_height[row, inside] - ramp).mean()
    nominal = case.line.geometry.rise(60.0 * 4.5)
    compliance = (working_height - nominal) / UPLIFT_FORCE
    assert lift == pytest.approx(compliance * record.force[row, inside].mean(), rel=0.04)


# Checks of records on a line whose contact wire is not equally high at its supports.
@pytest.fixture(scope="module")
def uneven() -> Case:
    """The AC simple line on a ramp of 2 per mille from 250 m on; two supports differ in height, two in their arms.

    In span 7, the first dropper is 3 m from the support in place of 4.5 m.
    """
    tables: dict[str, Any] = list_spans(
        read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line")
    )
    geometry = tables["geometry"]
    geometry["span_list"] = geometry["span_list"][:10]
    presag = list(tables["droppers"]["presag_m"])
    near = {"x_m": [3.0, *tables["droppers"]["x_m"][1:]], "presag_m": presag}
    geometry["span_list"][6] = {"length_m": 55.0, "droppers": near}
    level = {"steady_arm": {"static_share": "level"}}
    geometry["support"] = [{"number": 5, "contact_wire_height_m": 0.015} | level, {"number": 7} | level]
    geometry["gradient"] = [{"from_m": 250.0, "to_m": 500.0, "slope": 0.002}]
    return replace(build_case(), line=LineFile.model_validate(tables))


def test_heights_at_rest_are_those_of_the_statics(uneven: Case) -> None:
    """Exact where the arm carries its share; elsewhere bending leaves 1 mm of a sag of 7 mm, alike at each support."""
    line = discretise(build_catenary(uneven.line), 0.5)
    supports = np.array(uneven.line.geometry.supports)
    exact = line.state.deflection[0, [line.mesh.station(x) for x in supports], 0]
    difference = rest_heights(uneven, supports) - exact
    np.testing.assert_allclose(difference[[4, 6]], 0.0, atol=1e-12)
    np.testing.assert_allclose(difference[[2, 3, 5, 7]], difference[2], atol=2e-4)
    assert abs(difference[2]) < 1.5e-3


def test_record_of_an_uneven_line_is_free_of_findings(uneven: Case) -> None:
    """Two pantographs; without the heights at rest, coincidence finds 15 mm. Shifted by 10 m the record is refuted."""
    record = simulate(uneven)
    supports = uneven.line.geometry.supports
    assert list_problems(uneven, RecordSignals(record, uneven.file.filter, supports)) == {}
    shifted = replace(record, position=record.position + np.array([[0.0], [10.0]]))
    assert list_problems(uneven, RecordSignals(shifted, uneven.file.filter, supports)) != {}


@pytest.mark.parametrize("static_share", ["none", "level"])
def test_record_of_an_irregular_line_with_tolerances_is_free_of_findings(static_share: str) -> None:
    """Irregularity of 20 mm, and droppers with 8 mm of tolerance: heights at rest are known at level arms only.

    The heights that the check of coincidence subtracts are those of the statics, or unknown.
    """
    tables: dict[str, Any] = read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line")
    tables["geometry"]["spans"] = 10
    tables["steady_arm"]["static_share"] = static_share
    heights = [0.0, 0.02, -0.02, 0.015, -0.01, 0.02, -0.015, 0.0]
    tables["contact_wire"]["irregularity"] = {"x_m": [80.0 * n for n in range(8)], "height_m": heights}
    droppers = {"tolerance_m": 0.008, "seed": 1}
    tables["variation"] = {"droppers": droppers} if static_share == "none" else {}
    case = replace(build_case(), line=LineFile.model_validate(tables))
    supports = case.line.geometry.supports
    found = rest_heights(case, np.array(supports))
    if static_share == "none":
        assert np.isnan(found).all()
    else:
        exact = rest_height(discretise(build_catenary(case.line), 0.5), np.array(supports))
        np.testing.assert_allclose(found, exact, atol=1e-9)
    record = simulate(case)
    assert list_problems(case, RecordSignals(record, case.file.filter, supports)) == {}


@pytest.fixture(scope="module")
def overlapping() -> Case:
    """Two sections of AC simple with an overlap of spans 5 and 6; at support 5 both contact wires are 60 mm up."""
    overlap = {"spans": 2, "support_rises_m": [0.4, 0.06]}
    return replace(build_case(), line=section_line("en50318-2018/ac-simple", (6, 6), overlap))


def test_heights_at_rest_in_an_overlap_are_those_of_the_lowest_wire(overlapping: Case) -> None:
    """At support 5, 275 m, both wires; at the others that wire which is not raised. Bending: 1 mm, as above."""
    line = discretise(build_catenary(overlapping.line), 0.5)
    supports = np.array(overlapping.line.geometry.supports)
    exact = rest_height(line, supports)
    np.testing.assert_allclose(rest_heights(overlapping, supports), exact, atol=1.5e-3)
    assert exact[4] > 0.05
    assert np.abs(np.delete(exact, 4)).max() < 0.01


def test_record_of_an_overlap_is_free_of_findings(overlapping: Case) -> None:
    """The heads change from wire to wire 60 mm higher than elsewhere; shifted by 10 m the record is refuted."""
    record = simulate(overlapping)
    low_pass, supports = overlapping.file.filter, overlapping.line.geometry.supports
    assert record.evaluated[0] < 275.0 < record.evaluated[1]
    assert list_problems(overlapping, RecordSignals(record, low_pass, supports)) == {}
    shifted = replace(record, position=record.position + np.array([[0.0], [10.0]]))
    assert list_problems(overlapping, RecordSignals(shifted, low_pass, supports)) != {}
