"""Track of a line file: radial forces, offset from the head, derived values and errors."""

from dataclasses import replace
from typing import Any

import pytest

from helpers.changed_lines import changed_line, changed_tables
from helpers.toml_edit import write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.derived_line import build_derived_line
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.static_quantities import compute_static_quantities
from pantocheck.model import TrackCurve, discretise

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
    write_toml(tmp_path / "line.toml", changed_tables(changes))
    with pytest.raises(InputError) as error:
        read_model(tmp_path / "line.toml", LineFile, "line")
    assert message in str(error.value)
