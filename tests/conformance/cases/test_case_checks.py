"""Checks of case, line and pantograph files: the key at fault is named, and values at a bound are accepted."""

import tomllib
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from helpers.case_fixtures import EditedCase
from helpers.toml_edit import change_keys, edit_toml, write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, overlay_limits, read_limits, select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import NamedBound, Rule, SpeedFormula, load_profile, resolve_bounds
from pantocheck.conformance.cases.study_tables import DropperDamping, DropperOscillation, ReleaseVelocity
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.elements.damping import Damping, overlay_damping
from pantocheck.conformance.line.elements.dropper import DropperTable
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import ChainTable, MatricesTable, ModesTable

OWN = {"trust": "primary", "source": "own"}
TUNED = {"model": "pantograph.toml", "target_mean_force_N": 120.0, **OWN}
"""Pantograph without a stated uplift force."""
BAND = {"from_Hz": 1.0, "to_Hz": 2.0, "damping_ratio": 0.1}


def find_fault(path: Path) -> str | None:
    """Key at which the reading of a case stops, in any of its files; None for a valid case."""
    try:
        load_case(path)
    except InputError as error:
        return error.where.rpartition(", key ")[2]
    return None


def find_table_fault(model: type[BaseModel], table: dict[str, Any]) -> str | None:
    """Key at which the check of a table stops; None for a valid table."""
    try:
        model.model_validate(table)
    except ValidationError as error:
        return error.errors()[0]["ctx"]["key"]
    return None


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"pantograph.0.uplift_force_N": None}, "pantograph[1].uplift_force_N"),
        ({"pantograph.0": TUNED}, None),
        ({"pantograph.0": {**TUNED, "uplift_force_N": 100.0}}, None),
        ({"id": "own/../en50318-2002/250"}, "id"),
        ({"id": "own/./250"}, "id"),
        ({"id": "own/.250"}, "id"),
        ({"id": "own/v1.2/250"}, None),
        ({"filter.order": 5}, "filter.order"),
        ({"filter.order": 5, "filter.phase": "causal"}, None),
        ({"filter.order": 4}, None),
        ({"pantograph": []}, "pantograph"),
        ({"evaluated_spans": None}, "evaluated_spans"),
        ({"speed_km_h": None}, "speed_km_h"),
        ({"apparent_mass": {"model": "pantograph.toml", "frequency_Hz": [1.0]}}, "apparent_mass"),
        ({"spacing_m": [100.0]}, "spacing_m"),
        ({"pantograph": [TUNED, TUNED]}, "spacing_m"),
        ({"pantograph": [TUNED, TUNED], "spacing_m": [100.0]}, None),
        ({"pantograph": [TUNED] * 3, "spacing_m": [50.0, 50.0]}, None),
        ({"pantograph": [TUNED] * 3, "spacing_m": [50.0]}, "spacing_m"),
        ({"evaluated_spans": [5]}, None),
        ({"evaluated_spans": [3, 7]}, None),
        ({"evaluated_spans": [5, 6, 7]}, None),
        ({"evaluated_spans": [5, 5]}, "evaluated_spans"),
        ({"evaluated_spans": [6, 5]}, "evaluated_spans"),
        ({"evaluated_spans": [5, 6, 8]}, "evaluated_spans"),
        ({"evaluated_spans": [5, 7, 9]}, "evaluated_spans"),
        ({"evaluated_spans": [0, 5]}, "evaluated_spans"),
        ({"evaluated_spans": None, "evaluated_m": [230.0, 365.0]}, None),
        ({"evaluated_m": [240.0, 360.0]}, "evaluated_m"),
        ({"evaluated_spans": None, "evaluated_m": [240.0, 360.0], "compared_spans": [4, 8]}, "evaluated_m"),
        ({"evaluated_spans": None, "evaluated_m": [360.0, 360.0]}, "evaluated_m"),
        ({"evaluated_spans": None, "evaluated_m": [480.0, 600.5]}, "evaluated_m"),
        ({"evaluated_spans": None, "evaluated_m": [30.0, 160.0]}, "start_m"),
        ({"compared_spans": [5, 6]}, None),
        ({"compared_spans": [4, 8]}, None),
        ({"compared_spans": [6, 8]}, "compared_spans"),
        ({"compared_spans": [4, 5]}, "compared_spans"),
        ({"compared_spans": [0, 6]}, "compared_spans"),
        ({"compared_spans": [3, 10], "run_out_m": 0.0}, "run_out_m"),
        ({"compared_spans": [2, 11]}, "compared_spans"),
        ({"evaluated_spans": [9, 10]}, "run_out_m"),
        ({"evaluated_spans": [10, 11]}, "evaluated_spans"),
        ({"start_m": 239.0}, None),
        ({"start_m": 240.0}, "start_m"),
        ({"compared_spans": [3, 8], "start_m": 120.0}, "start_m"),
        ({"compared_spans": [3, 8], "start_m": 119.0}, None),
        ({"run_out_m": 239.0}, None),
        ({"run_out_m": 240.0}, "run_out_m"),
        ({"limit.0.pantograph": 2}, "limit[1].pantograph"),
        ({"limit.1.quantity": "mean_force_N"}, "limit[2].quantity"),
        ({"limit.0.lower": None, "limit.0.upper": None}, "limit[1]"),
        ({"limit.0.lower": None}, None),
        ({"limit.0.upper": None}, None),
        ({"limit.0.lower": 121.0}, "limit[1].lower"),
        ({"limit.0.lower": 120.0}, None),
        ({"limit.6.pantograph": 1}, "limit[7].pantograph"),
        ({"line": "lines.toml"}, "line"),
        ({"damping": "lines.toml"}, "damping"),
        ({"pantograph.0.model": "lines.toml"}, "pantograph[1].model"),
        ({"provisional": ["sped_km_h"]}, "provisional"),
    ],
)
def test_case_is_checked(changes: dict[str, Any], key: str | None, edited_case: EditedCase) -> None:
    """The line has ten spans of 60 m; the analysis section lies from 240 m to 360 m."""
    assert find_fault(edited_case("250.toml", changes)) == key


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"droppers.stiffness_N_m": None}, "droppers.stiffness_N_m"),
        ({"droppers.axial_stiffness_EA_N": 2e5}, "droppers.stiffness_N_m"),
        ({"droppers.stiffness_N_m": None, "droppers.axial_stiffness_EA_N": 2e5}, None),
        ({"droppers.mass_kg_m": 0.1}, "droppers.mass_kg"),
        ({"droppers.mass_kg_m": 0.1, "droppers.mass_kg": None}, None),
        ({"droppers.mass_kg": None}, None),
        ({"droppers.x_m.1": 5.0}, "droppers.x_m[2]"),
        ({"droppers.x_m.8": 49.5}, "droppers.x_m[9]"),
        ({"droppers.x_m.8": 60.0}, "droppers.x_m[9]"),
        ({"droppers.x_m.8": 59.9}, None),
        ({"droppers.presag_m": None}, None),
        ({"droppers.presag_m": [0.0] * 10}, "droppers.presag_m"),
        ({"droppers.length_m": [1.0] * 8}, "droppers.length_m"),
        ({"droppers.length_m": [1.0] * 9}, None),
        ({"steady_arm.vertical_stiffness_N_m": None}, "steady_arm.vertical_stiffness_N_m"),
        ({"steady_arm.vertical_stiffness_N_m": None, "steady_arm.length_m": 1.0}, None),
        ({"messenger_wire.number": 2}, "messenger_wire.number"),
        ({"messenger_support.along_track": "fixed"}, "messenger_wire.axial_stiffness_EA_N"),
        ({"messenger_support.along_track": "fixed", "messenger_wire.axial_stiffness_EA_N": 13.8e6}, None),
        ({"messenger_wire.axial_stiffness_EA_N": 13.8e6}, None),
        ({"contact_wire.axial_stiffness_EA_N": 16.3e6}, "contact_wire.axial_stiffness_EA_N"),
        ({"contact_wire.number": 2}, None),
        ({"contact_wire.number": 2, "messenger_wire.number": 2}, None),
        ({"damping.modal": [BAND | {"to_Hz": 1.0}]}, "damping.modal[1].from_Hz"),
        ({"damping.modal": [BAND | {"to_Hz": 1.1}]}, None),
        ({"damping.modal": [BAND | {"from_Hz": 2.0, "to_Hz": 3.0}, BAND | {"to_Hz": 2.1}]}, "damping.modal"),
        ({"damping.modal": [BAND | {"from_Hz": 2.0, "to_Hz": 3.0}, BAND]}, None),
    ],
)
def test_line_is_checked(changes: dict[str, Any], key: str | None, edited_case: EditedCase) -> None:
    """Spans of 60 m with nine droppers; two modal bands may touch each other."""
    assert find_fault(edited_case("line.toml", changes)) == key


