"""Round trip of a damping model: simulated drop of a line with slack droppers, identified modes, fitted model."""

import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.damping_results import build_damping_results
from pantocheck.conformance.drops.drop_simulation import simulate_drop
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.line.catenary_model import build_catenary

ELEMENT = 2.25


@pytest.fixture(scope="module")
def short_case() -> Case:
    """The line with three spans and a record of 80 s; after 50 s the messenger wire is uncertain by 20 %."""
    (case,) = select_cases(["vovan2015/mass-drop/printed"])
    mass_drop = case.file.mass_drop
    drop = mass_drop.drop[0].model_copy(update={"x_m": 85.5})
    places = ((0, 78.75), (1, 45.0), (2, 99.0), (3, 141.75))
    sensors = tuple(mass_drop.sensor[i].model_copy(update={"x_m": x}) for i, x in places)
    short = mass_drop.model_copy(update={"record_s": 80.0, "drop": (drop,), "sensor": sensors, "highest_Hz": 5.0})
    steps = case.file.discretisation.model_copy(update={"element_m": ELEMENT, "time_step_s": 0.002})
    file = case.file.model_copy(update={"mass_drop": short, "discretisation": steps})
    geometry = case.line.geometry.model_copy(update={"spans": 3})
    return type(case)(file, case.line.model_copy(update={"geometry": geometry}), (), case.limits)


def test_fitted_coefficients_of_both_wires_are_within_five_percent(short_case: Case) -> None:
    drop = simulate_drop(short_case, 1)
    assert drop.decay.last_slack is not None
    (identification,) = identify_modes((drop.record,), short_case.file.mass_drop.highest_Hz)
    results = build_damping_results(identification.modes, build_catenary(short_case.line), ELEMENT, "the drop")
    fitted = {(coefficient.kind, coefficient.matrix): coefficient.value for coefficient in results.coefficients}
    for kind in ("contact_wire", "messenger_wire"):
        expected = getattr(short_case.line.damping, kind)
        assert_allclose(fitted[kind, "mass"], expected.mass_coefficient_1_s, rtol=0.05)
        assert_allclose(fitted[kind, "stiffness"], expected.stiffness_coefficient_s, rtol=0.05)
