"""The two adapters under `examples/`, run as a user runs them."""

import sys
import sysconfig
from dataclasses import replace
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from helpers.listed_spans import vary_short_line
from helpers.section_lines import section_line
from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.line.elements.point_mass import PointMassTable
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Outcome, Skipped, System
from pantocheck.conformance.runs.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="module")
def short() -> Case:
    """The 250 km/h case on five spans in place of ten."""
    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    return change_case(case, spans=5, evaluated_spans=(3, 4))


@pytest.fixture(scope="module")
def reference(short: Case) -> dict[str, Value]:
    return evaluate(ReferenceSimulator().run_unrefined(short), short)


def evaluate(outcome: Outcome, case: Case) -> dict[str, Value]:
    """Quantities of the pantograph of a delivered record."""
    return evaluate_record(outcome.record, case.file.filter).values[1]


def adapter(name: str) -> System:
    program = f"'{Path(sysconfig.get_path('scripts'), 'pantocheck')}'" if name == "external_program" else ""
    return choose_system(f"command:'{sys.executable}' '{EXAMPLES / name / 'adapter.py'}' {program}", 100.0)


def test_plain_simulator_agrees_with_the_reference_simulator(short: Case, reference: dict[str, Value]) -> None:
    """Two formulations of the same line. Second-order differences at 0.5 m are within a tenth up to 20 Hz."""
    outcome = adapter("string_catenary").run(short)
    values = evaluate(outcome, short)
    assert_allclose(values["mean_force_N"], reference["mean_force_N"], rtol=0.02)
    assert_allclose(values["std_force_N"], reference["std_force_N"], rtol=0.1)
    assert outcome.run.element_m == 0.5


@pytest.mark.parametrize(
    ("name", "mesh", "tolerance"), [("string_catenary", (1.0, 0.002), 0.1), ("external_program", (2.0, 0.004), 1e-9)]
)
def test_examples_run_a_line_with_listed_spans_and_supports(
    short: Case, name: str, mesh: tuple[float, float], tolerance: float
) -> None:
    """Lists by support arrive at the program. The external program is the same, the plain one agrees to a tenth."""
    # HDF5 keeps every digit behind files and pipes. The forces of a force law act on different masses there.
    case = vary_short_line(change_case(short, mesh=mesh))
    if name == "external_program":
        case = apply_force_law(case)
    reference = evaluate(ReferenceSimulator().run_unrefined(case), case)
    values = evaluate(adapter(name).run(case), case)
    names = ("mean_force_N", "std_force_N", "contact_height_range_mm") if name == "string_catenary" else reference
    assert_allclose([values[name] for name in names], [reference[name] for name in names], rtol=tolerance)


def test_external_program_runs_a_line_of_several_sections(short: Case) -> None:
    """The overlap of two sections lies inside the run; the same program gives the same values."""
    case = replace(change_case(short, mesh=(2.0, 0.004), evaluated_spans=(3,)), line=section_line(spans=(4, 4)))
    reference = evaluate(ReferenceSimulator().run_unrefined(case), case)
    values = evaluate(adapter("external_program").run(case), case)
    assert_allclose(values["std_force_N"], reference["std_force_N"], rtol=1e-9)
    skipped = adapter("string_catenary").run(case)
    assert skipped == Skipped("the system does not simulate sections")


def test_plain_simulator_skips_what_it_does_not_know(short: Case) -> None:
    twin = short.line.contact_wire.model_copy(update={"number": 2, "spacing_m": 0.04})
    line = short.line.model_copy(update={"contact_wire": twin})
    system = adapter("string_catenary")
    outcome = system.run(replace(short, line=line))
    assert outcome.reason == "the system does not simulate twin_wires"
    assert (system.name, system.version) == ("string catenary", "1.0")
    # A program that ignored them would compute another line.
    mass = PointMassTable(x_m=150.0, wire="contact_wire", mass_kg=5.0, name="section insulator")
    outcome = adapter("string_catenary").run(replace(short, line=short.line.model_copy(update={"point_mass": (mass,)})))
    assert outcome.reason == "the system does not simulate point_masses"


def apply_force_law(case: Case) -> Case:
    """The case with a force law, and with a base spring of 2 kN/m."""
    law = select_cases(["force-law/300"])[-1]
    chain = law.pantographs[0].chain
    sprung = chain.model_copy(update={"stiffness_N_m": (2000.0, *chain.stiffness_N_m[1:])})
    pantograph = law.pantographs[0].model_copy(update={"chain": sprung})
    return replace(change_case(case, pantograph=law.file.pantograph), pantographs=(pantograph,))


def test_plain_simulator_places_the_applied_forces_of_a_force_law(short: Case) -> None:
    """On one mass in place of two, the frame would be 4 mm higher and the mean force 5 N lower."""
    case = apply_force_law(change_case(short, mesh=(2.0, 0.004)))
    expected = evaluate(ReferenceSimulator().run_unrefined(case), case)
    values = evaluate(adapter("string_catenary").run(case), case)
    assert_allclose(values["mean_force_N"], expected["mean_force_N"], rtol=0.02)