@pytest.mark.parametrize(
    ("changes", "found", "hint"),
    [
        ({"evaluated_spans": [9, 10]}, "no run_out_m; its default here is 0 m.", "End evaluated_spans and"),
        ({"run_out_m": 240.0}, "600 m long.", "Reduce run_out_m. End evaluated_spans and compared_spans with span 5"),
    ],
)
def test_key_that_is_not_in_the_file_is_named_with_its_default(
    changes: dict[str, Any], found: str, hint: str, edited_case: EditedCase
) -> None:
    with pytest.raises(InputError) as caught:
        load_case(edited_case("250.toml", changes))
    assert found in str(caught.value)
    assert hint in str(caught.value)


@pytest.mark.parametrize("wire", ["contact_wire", "messenger_wire"])
@pytest.mark.parametrize(
    ("name", "smallest", "largest"),
    [("tension_N", 500.0, 200e3), ("mass_kg_m", 0.02, 10.0), ("bending_stiffness_N_m2", 0.0, 1e4)],
)
def test_value_of_a_wire_in_another_unit_is_refused(
    wire: str, name: str, smallest: float, largest: float, edited_case: EditedCase
) -> None:
    key = f"{wire}.{name}"
    for value, fault in ((smallest, None), (largest, None), (0.99 * smallest - 1e-6, key), (1.01 * largest, key)):
        assert find_fault(edited_case("line.toml", {key: value})) == fault


