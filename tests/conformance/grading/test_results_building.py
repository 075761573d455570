"""Building of results: finite numbers, and owners as text."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.section_lines import section_tables
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.sourced_table import SourcedTable
from pantocheck.conformance.documents.library_check import check_library
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.contact_loss_list import find_force_places, find_uplift_place
from pantocheck.conformance.grading.derived_facts import list_derived_facts, list_input_values
from pantocheck.conformance.grading.results_building import build_results, key_by_owner, select_finite, utc_now
from pantocheck.conformance.grading.source_facts import build_source_facts
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pages.case_section import derived_blocks
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.clock_join import Clock
from pantocheck.conformance.results.case_facts_format import DerivedFact, StoredRange
from pantocheck.conformance.results.results_format import Results, SystemIdentity
from pantocheck.conformance.runs.system import Delivered


def test_numbers_that_are_not_finite_and_empty_owners_are_left_out() -> None:
    """A list with one such number is left out as a whole: its items are graded by their position."""
    values = {
        0: {"dropper_length_m": (1.0, math.nan), "presag_mm": (0.0, 55.0), "wave_speed_m_s": math.inf},
        2: {"mean_force_N": 119.0, "std_force_N": math.nan, "min_force_N": -math.inf},
    }
    assert select_finite(values) == {0: {"presag_mm": [0.0, 55.0]}, 2: {"mean_force_N": 119.0}}
    assert key_by_owner({0: {}, 1: {"mean_force_N": 119.0}, 2: {}}) == {"1": {"mean_force_N": 119.0}}


def test_clock_that_places_a_record_is_stated_in_parts_per_million() -> None:
    """A drift of 2e-4 is 200 ppm; equal up to rounding."""
    clocks = (("mast.csv", "time", Clock(0.5, 0.01, 2e-4, 3e-5)), ("logger.csv", "time", Clock(0.0, 0.02)))
    facts = build_source_facts(SimpleNamespace(place_clocks=clocks, alignments=()), None)  # type: ignore[arg-type]
    assert [source.name for source in facts] == ["mast.csv", "logger.csv"]
    assert (facts[0].drift_ppm, facts[0].drift_uncertainty_ppm) == pytest.approx((200.0, 30.0), rel=1e-12)
    assert (facts[1].uncertainty_s, facts[1].drift_uncertainty_ppm) == (0.02, None)


# Values of inputs in results.json.


class Parts(SourcedTable):
    """Table with every form of a value."""

    one: float
    flag: bool
    few: list[float]
    many: list[float]
    mixed: list[bool | float | str]
    words: list[str]
    parts: list[dict[str, float | str]]


def test_values_of_a_table_are_numbers_ranges_and_texts() -> None:
    """Up to twelve numbers are a list, more a range; a truth value is no number, and twelve texts stand for more."""
    few, words = [float(n) for n in range(12)], [f"word {n}" for n in range(13)]
    parts = [{"height_m": 1.5, "kind": "post", "source": "drawing"}, {"height_m": 1.0, "kind": "post"}]
    table = Parts.model_validate(
        {"one": 3, "flag": True, "few": few, "many": [*few, -4.0], "mixed": [True, 2.5, "rigid"], "words": words}
        | {"parts": parts, "source": "drawing", "trust": "primary"}
    )
    assert list_input_values(table, {"line.one"}, "wire") == {
        "one": 3.0,
        "flag": True,
        "few": few,
        "many": StoredRange(count=13, lowest=-4.0, highest=11.0),
        "mixed": ["True", 2.5, "rigid"],
        "words": words[:12],
        "parts.height_m": [1.5, 1.0],
        "parts.kind": ["post", "post"],
    }
    assert "one" not in list_input_values(table, {"wire.one"}, "wire")


def test_library_case_has_the_values_of_its_files() -> None:
    [case] = select_cases(["en50318-2002/250"])
    groups = {group.group: group.values for group in build_ungraded(case, "skip", "not run").inputs}
    assert groups["case"]["speed_km_h"] == 250
    assert groups["line.contact_wire"]["tension_N"] == 20000
    assert groups["pantograph 1.chain"]["masses_kg"] == [15, 7.2]
    assert groups["line.geometry.encumbrance_m"] == {}
    assert not {"source", "trust", "title", "id"} & {key for values in groups.values() for key in values}


def test_spans_are_listed_up_to_twelve_and_summarised_beyond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Dropper schedules by name keep their names."""
    monkeypatch.chdir(tmp_path)
    for kind in ("line", "pantograph", "case"):
        pantocheck("new", kind)
    text = Path("line.toml").read_text()
    [case] = select_cases(["case.toml"])
    [geometry] = [g.values for g in build_ungraded(case, "skip", "").inputs if g.group == "line.geometry"]
    assert geometry["span_list.length_m"] == [60, 60, 60, 54, 60, 60, 54, 60, 60, 60, 60, 60]
    assert geometry["span_list.droppers"] == ["short", "short"]
    Path("line.toml").write_text(text.replace("span_list = [ ", "span_list = [ { length_m = 65.0 },"))
    [geometry] = [
        g.values for g in build_ungraded(load_case(Path("case.toml")), "skip", "").inputs if g.group == "line.geometry"
    ]
    assert geometry["span_list.length_m"] == StoredRange(count=13, lowest=54, highest=65)


# Places of the extremes: those of the graded force and of the uplift that counts.


RATE, SPEED = 1000.0, 60.0
TIME = np.arange(6000) / RATE
POSITION = SPEED * TIME


