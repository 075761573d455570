"""Null models and variants of the damping study: what they change, and what they leave."""

import numpy as np

from pantocheck.conformance.cases.library import select_cases
from verification.tables.null_model import MASS_1_S, STIFFNESS_S, count_reproduced, draw_damping, replace_damping
from verification.tables.table_scenarios import CHOSEN, build_case, change_contact, change_head, change_initial_damping
from verification.tables.table_sensitivity import list_variants


def test_draws_are_repeatable_and_inside_the_prior() -> None:
    drawn = list(draw_damping(20))
    assert drawn == list(draw_damping(20))
    wires = [damping.contact_wire for damping in drawn]
    for values, (low, high) in (
        ([wire.mass_coefficient_1_s for wire in wires], MASS_1_S),
        ([wire.stiffness_coefficient_s for wire in wires], STIFFNESS_S),
    ):
        assert low <= min(values) < max(values) <= high
        assert np.std(np.log(values)) > 0.2 * np.log(high / low)  # 0.29 for a uniform logarithm


def test_null_model_keeps_the_reference_and_the_droppers_of_the_line() -> None:
    (damping,) = draw_damping(1)
    for case in select_cases(["vovan2015/*"]):
        changed = replace_damping(case, damping)
        assert changed.line.damping.contact_wire == damping.contact_wire
        assert changed.line.damping.droppers == case.line.damping.droppers
        for name, model in changed.dampings.items():
            assert model == (case.dampings[name] if name == "initial" else damping)
        assert changed.limits == case.limits
    assert count_reproduced({"a": "reproduced", "b": "not_reproduced", "c": "reproduced"}) == 2


def test_variants_change_one_assumption() -> None:
    names = [variant.name for variant in list_variants()]
    assert len(set(names)) == len(names)
    assert sum(name.startswith("initial damping") for name in names) == 10
    case = build_case(CHOSEN)
    assert {file.contact.stiffness_N_m for file in change_contact(2e4)(case).pantographs} == {2e4}
    (front, _) = change_head(0.5)(case).pantographs
    assert front.chain.masses_kg == (6.0, 9.0, 3.75)
    initial = change_initial_damping(droppers=(0.0, 3e-3))(case).dampings["initial"]
    assert initial.droppers.stiffness_coefficient_s == 3e-3
    assert initial.contact_wire == case.dampings["initial"].contact_wire