@pytest.mark.parametrize(("length_m", "valid"), [(59.9, True), (60.0, False)])
def test_stitch_wires_do_not_overlap(length_m: float, valid: bool, edited_case: EditedCase) -> None:
    stitch = {"length_m": length_m, "tension_N": 3500.0, "mass_kg_m": 0.3, **OWN}
    path = edited_case("line.toml", {"stitch_wire": stitch})
    assert find_fault(path) == (None if valid else "stitch_wire.length_m")


MODES = {"frequency_Hz": [1.0], "damping_ratio": [0.1], "head_shape": [0.3], **OWN}


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"chain.uplift_force_on": "head"}, None),
        ({"chain.uplift_force_on": "knee"}, "chain.uplift_force_on"),
        ({"chain.uplift_force_on": 1}, None),
        ({"chain.uplift_force_on": 2}, None),
        ({"chain.uplift_force_on": 0}, "chain.uplift_force_on"),
        ({"chain.uplift_force_on": 3}, "chain.uplift_force_on"),
        ({"chain.names": None}, "chain.uplift_force_on"),
        ({"chain.names": None, "chain.uplift_force_on": 1}, None),
        ({"chain.names": ["head"]}, "chain.names"),
        ({"chain.stiffness_N_m": [1.0]}, "chain.stiffness_N_m"),
        ({"chain.damping_N_s_m": [1.0, 2.0, 3.0]}, "chain.damping_N_s_m"),
        ({"chain": None}, "chain"),
        ({"contact.law": "constraint"}, "contact.stiffness_N_m"),
        ({"contact.law": "constraint", "contact.stiffness_N_m": None}, None),
        ({"contact.law": "hertz", "contact.stiffness_N_m": None}, "contact.effective_modulus_N_m2"),
        ({"contact.law": "plastic"}, "contact.law"),
        ({"contact.stiffness_N_m": None}, "contact.stiffness_N_m"),
        ({"contact.damping_N_s_m": 50.0}, None),
        ({"contact.effective_radius_m": 0.02}, "contact.effective_radius_m"),
        ({"modes": MODES}, "modes"),
        ({"chain": None, "modes": MODES}, None),
        ({"chain": None, "modes": MODES | {"head_shape": [0.0]}}, "modes.head_shape"),
    ],
)
def test_pantograph_is_checked(changes: dict[str, Any], key: str | None, edited_case: EditedCase) -> None:
    """A chain of two masses, frame and head."""
    assert find_fault(edited_case("pantograph.toml", changes)) == key


@pytest.mark.parametrize(("on", "index"), [("frame", 0), ("head", 1), (1, 0), (2, 1)])
def test_uplift_force_acts_on_a_mass_by_name_or_number(on: str | int, index: int) -> None:
    chain = {"names": ["frame", "head"], "masses_kg": [15.0, 7.2], "stiffness_N_m": [50.0, 4200.0]}
    table = ChainTable.model_validate(chain | {"damping_N_s_m": [90.0, 10.0], "uplift_force_on": on, **OWN})
    assert table.uplift_mass == index


