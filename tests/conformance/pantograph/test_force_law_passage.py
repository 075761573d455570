"""Force laws in a passage: points of application, message to programs, and mean contact force on a short line."""

import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest

from helpers.short_cases import shorten_case
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.lift_force import list_mean_force_rules
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.geometry import ListedSpans
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import MatricesTable, PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.command_system import build_case_message
from pantocheck.conformance.runs.uplift_tuning import TOLERANCE
from pantocheck.model import discretise

PER_UNIT_MASS = 1.0
"""Damping of both wires [1/s]: waves decay within two spans, so that the train of a short line is settled."""


def force_law_case() -> Case:
    (case,) = select_cases(["force-law/300"])
    return case


def short_case(speed_km_h: float, pantographs: int = 1) -> Case:
    return shorten_case(force_law_case(), speed_km_h, PER_UNIT_MASS, pantographs)


def raise_wire(case: Case, slope: float) -> Case:
    """Case on the same line, whose contact wire rises by a slope over its whole length."""
    geometry = case.line.geometry
    tables = geometry.model_dump(exclude={"span_m", "spans", "provisional"}) | {
        "span_list": [{"length_m": length} for length in geometry.span_lengths],
        "gradient": [{"from_m": 0.0, "to_m": geometry.length, "slope": slope}],
    }
    line = LineFile.model_validate(dict(case.line) | {"geometry": ListedSpans.model_validate(tables)})
    return replace(case, line=line)


def mean_forces(case: Case) -> tuple[np.ndarray, tuple[float, ...]]:
    """Mean contact forces over the analysis section, and uplift forces [N]."""
    run = run_passage(case, discretise(build_catenary(case.line), 2.0), case.file.discretisation)
    start, end = case.analysis_section
    record = run.record
    inside = (record.position >= start) & (record.position < end)
    return np.array([force[own].mean() for force, own in zip(record.force, inside, strict=True)]), run.uplift_forces


@pytest.mark.parametrize(("speed", "sum_of_forces"), [(200.0, 108.14), (300.0, 155.81), (400.0, 222.48)])
def test_mean_force_of_a_dsa380_is_the_sum_of_its_applied_forces(speed: float, sum_of_forces: float) -> None:
    """On a settled level line to 0.5 N, the tolerance of the published values; here within 0.25 N."""
    means, uplift = mean_forces(short_case(speed))
    assert uplift == (pytest.approx(sum_of_forces, abs=1e-9),)
    assert abs(means[0] - sum_of_forces) < 0.5


@pytest.mark.parametrize("slope", [-0.004, 0.004])
def test_base_damper_carries_the_rise_of_the_wire(slope: float) -> None:
    """By the balance of momentum, the damper of 70 N s/m takes 19.4 N at 250 km/h off the 129.6 N, or adds it.

    To 0.5 N as on the level line; the base spring of 0.1 N/m changes the force by less than 0.1 N.
    """
    case = raise_wire(short_case(250.0, pantographs=2), slope)
    means, _ = mean_forces(case)
    assert means == pytest.approx(2 * [129.6 - 70.0 * slope * 250 / 3.6], abs=0.5)


def test_second_pantograph_has_a_law_of_its_own() -> None:
    """The first keeps its applied forces, the second is tuned to the rule 0.00097 v^2 + 70 N: 130.625 N at 250 km/h."""
    case = short_case(250.0, pantographs=2)
    ruled = case.pantographs[1].model_copy(update={"force_law": list_mean_force_rules()["acceptance-ac"]})
    means, uplift = mean_forces(replace(case, pantographs=(case.pantographs[0], ruled)))
    assert uplift[0] == pytest.approx(70.0 + 59.6, abs=1e-9)
    assert abs(means[0] - uplift[0]) < 0.5
    assert abs(means[1] - 130.625) <= TOLERANCE


def test_forces_act_on_their_masses() -> None:
    """At the working height all springs are without force: constant forces are the applied forces."""
    (file,), (lift,) = force_law_case().pantographs, force_law_case().lift_forces
    model = build_pantograph(file, lift.uplift_force, 0.0, aerodynamic_force=lift.aerodynamic_force)
    assert model.force == pytest.approx([70.0, 85.81, 0.0], abs=1e-9)
    assert model.static_force == pytest.approx(155.81)


def test_matrices_with_a_law_repeat_the_chain() -> None:
    (file,) = force_law_case().pantographs
    model = build_pantograph(file, 155.81, 0.0, aerodynamic_force=85.81)
    matrices = MatricesTable(
        mass_kg=model.mass.tolist(), damping_N_s_m=model.damping.tolist(), stiffness_N_m=model.stiffness.tolist(),
        head=(0.0, 0.0, 1.0), uplift_force_on=(1.0, 0.0, 0.0), trust="primary", source="own",
    )  # fmt: skip
    content = file.model_dump() | {"chain": None, "matrices": matrices}
    content["force_law"]["aerodynamic_force"]["on"] = (0.0, 1.0, 0.0)
    other = build_pantograph(PantographFile.model_validate(content), 155.81, 0.0, aerodynamic_force=85.81)
    assert other.force == pytest.approx(model.force, abs=1e-12)


def test_program_receives_the_resolved_forces() -> None:
    """Constant forces to six digits: the base spring of 0.1 N/m adds 0.1 N per metre of working height."""
    message = build_case_message(short_case(300.0))
    (pantograph,), (derived,) = message["pantographs"], message["derived"]["train"]["pantographs"]
    assert "force_law" not in pantograph
    assert pantograph["uplift_force_N"] == pytest.approx(155.81)
    assert pantograph["target_mean_force_N"] is None
    assert pantograph["applied_forces"] == {
        "static_force_N": 70.0,
        "aerodynamic_force_N": pytest.approx(85.81),
        "aerodynamic_force_on": 2,
    }
    assert derived["constant_force"] == pytest.approx([70.0, 85.81, 0.0], abs=0.02)
    schema = build_schema("command-request")
    jsonschema.validate(json.loads(json.dumps(message)), {"$ref": "#/$defs/RequestedCase", "$defs": schema["$defs"]})


def test_program_receives_the_mean_force_of_a_rule() -> None:
    case = short_case(300.0)
    ruled = case.pantographs[0].model_copy(update={"force_law": list_mean_force_rules()["acceptance-ac"]})
    (pantograph,) = build_case_message(replace(case, pantographs=(ruled,)))["pantographs"]
    assert (pantograph["uplift_force_N"], pantograph["target_mean_force_N"]) == (None, pytest.approx(157.3))
    assert "applied_forces" not in pantograph
