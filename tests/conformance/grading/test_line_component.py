"""Tolerances of a line as a component of the uncertainty: one run for each of their principal directions."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.short_cases import change_case
from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.line.elements.tolerance import CorrelationTable, ToleranceTable
from pantocheck.conformance.line.line_parameters import list_tolerance_lines
from pantocheck.conformance.pages.criteria_table import describe_criterion
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

CORRELATED = ToleranceTable(
    contact_wire_tension_pct=2.0,
    messenger_wire_tension_pct=1.0,
    correlation=CorrelationTable(
        names=("contact_wire_tension", "messenger_wire_tension"), rows=((1.0, -0.6), (-0.6, 1.0))
    ),
)


def with_tolerance(case: Case, tolerance: ToleranceTable) -> Case:
    return replace(case, line=case.line.model_copy(update={"tolerance": tolerance}))


@pytest.fixture(scope="module")
def case() -> Case:
    return change_case(build_short_case(), mesh=(2.0, 0.004))


@pytest.fixture(scope="module")
def evaluation(case: Case) -> CaseEvaluation:
    tolerant = with_tolerance(case, ToleranceTable(contact_wire_tension_pct=2.0))
    return CaseEvaluation(tolerant, ReferenceSimulator().run(tolerant))


def test_directions_of_the_tolerances_rebuild_their_covariance(case: Case) -> None:
    """Sum over the lines of the squared relative changes of both tensions is the stated covariance: rounding."""
    line = with_tolerance(case, CORRELATED).line
    changes = []
    for changed in list_tolerance_lines(line):
        contact, messenger = (wire.tension for wire in changed.wires)
        changes.append([contact / line.contact_wire.tension_N - 1, messenger / line.messenger_wire.tension_N - 1])
    assert np.array(changes).T @ np.array(changes) == pytest.approx(np.array([[4e-4, -1.2e-4], [-1.2e-4, 1e-4]]))
    assert list_tolerance_lines(case.line) == []


def test_component_is_the_change_by_one_standard_deviation(case: Case, evaluation: CaseEvaluation) -> None:
    """One tolerance: 1.96 times the difference of two runs, here one with the tension 2 % higher."""
    tension = case.line.contact_wire.model_copy(update={"tension_N": 1.02 * case.line.contact_wire.tension_N})
    higher = replace(case, line=case.line.model_copy(update={"contact_wire": tension}))
    other = CaseEvaluation(higher, ReferenceSimulator().run_unrefined(higher)).evaluation.values[1]
    own = evaluation.evaluation.values[1]
    for name in ("std_force_N", "rms_5_20_N"):
        width = evaluation.uncertainty.list_components(1, name)["line"]
        assert width == pytest.approx(1.96 * abs(other[name] - own[name]), rel=1e-4)
        assert width > 0
    assert evaluation.uncertainty.basis["line"].startswith("1 runs on lines one standard deviation away")


def test_joint_sample_contains_the_line(case: Case, evaluation: CaseEvaluation) -> None:
    """The interval of the sample grows as the root of the sum of squares, within the 10 % that 1,000 draws allow."""
    exact = CaseEvaluation(case, replace(evaluation.delivered, changed_lines=()))
    assert exact.uncertainty.basis["line"] == "does not apply: the line file states no tolerances"
    silent = CaseEvaluation(evaluation.case, replace(evaluation.delivered, changed_lines=()))
    assert silent.uncertainty.basis["line"].startswith("not known")
    assert silent.uncertainty.unknown_components[-1] == "line"
    before, after = (np.std(each.uncertainty.sample[1]["std_force_N"]) for each in (exact, evaluation))
    by_line = evaluation.uncertainty.list_components(1, "std_force_N")["line"] / 1.96
    assert after == pytest.approx(np.hypot(before, by_line), rel=0.1)
    assert after > 1.01 * before


def test_criterion_prints_the_line_beside_the_numerics(evaluation: CaseEvaluation) -> None:
    rows = {row.quantity: row for row in evaluation.grade_limits("secondary")}
    criterion = rows["std_force_N"]
    assert criterion.components["line"] > 0
    error = describe_criterion(criterion).error
    assert error.startswith("± ")
    assert error.endswith("(line as measured)")
    assert "(numerics) ± " in error
    without = {name: width for name, width in criterion.components.items() if name != "line"}
    assert "line" not in describe_criterion(criterion.model_copy(update={"components": without})).error