UNIT = [[1.0, 0.0], [0.0, 1.0]]


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({}, None),
        ({"mass_kg": [[1.0]], "damping_N_s_m": [[0.0]], "stiffness_N_m": [[2.0]], "head": [1.0]}, None),
        ({"head": [0.0, 0.0]}, "head"),
        ({"head": [0.5, 0.0]}, None),
        ({"mass_kg": [[1.0, 0.0]]}, "mass_kg"),
        ({"stiffness_N_m": [[1.0, 0.0], [1.0]]}, "stiffness_N_m"),
        ({"damping_N_s_m": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]}, "damping_N_s_m"),
        ({"damping_N_s_m": [[0.0, 0.0], [0.0, 0.0]]}, None),
        # Symmetric up to a billionth of the largest value.
        ({"stiffness_N_m": [[1e3, 5e-7], [0.0, 1e3]]}, None),
        ({"stiffness_N_m": [[1e3, 3e-6], [0.0, 1e3]]}, "stiffness_N_m"),
        # Rounding may give a lowest eigenvalue of minus a billionth of the largest one.
        ({"stiffness_N_m": [[1e3, 0.0], [0.0, -0.9e-6]]}, None),
        ({"stiffness_N_m": [[1e3, 0.0], [0.0, -1.1e-6]]}, "stiffness_N_m"),
        ({"damping_N_s_m": [[-1.0, 0.0], [0.0, -1.0]]}, "damping_N_s_m"),
        # The mass of every motion is positive.
        ({"mass_kg": [[10.0, 0.0], [0.0, 2e-11]]}, None),
        ({"mass_kg": [[10.0, 0.0], [0.0, 0.9e-11]]}, "mass_kg"),
        ({"mass_kg": [[10.0, 0.0], [0.0, 0.0]]}, "mass_kg"),
    ],
)
def test_matrices_are_those_of_a_pantograph(changes: dict[str, Any], key: str | None) -> None:
    table = {"mass_kg": UNIT, "damping_N_s_m": UNIT, "stiffness_N_m": UNIT, "head": [0.0, 1.0], **OWN} | changes
    assert find_table_fault(MatricesTable, table) == key


@pytest.mark.parametrize("key", ["damping_ratio", "head_shape"])
def test_modes_have_one_value_of_each_kind(key: str) -> None:
    table = {"frequency_Hz": [1.0, 7.0], "damping_ratio": [0.1, 0.2], "head_shape": [0.0, 0.3], **OWN}
    assert find_table_fault(ModesTable, table) is None
    assert find_table_fault(ModesTable, table | {key: [0.1]}) == key


@pytest.mark.parametrize(
    ("x_m", "key"), [([5.0, 10.0, 20.0], None), ([5.0, 20.0, 10.0], "x_m[3]"), ([5.0, 5.0, 10.0], "x_m[2]")]
)
def test_droppers_follow_each_other(x_m: list[float], key: str | None) -> None:
    assert find_table_fault(DropperTable, {"x_m": x_m, "stiffness_N_m": 1e5, **OWN}) == key


RELEASE = {"models": {name: f"{name}.toml" for name in "abcd"}, "test": "d", "windows_s": [[0.0, 1.0]], **OWN}
"""Study of releases."""


