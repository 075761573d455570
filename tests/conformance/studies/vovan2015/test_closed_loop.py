"""Simulate, identify, fit: the damping that is put into a line with slackening droppers comes out again."""

import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.identification.identify import identify_modes
from pantocheck.conformance.simulation.drop_simulation import simulate_drop
from pantocheck.conformance.studies.vovan2015.fit_comparison import fit_identified_damping


@pytest.fixture(scope="module")
def short():
    """The line in three spans, 80 s of one drop: 50 s would leave the messenger's share uncertain by 20 %."""
    (case,) = select_cases(["vovan2015/mass-drop/printed"])
    told = case.file.mass_drop
    drop = told.drop[0].model_copy(update={"x_m": 85.5})
    places = ((0, 78.75), (1, 45.0), (2, 99.0), (3, 141.75))
    sensors = tuple(told.sensor[i].model_copy(update={"x_m": x}) for i, x in places)
    told = told.model_copy(update={"record_s": 80.0, "drop": (drop,), "sensor": sensors, "highest_Hz": 5.0})
    steps = case.file.discretisation.model_copy(update={"element_m": 2.25, "time_step_s": 0.002})
    file = case.file.model_copy(update={"mass_drop": told, "discretisation": steps})
    geometry = case.line.geometry.model_copy(update={"spans": 3})
    return type(case)(file, case.line.model_copy(update={"geometry": geometry}), (), case.limits)


def test_coefficients_of_both_wires_come_out_within_five_percent(short):
    drop = simulate_drop(short, 1)
    assert drop.decay.last_slack is not None
    (found,) = identify_modes((drop.record,), short.file.mass_drop.highest_Hz)
    fitted = {
        (one["kind"], one["matrix"]): one["value"] for one in fit_identified_damping(short, found)["coefficients"]
    }
    damping = short.line.damping
    for kind in ("contact_wire", "messenger_wire"):
        put_in = getattr(damping, kind)
        assert_allclose(fitted[kind, "mass"], put_in.mass_coefficient_1_s, rtol=0.05)
        assert_allclose(fitted[kind, "stiffness"], put_in.stiffness_coefficient_s, rtol=0.05)
