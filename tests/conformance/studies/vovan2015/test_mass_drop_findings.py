"""What the study measured of its line's modes: met by the updated damping, missed by every model that is broken."""

from dataclasses import replace

import pytest

from helpers.computed_modes import computed_modes, verdicts
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.studies.vovan2015.group_findings import compute_group_findings
from pantocheck.model import Kind, Rayleigh

EVERYTHING = {
    ("modes_in_group", 1),
    ("mode_frequency_Hz", 1),
    ("mode_frequency_Hz", 2),
    ("largest_damping_ratio", None),
    ("damping_decrease_pct", None),
    ("damping_rise_pct", None),
}


def failed(model, change=lambda line: line, spans=6, highest=6.0):
    (case,) = select_cases([f"vovan2015/mass-drop/{model}"])
    modes = computed_modes(change(build_catenary(case.line)), spans, highest)
    rows = verdicts(case, {LINE: compute_group_findings(modes)})
    assert set(rows) == EVERYTHING
    assert all(row.margin is not None or row.verdict == "skip" for row in rows.values())
    return {key for key, row in rows.items() if row.verdict == "fail"}


@pytest.mark.parametrize("model", ["printed", "updated", "updated-modal"])
def test_the_fitted_models_meet_all_of_it(model):
    assert failed(model) == set()


def test_the_initial_model_rises_where_the_measured_damping_does_not():
    assert failed("initial") == {("damping_decrease_pct", None), ("damping_rise_pct", None)}


def scaled(tension):
    """Every wire's tension multiplied: frequencies go with its square root."""
    return lambda line: replace(
        line, wires=tuple(replace(wire, tension=tension * wire.tension) for wire in line.wires)
    )  # fmt: skip


def damped(mass, stiffness):
    both = dict.fromkeys((Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE), Rayleigh(mass, stiffness))
    return lambda line: replace(line, damping=both)


@pytest.mark.parametrize(
    ("change", "caught"),
    [
        (scaled(1.3), {("mode_frequency_Hz", 1)}),  # 0.87 Hz becomes 1.0 Hz
        (damped(0.15, 1e-4), {("largest_damping_ratio", None)}),  # 1.5 % at 0.8 Hz
        (damped(0.001, 1e-4), {("damping_decrease_pct", None), ("damping_rise_pct", None)}),  # nothing but stiffness
        (damped(0.05, 3e-4), {("damping_rise_pct", None)}),
    ],
)
def test_a_broken_model_is_caught_for_its_own_reason(change, caught):
    found = failed("updated", change)
    assert caught <= found
    # Each break is chosen such that what it does not touch still passes.
    assert found - caught <= {("damping_decrease_pct", None)}


def test_a_second_group_out_of_place_is_caught():
    """Tensions four times too high: 1.75 Hz becomes 3.5 Hz."""
    assert {("mode_frequency_Hz", 1), ("mode_frequency_Hz", 2)} <= failed("updated", scaled(4.0), highest=12.0)


def test_a_mode_lost_in_the_first_group_is_caught():
    (case,) = select_cases(["vovan2015/mass-drop/updated"])
    modes = computed_modes(build_catenary(case.line), 6, 6.0)[1:]
    rows = verdicts(case, {LINE: compute_group_findings(modes)})
    assert rows["modes_in_group", 1].verdict == "fail"


def test_too_few_groups_are_not_graded():
    (case,) = select_cases(["vovan2015/mass-drop/updated"])
    rows = verdicts(case, {LINE: compute_group_findings(computed_modes(build_catenary(case.line), 6, 2.0))})
    assert rows["damping_decrease_pct", None].verdict == "skip"
    assert rows["damping_rise_pct", None].verdict == "skip"