@pytest.fixture
def drop_case(tmp_path: Path) -> Path:
    """Copy of a case of mass drops: a line of 378 m, a time step of 2 ms, records of 100 Hz."""
    content = tomllib.loads((library_folder() / "vovan2015" / "mass-drop" / "stand-in.toml").read_text("utf-8"))
    changes = {"line": "vovan2015/line.toml", "damping": None, "mass_drop.compared": None}
    change_keys(content, changes)
    return write_toml(tmp_path / "drop.toml", content)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"mass_drop.drop.1.x_m": 0.0}, "mass_drop.drop[2].x_m"),
        ({"mass_drop.drop.2.x_m": 378.0}, "mass_drop.drop[3].x_m"),
        ({"mass_drop.drop.2.x_m": 377.9}, None),
        ({"mass_drop.drop.2.mass_kg": -1.0}, "mass_drop.drop[3].mass_kg"),
        ({"mass_drop.drop.2.mass_kg": None, "mass_drop.drop.2.mass_kN": 20.0}, "mass_drop.drop[3].mass_kN"),
        ({"mass_drop.drop.1.wire": "MW"}, "mass_drop.drop[2].wire"),
        ({"mass_drop.sensor.0.x_m": 0.0}, "mass_drop.sensor[1].x_m"),
        ({"mass_drop.sensor.1.x_m": 400.0}, "mass_drop.sensor[2].x_m"),
        ({"mass_drop.rate_Hz": 250.0}, None),
        ({"mass_drop.rate_Hz": 500.0}, None),
        ({"mass_drop.rate_Hz": 100.001}, "mass_drop.rate_Hz"),
        ({"mass_drop.rate_Hz": 400.0}, "mass_drop.rate_Hz"),
        ({"mass_drop.rate_Hz": 1000.0}, "mass_drop.rate_Hz"),
        ({"mass_drop.highest_Hz": 40.0}, None),
        ({"mass_drop.highest_Hz": 40.1}, "mass_drop.highest_Hz"),
        ({"mass_drop.compared": {"other": "nowhere.toml"}}, "damping model 'other'"),
        ({"speed_km_h": 250.0}, "mass_drop"),
        ({"study": {"kind": "damping-sensitivity", "models": {"a": "x.toml"}, **OWN}}, "speed_km_h"),
    ],
)
def test_drops_are_checked(changes: dict[str, Any], key: str | None, drop_case: Path) -> None:
    assert find_fault(edit_toml(drop_case, changes)) == key


def test_hint_on_a_frequency_follows_from_the_rate(drop_case: Path) -> None:
    """At most 0.4 of the rate of 100 Hz, or 2.5 times the frequency as the rate."""
    with pytest.raises(InputError, match=r"Give at most 40 Hz, or rate_Hz = 100\.5\."):
        load_case(edit_toml(drop_case, {"mass_drop.highest_Hz": 40.2}))


def test_defaults_of_mass_drops_and_lines(drop_case: Path) -> None:
    """Five seconds at rest, acceleration at 100 Hz without noise, modes up to 10 Hz, release at once."""
    content = tomllib.loads(drop_case.read_text())
    kept = {key: content["mass_drop"][key] for key in ("drop", "sensor", "record_s", "trust", "source")}
    drops = load_case(write_toml(drop_case, content | {"mass_drop": kept})).file.mass_drop
    assert (drops.hanging_s, drops.rate_Hz, drops.quantity) == (5.0, 100.0, "acceleration")
    assert (drops.noise_rms, drops.highest_Hz, drops.drop[0].release_s) == (0.0, 10.0, 0.0)
    # A wire without a stated stiffness is a string, an arm without a stated direction pulls, supports are free.
    content = tomllib.loads((library_folder() / "en50318-2002" / "line.toml").read_text("utf-8"))
    change_keys(content, {"contact_wire.bending_stiffness_N_m2": None})
    line = LineFile.model_validate(content)
    assert (line.contact_wire.bending_stiffness_N_m2, line.contact_wire.number) == (0.0, 1)
    assert (line.steady_arm.acts, line.steady_arm.clamp_kg, line.messenger_support.damping_N_s_m) == ("pull", 0.0, 0.0)
    assert (line.messenger_support.along_track, line.messenger_wire.axial_stiffness_EA_N) == ("free", None)
    assert (line.geometry.stagger_contact_wire_m, line.geometry.stagger_messenger_m) == (0.0, 0.0)


def test_three_pantographs_keep_their_distances_and_a_case_its_defaults(edited_case: EditedCase) -> None:
    """Filter of EN 50318, 0.5 m and 1 ms; the run starts at the end of the first span and runs out over one span."""
    case = load_case(edited_case("250.toml", {"filter": None, "discretisation": None}))
    low_pass = case.file.filter
    assert (low_pass.kind, low_pass.order, low_pass.cutoff_Hz, low_pass.phase) == ("butterworth", 6, 20.0, "zero")
    assert (case.file.discretisation.element_m, case.file.discretisation.time_step_s) == (0.5, 0.001)
    halved = case.file.discretisation.scale(0.5)
    assert (halved.element_m, halved.time_step_s) == (0.25, 0.0005)
    assert (case.start, case.end, case.recorded_section) == (60.0, 420.0, (240.0, 360.0))
    case = load_case(edited_case("250.toml", {"pantograph": [TUNED] * 3, "spacing_m": [30.0, 50.0]}))
    assert case.offsets == (0.0, 30.0, 80.0)
    assert case.start_positions == (140.0, 110.0, 60.0)
    assert [front - case.end for front in case.end_positions] == [80.0, 50.0, 0.0]
    assert case.speed == pytest.approx(250 / 3.6)


