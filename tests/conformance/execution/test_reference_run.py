"""Reference simulator beside a system under test: its values are added, and no verdict changes."""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal

import pytest

from helpers.command_line import pantocheck
from helpers.short_cases import shorten_case
from pantocheck.conformance.app.commands import run_command as command_module
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.execution import runner
from pantocheck.conformance.execution.runner import add_reference, run_cases
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered


@dataclass(frozen=True)
class Foreign:
    """Another system: the reference simulator with elements and time steps of double length."""

    name: str = "foreign"
    version: str = "7"
    kind: Literal["command"] = "command"

    def run(self, case: Case) -> Delivered:
        file = case.file.model_copy(update={"discretisation": case.file.discretisation.scale(2)})
        return ReferenceSimulator().run_unrefined(replace(case, file=file))


@pytest.fixture(scope="module")
def case() -> Case:
    """One pantograph on ten coarse spans."""
    (whole,) = select_cases(["en50318-2002/250"])
    return shorten_case(whole, 200.0, 0.3, 1)


@pytest.fixture(scope="module")
def both(case: Case) -> tuple[Results, Results]:
    """Results of the foreign system, without and with the reference."""
    alone = run_cases([case], Foreign())
    return alone, add_reference(alone, [case], jobs=1)


def test_values_of_the_reference_are_added_and_nothing_else_changes(both: tuple[Results, Results]) -> None:
    """The other mesh changes the standard deviation by some percent, and the mean by less than 1 N."""
    (result,) = both[1].cases
    assert (result.reference.name, result.reference.reason) == ("Pantocheck reference simulator", None)
    own, reference = result.quantities["1"], result.reference.quantities["1"]
    assert reference["mean_force_N"] == pytest.approx(own["mean_force_N"], abs=1.0)
    assert reference["std_force_N"] != own["std_force_N"]
    assert result.reference.uncertainty["1"]["std_force_N"] > 0
    force, drawn = result.reference.force_20_N["1"], result.traces["1"]
    assert len(force) == len(drawn.position_m)
    difference = max(abs(a - b) for a, b in zip(force, drawn.force_20_N, strict=True))
    assert 0 < difference < 3 * own["std_force_N"]
    alone, beside = both
    without = [case.model_copy(update={"reference": None}) for case in beside.cases]
    assert beside.model_copy(update={"cases": without}) == alone
    assert "reference" not in alone.to_dict()["cases"][0]
    assert find_discrepancies(beside) == find_discrepancies(alone)


def test_force_of_another_section_is_not_drawn(
    both: tuple[Results, Results], case: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A section that only begins later has a force; one that ends before, or begins after, or is empty, has none."""
    [result] = both[0].cases
    trace = result.traces["1"]
    length = trace.position_m[-1] - trace.position_m[0]
    for shift, count, owners in (
        (length / 2, None, {"1"}),
        (length, None, set()),
        (-length, None, set()),
        (0, 0, set()),
    ):
        moved = trace.model_copy(update={"position_m": [x + shift for x in trace.position_m[:count]]})
        reference = both[0].model_copy(update={"cases": [result.model_copy(update={"traces": {"1": moved}})]})
        monkeypatch.setattr(runner, "run_cases", lambda *_, reference=reference: reference)
        [found] = add_reference(both[0], [case], jobs=1).cases
        assert found.reference is not None
        assert found.reference.force_20_N.keys() == owners


def test_reference_states_why_it_did_not_run(both: tuple[Results, Results], case: Case) -> None:
    blocked = replace(case, file=case.file.model_copy(update={"requires": ("own/other",)}))
    (result,) = add_reference(both[0], [blocked], jobs=1).cases
    assert result.reference.reason == "requires own/other, which was not run"
    assert (result.reference.quantities, result.reference.force_20_N) == ({}, {})
    assert result.quantities == both[0].cases[0].quantities
    done = run_command()
    assert done.exit_code == 2
    assert "--with-reference: the system under test is the reference simulator" in done.output


run_command = partial(pantocheck, "run", "en50318-2002/250", "--with-reference")


def test_command_adds_the_reference_to_the_results(
    case: Case, both: tuple[Results, Results], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run of the reference is replaced by its result on the short line, which takes seconds on the whole one."""
    reference = both[1].cases[0].reference
    assert reference is not None
    reference = reference.model_copy(update={"force_20_N": {}})  # a summary has no curve to draw it beside

    def add(results: Results, cases: object, jobs: int, progress: object) -> Results:
        named = [result.model_copy(update={"reference": reference}) for result in results.cases]
        return results.model_copy(update={"cases": named})

    monkeypatch.setattr(command_module, "add_reference", add)
    folder = ["--system", "record:en50318-2002/known-passing-code", "--formats", "json,html", "--out", str(tmp_path)]
    done = run_command(*folder)
    assert done.exit_code == 1, done.output
    (result,) = read_results(tmp_path / "results.json").cases
    assert result.reference == reference
    assert "Reference: values of the Pantocheck reference simulator" in (tmp_path / "certificate.html").read_text()
