"""Derived values against closed forms, printed values, the reference simulator and its time step."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from helpers.listed_spans import list_spans
from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.case_run import build_passage, list_start_forces
from pantocheck.conformance.runs.derived_values import Derived, build_derived
from pantocheck.model import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.simulation import start_motion

SECTION = {"evaluated_spans": (2,), "compared_spans": None, "run_out_m": 0.0, "spacing_m": (20.0,)}


def library_case(name: str) -> Case:
    return next(case for case in select_cases([name]) if case.id == name)


def shorten(case: Case, spans: int, **section: object) -> Case:
    """The case on its first spans, with the second as its analysis section."""
    spacing = (20.0,) * (len(case.pantographs) - 1) or None
    return change_case(case, spans, **SECTION | {"spacing_m": spacing} | section)


@cache
def derived(name: str, spans: int = 3) -> Derived:
    return build_derived(shorten(library_case(name), spans))


@pytest.mark.parametrize(
    ("name", "speeds"),
    [
        ("en50318-2002/250", (math.sqrt(20e3 / 1.35), math.sqrt(16e3 / 1.07))),
        ("en50318-2018/ac-simple/320", (math.sqrt(22e3 / 1.35), math.sqrt(16e3 / 1.08))),
    ],
)
def test_wave_speed_is_the_root_of_tension_over_mass(name: str, speeds: tuple[float, float]) -> None:
    """Six digits are given."""
    line = derived(name).line
    assert (line.contact_wire.wave_speed_m_s, line.messenger_wire.wave_speed_m_s) == pytest.approx(speeds, rel=1e-5)


def test_arm_across_its_force_has_the_stiffness_tension_times_angle_over_length() -> None:
    """Wires with equal stagger a and no bending: the droppers hang plumb, and every arm carries 4 a T / span."""
    # The wire turns by the angle 4 a / span at a support; the stiffness is the force over the length of the arm. Arms
    # carry no weight here, so that their force is lateral. Elements of 0.125 m make a kink of a string too stiff by a
    # share of about a quarter of an element over the span, 6e-4.
    case = shorten(library_case("en50318-2018/ac-simple/320"), 4)
    line, geometry = case.line, case.line.geometry.model_copy(update={"stagger_messenger_m": 0.2})
    tables = {
        key: getattr(line, key).model_copy(update={"bending_stiffness_N_m2": 0.0})
        for key in ("contact_wire", "messenger_wire")
    }
    plumb = replace(case, line=line.model_copy(update={"geometry": geometry, **tables}))
    arms = build_derived(plumb).line.steady_arms
    force = 22e3 * 4 * 0.2 / 55
    assert np.abs(arms.lateral_force_N) == pytest.approx(force, rel=1e-3)
    assert arms.transverse_stiffness_N_m == pytest.approx([force / 1.22] * 3, rel=1e-3)
    assert arms.vertical_stiffness_N_m is None


def test_dropper_has_the_stiffness_of_its_section_and_nearly_its_printed_length() -> None:
    droppers = derived("en50318-2018/ac-simple/320").line.droppers
    axial_stiffness = library_case("en50318-2018/ac-simple/320").line.droppers.axial_stiffness_EA_N
    assert np.multiply(droppers.stiffness_N_m, droppers.length_m) == pytest.approx(axial_stiffness, rel=1e-5)
    tension = np.multiply(droppers.vertical_force_N, droppers.length_m) / droppers.height_m
    assert np.multiply(droppers.transverse_stiffness_N_m, droppers.length_m) == pytest.approx(tension, rel=1e-5)
    assert np.hypot(droppers.height_m, droppers.width_m) == pytest.approx(np.array(droppers.length_m), rel=1e-5)
    # Printed lengths are those of strings without stagger; bending adds 4 mm, rounding of the pre-sag 1 mm.
    table = library_case("en50318-2018/ac-simple/320").line.droppers
    assert derived("en50318-2018/ac-simple/320").line.droppers.height_m[1] == pytest.approx(table.length_m, abs=5e-3)


def test_forces_carry_the_wire_and_the_uplift() -> None:
    """Over the middle span of three: droppers and half of both arms carry 60 m of wire, 1.35 kg/m, as all arms do."""
    line = derived("en50318-2002/250").line
    arms = line.steady_arms.vertical_force_N
    carried = sum(line.droppers.vertical_force_N[1]) + sum(arms) / 2
    # Neighbouring spans differ by the anchors, whose bending reaches the support with 1e-5 of the weight.
    assert carried == pytest.approx(60 * 1.35 * line.gravity_m_s2, rel=1e-4)
    # The base spring of 50 N/m is without force at the working height, so it pushes with 50 N/m times it at z = 0.
    (pantograph,) = derived("en50318-2002/250").train.pantographs
    assert pantograph.constant_force == pytest.approx((120 + 50 * pantograph.working_height_m, 0.0), abs=1e-3)
    case = library_case("en50318-2018/ac-simple/static")
    assert build_derived(replace(case, line=shorten(case, 2).line)).train is None


@pytest.mark.parametrize(
    "name", ["en50318-2002/250", "en50318-2018/ac-simple/320-twin", "en50318-2018/ac-stitched/320"]
)
def test_start_is_that_of_the_reference_simulator(name: str) -> None:
    """Heights of all masses and contact forces; elements of 0.5 m leave 0.2 mm of uplifts of 30 to 100 mm."""
    case = shorten(library_case(name), 5)
    values, forces = build_derived(case).train, list_start_forces(case)
    line = discretise(build_catenary(case.line), 0.5)
    passage = build_passage(case, line, case.file.discretisation, forces)
    _, start = start_motion(line, build_kernel_arrays(line, passage.time_step), passage)
    for k, pantograph in enumerate(values.pantographs):
        count = len(pantograph.start_displacement)
        assert start.z[0, k, :count] == pytest.approx(np.array(pantograph.start_displacement), abs=2e-4)
        assert passage.pantographs[k].force == pytest.approx(np.array(pantograph.constant_force), abs=0.02)
        assert start.contact[k].sum() == pytest.approx(pantograph.start_force_N)
        assert passage.start[k] == pantograph.start_m
    assert values.start.place_m == passage.start[-1]
    expected = (passage.speed, passage.duration)
    assert (values.start.speed_m_s, values.start.duration_s) == pytest.approx(expected, rel=1e-5)
    assert not start.z[1].any()


def test_filter_is_rebuilt_from_its_numbers() -> None:
    """Forwards and backwards runs of the Butterworth filter that the numbers describe are the filter of the case."""
    case, values = library_case("en50318-2002/250"), derived("en50318-2002/250").train.evaluation
    signal, rate = np.random.default_rng(1).normal(size=4000), 1 / values.time_step_s
    assert values.filter_passes == 2
    sections = butter(values.filter_pass_order, values.filter_pass_cutoff_Hz, fs=rate, output="sos")
    # The cut-off has six digits.
    assert sosfiltfilt(sections, signal)[500:-500] == pytest.approx(case.file.filter(signal, rate)[500:-500], abs=1e-5)


def test_stitch_and_parallel_wires_share_tension_and_droppers() -> None:
    case, line = library_case("en50318-2018/ac-stitched/320"), derived("en50318-2018/ac-stitched/320").line
    stitch, table = line.stitch_wires, case.line.stitch_wire
    assert stitch.messenger_tension_N + table.tension_N == case.line.messenger_wire.tension_N
    assert np.subtract(stitch.end_m, stitch.start_m) == pytest.approx(table.length_m)
    x, on_stitch = np.array(line.droppers.position_m), np.array(line.droppers.on_stitch_wire)
    distance = np.abs(x[..., None] - np.array(line.steady_arms.position_m)).min(axis=-1)
    assert (on_stitch == (distance < table.length_m / 2)).all()
    # Two wires of half the tension and mass carry half the forces at the same places.
    case = shorten(library_case("en50318-2002/250"), 3)
    half = {"tension_N": 10e3, "mass_kg_m": 0.675, "bending_stiffness_N_m2": 97.5}
    table = case.line.contact_wire.model_copy(update={"number": 2, "spacing_m": 0.04, **half})
    line = build_derived(replace(case, line=case.line.model_copy(update={"contact_wire": table}))).line
    assert line.droppers.contact_wire[0] == (1, 2) * 9
    single = np.repeat(derived("en50318-2002/250").line.droppers.vertical_force_N, 2, axis=1)
    assert np.array(line.droppers.vertical_force_N) == pytest.approx(single / 2, rel=1e-4)


def test_values_of_arms_and_supports_are_lists_where_they_differ() -> None:
    """Support 2 of four spans has its own height, encumbrance, arm and messenger support; all others are alike."""
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    tables["geometry"]["span_list"] = tables["geometry"]["span_list"][:4]
    own = {"contact_wire_height_m": 0.02, "encumbrance_m": 1.1, "messenger_support": {"stiffness_N_m": 2e5}}
    arm = {"vertical_stiffness_N_m": 600.0, "clamp_kg": 0.3, "static_share": "none"}
    tables["geometry"]["support"] = [{"number": 2, "steady_arm": arm} | own]
    case = shorten(library_case("en50318-2002/250"), 4)
    line = build_derived(replace(case, line=LineFile.model_validate(tables))).line
    arms, supports = line.steady_arms, line.messenger_supports
    assert arms.vertical_stiffness_N_m == (300.0, 600.0, 300.0)
    assert (arms.mass_kg, arms.vertical_damper_N_s_m) == ((0.0, 0.3, 0.0), 0.0)
    assert [force > 0 for force in arms.vertical_force_N] == [True, False, True]
    assert supports.height_m == pytest.approx((1.2, 1.12, 1.2))
    assert supports.vertical_stiffness_N_m == (5e4, 2e5, 5e4)
    assert (supports.vertical_damper_N_s_m, supports.held_along_track) == (0.0, False)
    assert line.messenger_wire.height_m == pytest.approx((1.2, 1.2, 1.12, 1.2, 1.2), abs=1e-6)
    rising = [0.02 * x / 60 for x in case.line.droppers.x_m]
    assert line.droppers.contact_wire_height_m[1] == pytest.approx(rising, abs=1e-6)