@pytest.mark.parametrize(
    ("changes", "start", "end"),
    [
        ({}, 60.0, 420.0),
        ({"start_m": 30.0, "run_out_m": 10.0}, 30.0, 370.0),
        ({"compared_spans": [3, 7]}, 60.0, 480.0),
        # The first pantograph runs to the middle of the last span at most: 570 m, 150 m before the last pantograph.
        ({"compared_spans": [3, 7], "rear_m": 150.0}, 60.0, 420.0),
        ({"rear_m": 180.0}, 60.0, 390.0),
        ({"rear_m": 100.0, "evaluated_spans": [4, 5]}, 60.0, 360.0),
    ],
)
def test_run_stays_on_the_line(changes: dict[str, Any], start: float, end: float, edited_case: EditedCase) -> None:
    """Spans of 60 m on a line of 600 m; the positions are those of the last pantograph."""
    if rear := changes.pop("rear_m", None) if "rear_m" in changes else None:
        changes = changes | {"pantograph": [TUNED, TUNED], "spacing_m": [rear]}
    case = load_case(edited_case("250.toml", changes))
    assert (case.start, case.end) == (start, end)
    front = rear or 0.0
    assert case.start_positions[0] == start + front
    assert case.end_positions[0] == end + front
    assert (case.start_positions[-1], case.end_positions[-1]) == (start, end)


def test_damping_of_a_case_replaces_kinds_of_the_line_and_its_modal_bands(edited_case: EditedCase) -> None:
    """The trust of the result is the lowest of both, as long as a kind of the line remains."""
    stated = {kind: {"mass_coefficient_1_s": b} for kind, b in (("contact_wire", 0.1), ("droppers", 0.2))}
    line = Damping.model_validate(stated | {"modal": [BAND], "trust": "provisional", "source": "a"})
    wire = {"contact_wire": {"mass_coefficient_1_s": 0.3}}
    over = Damping.model_validate(wire | {"trust": "secondary", "source": ["b", "a"]})
    result = overlay_damping(line, over)
    assert (result.contact_wire.mass_coefficient_1_s, result.droppers.mass_coefficient_1_s) == (0.3, 0.2)
    assert (result.modal, result.trust, result.source) == ((), "provisional", ["b", "a"])
    whole = over.model_copy(update={"droppers": over.contact_wire})
    result = overlay_damping(line, Damping.model_validate(whole.model_dump(include={"contact_wire", "droppers", *OWN})))
    assert (result.trust, result.source) == ("secondary", ["b", "a"])
    path = edited_case("250.toml", {"damping": {"droppers": {"mass_coefficient_1_s": 0.7}, **OWN}})
    case = load_case(path)
    assert case.line.damping.droppers.mass_coefficient_1_s == 0.7
    assert case.line.damping.contact_wire.mass_coefficient_1_s == 0.0125


def test_damping_of_a_case_is_read_from_a_file_or_stated_for_a_run(edited_case: EditedCase, case_250: Case) -> None:
    path = edited_case("250.toml", {"damping": "damping.toml"})
    write_toml(path.parent / "damping.toml", {"damping": {"droppers": {"stiffness_coefficient_s": 0.5}, **OWN}})
    assert load_case(path).line.damping.droppers.stiffness_coefficient_s == 0.5
    over = Damping.model_validate({"droppers": {"mass_coefficient_1_s": 0.7}, **OWN})
    case = case_250.with_damping("stiff", over)
    assert (case.id, case.limits, case.file.limit, case.file.study) == ("en50318-2002/250/stiff", (), (), None)
    assert case.line.damping.droppers.mass_coefficient_1_s == 0.7
    assert case_250.line.damping.droppers.mass_coefficient_1_s == 0.0125


@pytest.mark.parametrize(
    ("windows", "key"),
    [
        ([[0.0, 1.0]], None),
        ([[0.0, 1.0], [1.0, 1.0]], "windows_s[2]"),
        ([[0.0, 1.0], [2.0, 1.0]], "windows_s[2]"),
        ([[-0.1, 1.0]], "windows_s[1]"),
    ],
)
def test_windows_of_a_release_are_in_order(windows: list[list[float]], key: str | None) -> None:
    """Studied at the first sensor by default."""
    table = {"kind": "release-velocity"} | RELEASE
    assert find_table_fault(ReleaseVelocity, table | {"windows_s": windows}) == key
    assert ReleaseVelocity.model_validate(table).sensor == 1


