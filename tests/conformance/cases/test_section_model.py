"""Tension sections in the model: raised wires against closed forms, forces before and after an overlap."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.section_lines import section_line, section_tables
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.model import Catenary, Kind, discretise, simulate_passage
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.string_statics import compute_string_state


def without_dropper_masses(catenary: Catenary) -> Catenary:
    return replace(catenary, droppers=tuple(replace(dropper, mass=0.0) for dropper in catenary.droppers))


LINES = ["en50318-2002", "en50318-2018/ac-simple", "en50318-2018/ac-stitched"]


@pytest.mark.parametrize("name", LINES)
def test_raised_droppers_carry_the_weight_less_the_curvature_of_the_parabola(name: str) -> None:
    """Strings: a parabola with z'' = 2 R / D^2 relieves a dropper by T z'' times its share of the wire; to 1e-6 N."""
    # The wires rise by 0.4 m over the two spans next to the anchors. The masses of the droppers are left out: they
    # follow from lengths that differ with and without the rise.
    raised = section_line(name, overlap={"spans": 3, "anchor_rise_m": 0.4})
    span, end = raised.geometry.longest_span, 6 * raised.geometry.longest_span
    catenary, alone = (without_dropper_masses(build_catenary(line)) for line in (raised, raised.shorten(6)))
    place = np.array([d.position for d in alone.droppers])
    first_section = [n for n, d in enumerate(catenary.droppers) if d.lower.startswith("section 1")]
    tension = compute_string_state(catenary).dropper_tension[first_section]
    difference = compute_string_state(alone).dropper_tension - tension
    x = np.sort(np.append(place, [0.0, end]))
    if raised.steady_arm.static_share == "level":
        x = np.sort(np.append(x, span * np.arange(1, 6)))
    index = np.searchsorted(x, place)
    share = (x[index + 1] - x[index - 1]) / 2
    inside = x[index - 1] >= end - 2 * span
    wire = alone.contact_wires[0].tension
    np.testing.assert_allclose(difference[inside], 2 * 0.4 / (2 * span) ** 2 * wire * share[inside], rtol=0, atol=1e-6)
    np.testing.assert_allclose(difference[x[index + 1] <= end - 2 * span], 0.0, atol=1e-9)
    assert inside.sum() >= 12


def test_raised_messenger_wire_hangs_below_its_chord_by_moment_over_tension() -> None:
    """Strings: under weight and dropper forces the sag below the chord of the supports is M / T; to 1e-9 m."""
    catenary = build_catenary(section_line())
    state = compute_string_state(catenary)
    start, end = 300.0, 360.0  # last span of the first section, from 0.125 m to 0.5 m of rise
    wire = catenary.wire("section 1 messenger wire")
    numbers = [n for n, d in enumerate(catenary.droppers) if d.upper == wire.name and start < d.position < end]
    x = np.array([catenary.droppers[n].position for n in numbers]) - start
    droppers = [catenary.droppers[n] for n in numbers]
    loads = state.dropper_tension[numbers] + GRAVITY * np.array([d.mass / 2 + d.upper_clamp_mass for d in droppers])
    length = end - start
    moment = wire.mass_per_length * GRAVITY * x * (length - x) / 2
    for force, place in zip(loads, x, strict=True):
        moment += force * np.where(x < place, x * (length - place), place * (length - x)) / length
    height = state.dropper_length[numbers] + [d.contact_wire_height or 0.0 for d in droppers]
    chord = 1.2 + 0.125 + (0.5 - 0.125) * x / length
    np.testing.assert_allclose(height, chord - moment / wire.tension, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("spans", [1, 2, 5])
def test_lines_of_the_library_have_an_initial_state_with_any_overlap(name: str, spans: int) -> None:
    """Wires of three sections by name, two rows of contact wires, and every dropper pulls."""
    catenary = build_catenary(section_line(name, (12, 12, 12), {"spans": spans, "anchor_rise_m": 0.3}))
    line = discretise(catenary, 2.0)
    assert [wire.name for wire in catenary.contact_wires] == [f"section {n} contact wire" for n in (1, 2, 3)]
    assert len(line.contact_rows) == 2
    assert line.state.dropper_tension.min() > 10.0
    assert len([wire for wire in catenary.wires if wire.kind is Kind.MESSENGER_WIRE]) == 3


def test_uplift_in_an_overlap_is_that_of_the_lowest_wire(case_250: Case) -> None:
    """Sections from 0 m to 360 m and from 180 m on: the wires cross at 270 m; each support counts once."""
    file = case_250.file.model_copy(update={"evaluated_spans": (3, 8), "start_m": 60.0})
    case = replace(case_250, line=section_line(), file=file)
    line = discretise(build_catenary(case.line), 2.0)
    passage = build_passage(case, line, case.file.discretisation, (120.0,))
    supports = (120.0, 180.0, 240.0, 300.0, 360.0, 420.0, 480.0)
    assert passage.watched == tuple((f"section {1 if x < 270.0 else 2} contact wire", x) for x in supports)


@pytest.mark.parametrize("pantographs", [1, 2])
def test_forces_before_the_overlap_are_equal(case_250: Case, two_pantograph_case: Case, pantographs: int) -> None:
    """To 1e-9 N, the tolerance of a step, until a wave can return from the overlap; more than 10 N in it."""
    # The overlap begins at 180 m. The first head starts at 30 m or 60 m, and waves travel at 122 m/s, at the
    # frequencies of interest at less than 140 m/s. The wires change at 270 m.
    case = {1: case_250, 2: two_pantograph_case}[pantographs]
    keys = {"evaluated_spans": (2, 8), "start_m": 30.0, "spacing_m": (30.0,) if pantographs == 2 else None}
    case = replace(case, file=case.file.model_copy(update=keys))
    forces, lines = [], (section_line(), section_line().shorten(9))
    for line_file in lines:
        on_line = replace(case, line=line_file)
        line = discretise(build_catenary(line_file), 1.0)
        passage = build_passage(on_line, line, case.file.discretisation, (120.0,) * pantographs)
        history = simulate_passage(line, replace(passage, duration=4.0))
        forces.append(history.force)
    reach = 180.0 - history.position[:, 0].max()
    early = history.time < 2 * reach / (140.0 + case.speed)
    difference = np.abs(forces[0] - forces[1])
    assert early.sum() > 300
    assert difference[:, early].max() < 1e-9
    assert difference.max() > 10.0


def test_force_in_an_overlap_converges_with_the_mesh(case_250: Case) -> None:
    """20 Hz force between 180 m and 360 m with half the elements and steps: errors of σ and of the largest force."""
    # Against elements of 0.25 m; those of 1 m are wrong by less than 3 N, and those of 0.5 m by less than half of that.
    file = case_250.file.model_copy(update={"evaluated_spans": (2, 8), "start_m": 60.0})
    case = replace(case_250, line=section_line(), file=file)
    values = []
    for element, step in ((1.0, 2e-3), (0.5, 1e-3), (0.25, 5e-4)):
        line, settings = discretise(build_catenary(case.line), element), Discretisation(time_step_s=step)
        history = simulate_passage(line, replace(build_passage(case, line, settings, (120.0,)), duration=5.0))
        force = case.file.filter(history.force[0], 1 / step)
        part = force[(history.position[0] >= 180.0) & (history.position[0] < 360.0)]
        values.append([part.std(), part.max()])
    coarse, middle = np.abs(np.array(values[:2]) - values[2])
    assert coarse.max() < 3.0
    assert (middle < coarse / 2).all()


def test_sections_have_their_own_wires_and_a_single_one_the_names_of_before() -> None:
    """The second section has a tension of its own and a heavier messenger wire; everything else is that of the line."""
    tables = section_tables()
    tables["section"][1] |= {"contact_wire": {"tension_N": 25e3}, "messenger_wire": {"mass_kg_m": 1.2}}
    catenary = build_catenary(LineFile.model_validate(tables))
    wires = {wire.name: wire for wire in catenary.wires}
    first, second = ({name[10:]: wire for name, wire in wires.items() if name[8] == number} for number in "12")
    assert [first["contact wire"].tension, second["contact wire"].tension] == [20e3, 25e3]
    assert first["contact wire"].mass_per_length == second["contact wire"].mass_per_length == 1.35
    assert [first["messenger wire"].mass_per_length, second["messenger wire"].mass_per_length] == [1.07, 1.2]
    assert first["messenger wire"].tension == second["messenger wire"].tension == 16e3
    # Wires of a file without sections keep their names.
    line = section_line().shorten(9)
    assert [wire.name for wire in build_catenary(line).wires] == ["contact wire", "messenger wire"]


def test_terminations_and_mid_point_anchor_hold_the_messenger_wires() -> None:
    """Rigid at the start of the first section and at its mid-point anchor, the third support: one stretch of 180 m."""
    tables = section_tables()
    tables["messenger_wire"]["axial_stiffness_EA_N"] = 13.8e6
    tables["section"][0] |= {"start": "anchor", "midpoint_anchor": 3}
    tables["section"][1] |= {"midpoint_anchor": 6}
    line = discretise(build_catenary(LineFile.model_validate(tables)), 2.0)
    assert line.stretches.stiffness.tolist() == [13.8e6 / 180.0]
    assert line.stretches.row.tolist() == [[line.mesh.row_of["section 1 messenger wire", "z"]]]
    assert line.mesh.position[line.stretches.first[0]] == 0.0
