"""Line layout: values of every support, listed spans, heights on gradients, and errors with key and number."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.changed_lines import changed_line, changed_tables, refuse_line
from helpers.listed_spans import list_spans, list_supports
from helpers.toml_edit import change_keys
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.catenary_model import build_catenary, build_derived_line
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.case_run import build_passage, list_start_forces, record_passage
from pantocheck.conformance.runs.static_quantities import compute_static_quantities
from pantocheck.model import TrackCurve, discretise, simulate_passage


def listed_line(**geometry: Any) -> dict[str, Any]:
    """The line of EN 50318:2018 with four listed spans of 55 m, and further keys of its geometry."""
    tables = list_spans(read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line"))
    change_keys(tables, {"geometry.span_list": tables["geometry"]["span_list"][:4]})
    tables["geometry"] |= {"stagger_contact_wire_m": 0.2, "encumbrance_m": 1.2} | geometry
    return tables


def test_supports_have_their_own_values_and_those_of_the_line() -> None:
    """Support 2 has its own arm, stagger and encumbrance; its neighbours alternate as before."""
    arm = {"acts": "push", "length_m": 0.9, "vertical_damper_N_s_m": 20.0}
    own = {"number": 2, "stagger_contact_wire_m": -0.25, "stagger_messenger_m": 0.05, "encumbrance_m": 1.1}
    own |= {"steady_arm": arm, "messenger_support": {"stiffness_N_m": 2e5}}
    line = LineFile.model_validate(listed_line(support=[own]))
    layout = line.layout
    assert [limit.number for limit in layout.limits] == [0, 1, 2, 3, 4]
    assert [limit.contact_wire_stagger for limit in layout.limits] == [0.2, -0.2, -0.25, -0.2, 0.2]
    assert [limit.messenger_wire_stagger for limit in layout.limits] == [0.0, 0.0, 0.05, 0.0, 0.0]
    assert [limit.messenger_wire_height for limit in layout.limits] == [1.2, 1.2, 1.1, 1.2, 1.2]
    arms = [line.steady_arm, line.steady_arm.model_copy(update=arm), line.steady_arm]
    assert [line.steady_arm_at(support) for support in layout.supports] == arms
    stiffness = [500e3, 2e5, 500e3]
    assert [line.messenger_support_at(support).stiffness_N_m for support in layout.supports] == stiffness


def test_gradients_add_to_the_heights_of_the_supports() -> None:
    """Rise of 2 per mille from 40 m to 120 m, on supports at 5.3 m of which the first is 20 mm higher.

    The start of the line is level with its next support but for the gradient; the chord is straight between supports.
    """
    gradient = [{"from_m": 40.0, "to_m": 120.0, "slope": 0.002}]
    tables = listed_line(contact_wire_height_m=5.3, support=[{"number": 1, "contact_wire_height_m": 5.32}])
    tables["geometry"]["gradient"] = gradient
    layout = LineFile.model_validate(tables).layout
    heights = [5.32, 5.32 + 0.03, 5.3 + 0.14, 5.3 + 0.16, 5.3 + 0.16]
    assert [limit.contact_wire_height for limit in layout.limits] == pytest.approx(heights, abs=1e-12)
    assert [limit.messenger_wire_height - 1.2 for limit in layout.limits] == pytest.approx(heights, abs=1e-12)
    assert layout.chord_height(np.array([27.5, 82.5])) == pytest.approx([5.335, 5.395], abs=1e-12)


def test_an_end_of_the_line_is_level_with_its_next_support_unless_it_has_its_own_height() -> None:
    supports = [
        {"number": 1, "contact_wire_height_m": 0.1, "encumbrance_m": 1.0},
        {"number": 4, "contact_wire_height_m": -0.2, "encumbrance_m": 0.8, "stagger_contact_wire_m": 0.0},
    ]
    layout = LineFile.model_validate(listed_line(support=supports)).layout
    assert [limit.contact_wire_height for limit in layout.limits] == [0.1, 0.1, 0.0, 0.0, -0.2]
    assert [limit.messenger_wire_height for limit in layout.limits] == pytest.approx([1.1, 1.1, 1.2, 1.2, 0.6])
    assert layout.limits[4].contact_wire_stagger == 0.0


def test_droppers_take_pre_sags_from_the_chord_or_surveyed_heights() -> None:
    """In span 2 the wire rises from 0.0 m to 0.11 m, 2 mm per metre: pre-sags count from there, heights do not."""
    tables = listed_line(support=[{"number": 2, "contact_wire_height_m": 0.11}])
    own = {"x_m": [10.0, 45.0], "contact_wire_height_m": [0.013, 0.085]}
    tables["geometry"]["span_list"][2] = {"length_m": 55.0, "droppers": own}
    spans = LineFile.model_validate(tables).layout.spans
    schedule = tables["droppers"]
    chord = 0.002 * np.array(schedule["x_m"])
    np.testing.assert_allclose(spans[1].contact_wire_height, chord - schedule["presag_m"], atol=1e-15)
    np.testing.assert_array_equal(spans[1].dropper_position, 55.0 + np.array(schedule["x_m"]))
    np.testing.assert_array_equal(spans[2].contact_wire_height, own["contact_wire_height_m"])


def test_a_shortened_line_keeps_the_values_of_its_supports() -> None:
    supports = [{"number": 2, "encumbrance_m": 1.0}, {"number": 3, "encumbrance_m": 0.9}]
    line = LineFile.model_validate(listed_line(support=supports))
    short = line.model_copy(update={"geometry": line.geometry.shorten(2)})
    assert [limit.messenger_wire_height for limit in short.layout.limits] == [1.2, 1.2, 1.0]
    assert len(short.layout.supports) == 1


def test_keys_of_supports_do_not_appear_in_the_stored_form_of_other_lines() -> None:
    """A key with a default in the dump would change the digest of every case."""
    tables = listed_line()
    dumped = LineFile.model_validate(tables).model_dump(mode="json")
    assert not {"support", "gradient", "contact_wire_height_m"} & set(dumped["geometry"])
    assert "contact_wire_height_m" not in dumped["droppers"]


@pytest.mark.parametrize(
    ("geometry", "message"),
    [
        ({"support": [{"number": 5}]}, "geometry.support[1].number: there is no support 5"),
        ({"support": [{"number": 2}, {"number": 2}]}, "geometry.support[2].number: support 2 is listed twice"),
        (
            {"support": [{"number": 4, "steady_arm": {"length_m": 1.0}}]},
            "geometry.support[1].steady_arm (number 4): support 4 is an end of the line",
        ),
        (
            {"support": [{"number": 0, "messenger_support": {"stiffness_N_m": 1e5}}]},
            "geometry.support[1].messenger_support (number 0): support 0 is an end of the line",
        ),
        ({"support": [{"number": 3, "stagger_m": 0.2}]}, "geometry.support[1].stagger_m (number 3): unknown key"),
        ({"support": [{"number": 2, "encumbrance_m": 0.0}]}, "support[1].encumbrance_m (number 2): 0 must be greater"),
        (
            {"support": [{"number": 1, "steady_arm": {"acts": "pul"}}]},
            "geometry.support[1].steady_arm.acts (number 1): found 'pul', expected 'pull' or 'push'",
        ),
        ({"gradient": [{"from_m": 50.0, "to_m": 50.0, "slope": 0}]}, "geometry.gradient[1].to_m: 50 m is not greater"),
        ({"gradient": [{"from_m": 220.0, "to_m": 230.0, "slope": 0}]}, "geometry.gradient[1].from_m: 220 m is not on"),
        (
            {"schedule": {"high": {"x_m": [5.0], "presag_m": [0.0], "contact_wire_height_m": [5.3]}}},
            "geometry.schedule.high.contact_wire_height_m: the height of the contact wire is given twice",
        ),
        (
            {"support": [{"number": 3, "messenger_support": {"along_track": "fixed"}}]},
            "messenger_wire.axial_stiffness_EA_N: support 3 holds the messenger wire along the track",
        ),
    ],
)  # fmt: skip
def test_errors_name_the_key_and_the_support(tmp_path: Path, geometry: dict[str, Any], message: str) -> None:
    assert message in refuse_line(tmp_path, listed_line(**geometry))


# Track of a line file: radial forces, offset from the head, derived values and errors.
CURVE: dict[str, Any] = {"from_m": 0.0, "to_m": 300.0, "radius_m": 600.0}


def track(*curves: dict[str, Any]) -> dict[str, Any]:
    """Keys of a line file on a track with curves, with hinged arms."""
    table = {"contact_wire_height_m": 5.3, "rail_distance_m": 1.5, "curve": list(curves)}
    return {"track": table, "steady_arm.vertical_stiffness_N_m": None, "steady_arm.length_m": 1.0}


def test_curve_loads_the_arms_with_tension_times_angle() -> None:
    """Five spans of 60 m without stagger: 20 kN times 60 / 600 outwards at the inner arms, to 0.1 % by the ends."""
    catenary = build_catenary(changed_line(track(CURVE), 5))
    assert catenary.curves == (TrackCurve(0.0, 300.0, 600.0),)
    force = discretise(catenary, 0.5).state.arm_force[:, 0]
    assert force[1:3] == pytest.approx([-2000.0, -2000.0], rel=1e-3)


@pytest.mark.parametrize(("cant", "offset"), [(0.0, 746.0), (0.1, 353.3)])
def test_offset_counts_from_the_head_on_the_canted_track(cant: float, offset: float, case_250: Case) -> None:
    """Mid-span lies 0.75 m inside, less 5 mm by bending; the head leans 5.3 * 0.1 / 1.5 = 0.353 m to the same side.

    With cant, the supports are farther from the head than mid-span. Strings in the outer spans bow out by 1 mm more.
    """
    whole = CURVE | {"cant_m": cant, "to_m": 600.0}
    line = changed_line(track(whole), 10)
    discretised = discretise(build_catenary(line), 0.5)
    values = compute_static_quantities(replace(case_250, line=line), discretised)
    largest = values["head_offset_mm"]
    assert isinstance(largest, float)
    assert largest == pytest.approx(max(offset, 746.0 - 1e3 * 5.3 * cant / 1.5), abs=3.0)


def test_straight_track_without_stagger_has_no_offset(case_250: Case) -> None:
    """Motion in the vertical plane only: the quantity is not delivered."""
    line = changed_line(track())
    values = compute_static_quantities(replace(case_250, line=line), discretise(build_catenary(line), 2.0))
    assert "head_offset_mm" not in values


def test_derived_values_state_curvature_and_forces() -> None:
    """A curve to the right with transitions; its arms pull to the left."""
    file = changed_line(track(CURVE | {"radius_m": -800.0, "transition_m": 60.0, "to_m": 180.0}))
    derived = build_derived_line(file, discretise(build_catenary(file), 1.0))
    (curve,) = derived.curves
    assert curve.model_dump() == {"from_m": 0.0, "to_m": 180.0, "curvature_1_m": -0.00125, "transition_m": 60.0}
    assert min(derived.steady_arms.lateral_force_N) > 500.0
    assert "track" not in changed_line({}).model_dump()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (track(CURVE), "track.curve[1].to_m: 300 m is not on the line, which ends at 180 m"),
        (track(CURVE | {"to_m": 100.0, "radius_m": 20.0}), "track.curve[1].radius_m: 20 m is too small"),
        (track(CURVE | {"to_m": 100.0, "transition_m": 60.0}), "100 m leaves no room for two transitions of 60 m"),
        (track(CURVE | {"to_m": 90.0}, CURVE | {"from_m": 80.0, "to_m": 100.0}), "80 m lies in the curve that ends"),
        (
            track(CURVE | {"to_m": 90.0})
            | {"messenger_support.along_track": "fixed", "messenger_wire.axial_stiffness_EA_N": 1.4e7},
            "messenger_support.along_track: 'fixed' is not possible on a track with curves",
        ),
    ],
)
def test_impossible_curves_are_refused(changes: dict[str, Any], message: str, tmp_path: Any) -> None:
    """Each problem names its key and what is possible."""
    assert message in refuse_line(tmp_path, changed_tables(changes))


# Model and passage of a line with listed spans and supports: identity with the short form.
LINES = sorted(
    path.relative_to(library_folder()).as_posix()
    for path in library_folder().rglob("*line.toml")
    if path.parent.name != "profiles"
)


def read_forms(name: str) -> tuple[LineFile, LineFile]:
    """A line of the library as published, and with all its spans and supports listed."""
    tables: dict[str, Any] = tomllib.loads((library_folder() / name).read_text("utf-8"))
    listed = list_spans(tables) if "spans" in tables["geometry"] else tables
    return LineFile.model_validate(tables), LineFile.model_validate(list_supports(listed))


@pytest.mark.parametrize("name", LINES)
def test_listed_spans_and_supports_give_the_same_model_bit_by_bit(name: str) -> None:
    """Every position, mass, height and stagger of the model is equal."""
    short, listed = read_forms(name)
    assert build_catenary(listed) == build_catenary(short)


def test_listed_supports_give_the_same_passage_bit_by_bit() -> None:
    """Two pantographs on seven spans: forces, heights and uplifts, to the last bit."""
    case = select_cases(["en50318-2018/ac-simple/275-twin"])[-1]
    changes = {"evaluated_spans": (5, 5), "compared_spans": None, "spacing_m": (60.0,), "run_out_m": 10.0}
    records = []
    for line in read_forms("en50318-2018/ac-simple/line.toml"):
        short = line.model_copy(update={"geometry": line.geometry.shorten(7)})
        shortened = Case(case.file.model_copy(update=changes), short, case.pantographs, ())
        discretised, coarse = discretise(build_catenary(short), 2.0), case.file.discretisation.scale(4.0)
        passage = build_passage(shortened, discretised, coarse, list_start_forces(shortened))
        records.append(record_passage(shortened, passage, simulate_passage(discretised, passage)))
    for name in ("force", "contact_height", "support_uplift"):
        np.testing.assert_array_equal(*(getattr(record, name) for record in records))