@pytest.mark.parametrize(
    ("coefficients", "valid"),
    [([1e-4, 1e-3, 2e-3, 5e-3], True), ([1e-4, 1e-4, 2e-3, 5e-3], False), ([1e-4, 2e-3, 1e-3, 5e-3], False)],
)
def test_coefficients_of_a_study_ascend(coefficients: list[float], valid: bool) -> None:
    table = {"kind": "dropper-damping", "coefficients_s": coefficients, "x_m": 10.0, **OWN}
    with nullcontext() if valid else pytest.raises(ValidationError, match="ascending"):
        assert DropperDamping.model_validate(table).coefficients_s == tuple(coefficients)


def test_coefficients_of_an_oscillation_ascend_from_zero() -> None:
    for coefficients, key in (
        ([0.0, 1e-3, 2e-3], None),
        ([1e-4, 1e-3, 2e-3], "coefficients_s"),
        ([0.0, 2e-3, 1e-3], "coefficients_s"),
    ):
        table = {"kind": "dropper-oscillation", "coefficients_s": coefficients, **OWN}
        assert find_table_fault(DropperOscillation, table) == key


def test_study_of_drops_needs_drops(edited_case: EditedCase) -> None:
    damper = {"damper_N_s_m": 100.0, "bands_Hz": [[0.0, 1.0]], **OWN}
    for kind, table in (("release-velocity", RELEASE), ("steady-arm-damper", damper)):
        assert find_fault(edited_case("250.toml", {"study": {"kind": kind, **table}})) == "mass_drop"


def limits_file(path: Path, *limits: dict[str, Any]) -> Path:
    return write_toml(path, {"limit": [{"quantity": "std_force_N", "upper": 30.0, **OWN} | limit for limit in limits]})


def test_limits_of_a_user_reach_every_case_with_their_pantograph(tmp_path: Path, two_pantograph_case: Case) -> None:
    """A limit of pantograph 2 concerns the case with two pantographs only."""
    (single,) = select_cases(["en50318-2002/300"])
    limits = read_limits(limits_file(tmp_path / "limits.toml", {"pantograph": 2}, {"upper": 29.0}))
    twin, alone = overlay_limits([two_pantograph_case, single], limits)
    targets = {limit.target: limit.upper for limit in twin.limits}
    assert (targets["std_force_N", 1, None], targets["std_force_N", 2, None]) == (29.0, 30.0)
    assert {limit.target: limit.upper for limit in alone.limits}["std_force_N", 1, None] == 29.0
    assert ("std_force_N", 2, None) not in {limit.target for limit in alone.limits}
    with pytest.raises(InputError) as caught:
        overlay_limits([single], limits)
    assert caught.value.where == "limits, key limit[1].pantograph"
    second = read_limits(limits_file(tmp_path / "limits.toml", {}, {"case": "*/999"}))
    with pytest.raises(InputError) as caught:
        overlay_limits([single], second)
    assert caught.value.where == "limits, key limit[2].case"


def test_limit_without_a_pantograph_concerns_every_pantograph(
    tmp_path: Path, two_pantograph_case: Case, edited_case: EditedCase
) -> None:
    """A limit of the case and one of the user: both pantographs have it, and one that names its pantograph remains."""
    both = {("std_force_N", 1, None): 30.0, ("std_force_N", 2, None): 35.0}
    uplift = {"quantity": "max_uplift_at_support_mm", "upper": 90.0, **OWN}
    tables = [
        {"quantity": "std_force_N", "upper": 30.0, **OWN},
        {"quantity": "std_force_N", "upper": 35.0, "pantograph": 2, **OWN},
        {"quantity": "max_force_N", "upper": 250.0, **OWN},
        uplift,
    ]
    path = edited_case("250.toml", {"limit": tables, "pantograph": [TUNED] * 2, "spacing_m": [30.0]})
    expected = both | {("max_force_N", n, None): 250.0 for n in (1, 2)} | {("max_uplift_at_support_mm", 0, None): 90.0}
    assert {limit.target: limit.upper for limit in load_case(path).limits} == expected
    limits = read_limits(limits_file(tmp_path / "limits.toml", {}, {"upper": 35.0, "pantograph": 2}))
    (twin,) = overlay_limits([two_pantograph_case.without_limits()], limits)
    assert {limit.target: limit.upper for limit in twin.limits} == both