def make_signals(section: tuple[float, float]) -> PantographSignals:
    """A peak at 120 m, a dip at 180 m and a higher peak at 300 m; spikes of one sample are above 20 Hz."""
    force = 100 + sum(a * np.exp(-(((POSITION - x) / 5) ** 2)) for a, x in ((50, 120), (-40, 180), (70, 300)))
    force[POSITION == 150.0] += 500
    return PantographSignals(POSITION, ForceChannel(force, RATE, Filter(cutoff_Hz=20.0)), section)


def test_places_of_extremes_are_those_of_the_graded_signals() -> None:
    """The filter is of zero phase: it moves no peak by more than the 60 mm between two samples."""
    places = find_force_places({1: make_signals((60.0, 240.0)), 2: make_signals((60.0, 500.0))})
    assert list(places) == ["1"]  # the second record ends before its section
    assert abs(places["1"]["max_force_N"].position_m - 120) <= 0.06
    assert abs(places["1"]["min_force_N"].position_m - 180) <= 0.06
    # The larger uplift at 120 m occurs when the last pantograph is more than 60 m past it, and does not count.
    uplift = np.array([0.05 * np.exp(-(((TIME - x / SPEED) / 0.1) ** 2)) for x in (60.0, 120.0)])
    uplift[1] *= 0.9
    uplift[1, TIME == 4.0] = 0.2
    line = LineSignals((60.0, 120.0), np.array([60.0, 120.0]), uplift, (0.0, 60.0, 120.0), POSITION)
    place = find_uplift_place(line, TIME)["0"]["max_uplift_at_support_mm"]
    assert (place.position_m, place.time_s) == (60.0, 1.0)
    assert find_uplift_place(LineSignals((60.0, 120.0)), TIME) == {}


# Derived values in results.json: formulas of waves and masses, uplift forces of the run.


def test_values_of_the_2002_reference_model() -> None:
    """Both wires carry 20 and 16 kN and weigh 1.35 and 1.07 kg/m; the chain has 15 and 7.2 kg. Rounding errors only."""
    [case] = select_cases(["en50318-2002/250"])
    values = {fact.name: fact.value for fact in list_derived_facts(case)}
    wave, speed = math.sqrt(20000 / 1.35), 250 / 3.6
    assert values == pytest.approx(
        {
            "Wave speed of the contact wire": wave,
            "Wave speed of the messenger wire": math.sqrt(16000 / 1.07),
            "Doppler factor of the contact wire": (wave - speed) / (wave + speed),
            "Mass per length of all wires": 2.42,
            "First natural frequency of the longest span": math.sqrt(36000 / 2.42) / 120,
            "Mass of pantograph 1": 22.2,
        },
        rel=1e-12,
    )


def test_values_of_twin_wires_and_their_table() -> None:
    [case] = select_cases(["en50318-2002/250"])
    contact = case.line.contact_wire.model_copy(update={"number": 2, "spacing_m": 0.04})
    twin = case.line.model_copy(update={"contact_wire": contact})
    [mass] = [fact.value for fact in list_derived_facts(replace(case, line=twin)) if fact.unit == "kg/m"]
    assert mass == pytest.approx(2 * 1.35 + 1.07, rel=1e-12)
    tables = section_tables(spans=(7, 7, 7))
    tables["section"][2]["contact_wire"] = {"tension_N": 25e3}
    masses = list_derived_facts(replace(case, line=LineFile.model_validate(tables)))
    assert [fact.name[28:] for fact in masses if fact.unit == "kg/m"] == ["", ", section 3"]  # as different wires
    [case] = select_cases(["en50318-2018/ac-simple/static"])
    assert [fact.unit for fact in list_derived_facts(case)] == ["m/s", "m/s", "kg/m", "Hz"]
    fact = {"name": "Uplift force of pantograph 1", "value": 163.456789, "unit": "N", "basis": "tuned"}
    *_, case = select_cases(["en50318-2018/ac-simple/320-twin"])
    result = build_ungraded(case, "skip", "not run")
    table, _ = derived_blocks(result.model_copy(update={"derived": [DerivedFact.model_validate(fact)]}))
    assert table.rows == (("Uplift force of pantograph 1", "163.46", "N", "tuned"),)
    assert derived_blocks(result.model_copy(update={"derived": []})) == ()


def test_uplift_forces_are_those_of_the_run_and_unknown_for_a_foreign_system() -> None:
    *_, case = select_cases(["en50318-2018/ac-simple/320-twin"])
    forces = tuple(150.0 + number / 3 for number in range(len(case.pantographs)))
    result = build_ungraded(case, "error", "not graded", Delivered(uplift_forces=forces))
    stated = {fact.name: fact for fact in result.derived if fact.name.startswith("Uplift force")}
    assert [fact.value for fact in stated.values()] == list(forces)
    for lift, fact in zip(case.lift_forces, stated.values(), strict=True):
        assert fact.basis == f"tuned to a mean contact force of {lift.target_mean_force:g} N"
    foreign = build_ungraded(case, "skip", "not run").derived
    assert not [fact for fact in foreign if fact.name.startswith("Uplift force")]


def test_changed_derived_value_contradicts_the_library() -> None:
    *_, case = select_cases(["en50318-2018/ac-simple/320-twin"])
    system = SystemIdentity(name="example", version="1", kind="record")
    content = build_results([build_ungraded(case, "skip", "not run")], system, "secondary", utc_now()).to_dict()
    [genuine] = check_library(Results.model_validate(content))
    assert genuine.outcome == "proved"
    content["cases"][0]["derived"][0]["value"] *= 1.1
    [changed] = check_library(Results.model_validate(content))
    assert changed.outcome == "contradicted"
    assert "Wave speed of the contact wire" in changed.details[0]
    content["cases"][0]["derived"] = []
    [stripped] = check_library(Results.model_validate(content))
    assert stripped.outcome == "contradicted"
