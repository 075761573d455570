"""Runs whose passages wait for each other: the results are those of each run alone, and so is a failure."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import pytest

from helpers.core_library import COMPILER
from helpers.short_cases import shorten_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.runs.passages_together import most_together, run_together
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.dynamics import lanes
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE

Run = Callable[[], Record | str]


def run(case: Case) -> Record | str:
    """Record of a case, or the reason why there is none."""
    try:
        record = UnrefinedSimulator().run(case).record
    except SimulationError as error:
        return str(error)
    assert record is not None
    return record


def list_bits(result: Record | str) -> object:
    """Text of a failure, or bits of a record."""
    if isinstance(result, str):
        return result
    return [part.tobytes() for part in (result.time, result.force, result.position, result.support_uplift)]


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    """Six runs on one line, two of them tuned and one that leaves the line, and one on another line."""
    case = shorten_case(select_cases(["en50318-2018/ac-simple/275"])[-1], 200.0, 0.5, 1)
    forces = [{"uplift_force_N": force, "target_mean_force_N": None} for force in (100.0, 120.0, 140.0)]
    pantograph = case.file.pantograph[0]
    given = [case.file.model_copy(update={"pantograph": (pantograph.model_copy(update=keys),)}) for keys in forces]
    speeds = [case.file.model_copy(update={"speed_km_h": speed}) for speed in (190.0, 210.0)]
    outside = given[0].model_copy(update={"run_out_m": 5000.0})
    shorter = case.line.model_copy(update={"geometry": case.line.geometry.shorten(9)})
    other = replace(case, line=shorter, file=case.file.model_copy(update={"evaluated_spans": (5, 7)}))
    cases = [*(replace(case, file=file) for file in (*given, *speeds, outside)), other]
    return [partial(run, case) for case in cases]


@pytest.fixture
def groups(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of passages that were simulated together."""
    found: list[int] = []
    simulate = lanes.simulate_passages

    def count(line: object, passages: list[object]) -> object:
        found.append(len(passages))
        return simulate(line, passages)  # type: ignore[arg-type]

    monkeypatch.setattr(lanes, "simulate_passages", count)
    return found


def test_results_are_those_of_each_run_alone(runs: list[Run], groups: list[int]) -> None:
    alone = [list_bits(run()) for run in runs]
    assert groups == []
    assert [isinstance(result, str) for result in alone] == [False] * 5 + [True, False]
    together = run_together(runs)
    assert [list_bits(result) for result in together] == alone
    assert max(groups) == 6
    assert groups.count(1) > 1  # the other line, and each of six after the failure of one


def test_exception_of_a_function_is_raised(groups: list[int]) -> None:
    """The others end: none waits for it."""
    ended = []

    def fail() -> None:
        raise ZeroDivisionError("no mass")

    with pytest.raises(ZeroDivisionError, match="no mass"):
        run_together([partial(ended.append, 1), fail, partial(ended.append, 3)])
    assert ended == [1, 3]
    assert groups == []


@pytest.mark.skipif(COMPILER is None, reason="a C compiler is needed")
def test_most_together_is_the_number_of_lanes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(CORE_VARIABLE, raising=False)
    assert most_together() in {2, 4, 8}
    for core in ("reference", "fortran"):
        monkeypatch.setenv(CORE_VARIABLE, core)
        assert most_together() == 1