def test_owners_and_kinds_of_limits_are_read() -> None:
    def owner(quantity: str, pantograph: int | None = None) -> int:
        table = {"quantity": quantity, "upper": 1.0, **OWN} | ({} if pantograph is None else {"pantograph": pantograph})
        return Limit.model_validate(table).owner

    assert (owner("std_force_N"), owner("std_force_N", 3), owner("max_uplift_at_support_mm")) == (1, 3, 0)
    bounds = {"lower": {"given": "uplift_space_mm"}, "upper": {"per_speed_squared": 0.0, "constant": 1.0}}
    rule = Rule.model_validate(RULE | bounds)
    assert isinstance(rule.lower, NamedBound)
    assert isinstance(rule.upper, SpeedFormula)
    assert Rule.model_validate(rule.model_dump()) == rule
    assert Rule.model_validate(RULE | {"lower": rule.lower}).lower == rule.lower


RULE = {"quantity": "std_force_N", **OWN}


@pytest.mark.parametrize(
    ("rule", "bounds"),
    [
        ({"upper": 30.0}, (None, 30.0)),
        ({"lower": -1.0, "upper": 30.0}, (-1.0, 30.0)),
        ({"lower": 30.0, "upper": 30.0}, (30.0, 30.0)),
        ({"lower": 31.0, "upper": 30.0}, None),
        ({"upper": {"per_speed_squared": 0.001, "constant": 60.0}}, (None, 100.0)),
        ({"lower": {"per_speed_squared": 0.001, "constant": 60.0, "above_km_h": 199.0}}, (100.0, None)),
        ({"upper": {"per_speed_squared": 0.001, "constant": 60.0, "above_km_h": 200.0}}, None),
        ({"upper": {"given": "uplift_space_mm"}}, (None, 120.0)),
        ({"upper": {"given": "uplift_space_mm", "factor": 0.5}}, (None, 60.0)),
        ({"tolerance": 4.0}, (-24.0, -16.0)),
        ({"tolerance_pct": 10.0}, (-22.0, -18.0)),
    ],
)
def test_bounds_of_a_rule(rule: dict[str, Any], bounds: tuple[float | None, float | None] | None) -> None:
    """At 200 km/h, 0.001 v^2 is 40; the record gives a space of 120 mm; the measured record has -20."""
    parsed = Rule.model_validate(RULE | rule)
    if bounds is None:
        with pytest.raises(ValueError, match=r"above"):
            resolve_bounds(parsed, 200.0, {"uplift_space_mm": 120.0}, -20.0)
    else:
        found = resolve_bounds(parsed, 200.0, {"uplift_space_mm": 120.0}, -20.0)
        for value, expected in zip(found, bounds, strict=True):
            assert value == (expected if expected is None else pytest.approx(expected, rel=1e-12))


@pytest.mark.parametrize("rule", [{"tolerance": 4.0}, {"tolerance_pct": 4.0}, {"upper": {"given": "uplift_space_mm"}}])
def test_rule_without_the_value_it_needs_has_no_bound(rule: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"uplift_space_mm|measured record"):
        resolve_bounds(Rule.model_validate(RULE | rule), 200.0, {"uplift_space_mm": None}, None)


@pytest.mark.parametrize(
    "rule",
    [
        {},
        {"upper": 1.0, "tolerance": 1.0},
        {"lower": 1.0, "tolerance_pct": 1.0},
        {"tolerance": 1.0, "tolerance_pct": 1.0},
        {"upper": 1.0, "quantity": "damping_ratio"},
        {"upper": {"given": "span_m"}},
        {"upper": {"constant": 1.0}},
    ],
)
def test_rule_has_one_kind_of_bound(rule: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Rule.model_validate(RULE | rule)


def test_profile_is_found_by_name_or_file(tmp_path: Path) -> None:
    profile = load_profile("acceptance-ac")
    content = tomllib.loads((library_folder() / "profiles" / "acceptance-ac.toml").read_text("utf-8"))
    assert profile == load_profile(str(write_toml(tmp_path / "p.toml", content)))
    assert not profile.compares
    assert load_profile("line-test").compares
    with pytest.raises(InputError, match="Did you mean acceptance-ac"):
        load_profile("acceptance-acc")
