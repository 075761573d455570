"""Derived values in results.json: formulas of waves and masses, uplift forces of the run."""

import math
from dataclasses import replace

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.documents.library_check import check_library
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.derived_facts import list_derived_facts
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.pages.case_section import derived_blocks
from pantocheck.conformance.results.case_facts_format import DerivedFact
from pantocheck.conformance.results.results_format import Results, SystemIdentity
from pantocheck.conformance.runs.system import Delivered


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
