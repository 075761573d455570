"""Prediction of uplift forces in a campaign: pilots, fit, order of the runs, and number of passages."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.cheap_campaign import ThisProcess, compute_row
from helpers.short_cases import shorten_case
from pantocheck.conformance.campaigns.campaign_design import CampaignDesign, ColumnAxis, PlannedRun, RangeAxis
from pantocheck.conformance.campaigns.campaign_driver import Pilots, drive_campaign
from pantocheck.conformance.campaigns.campaign_file import Execution, ValueRange
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.uplift_prediction import choose_pilots, fit_uplift
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.runs import case_run

SPEED = RangeAxis("speed_km_h", ValueRange(start=200.0, stop=209.0, step=1.0))
TENSION = RangeAxis("line.contact_wire.tension_N", ValueRange(start=20000.0, stop=22000.0, step=500.0))
GRID = CampaignDesign(("a", "b"), (SPEED, TENSION), (), (), ("builtin", "record:runs"))


def tuned_row(run: PlannedRun, curvature: float = 0.0) -> RunRow:
    """Row of a run whose uplift forces are linear in speed and tension, but for a curvature over the speed."""
    speed, tension = run.inputs["speed_km_h"] - 200, run.inputs["line.contact_wire.tension_N"] / 1e3
    forces = (100 + 2 * speed - 0.3 * tension + curvature * speed**2, 90 + speed)
    return replace(compute_row(run), balance_forces=forces)


def test_pilots_are_runs_of_the_simulator_that_vary_every_input() -> None:
    """Two inputs: six pilots for each case, on six speeds and more than one tension."""
    pilots = choose_pilots(GRID)
    runs = [run for run in GRID.list_runs() if run.number in pilots]
    for case_id in GRID.case_ids:
        own = [run for run in runs if run.case_id == case_id]
        assert len(own) == 6
        assert {run.system for run in own} == {"builtin"}
        assert len({run.inputs["speed_km_h"] for run in own}) >= 5
        assert len({run.inputs["line.contact_wire.tension_N"] for run in own}) >= 3


def test_short_campaigns_and_inputs_without_order_have_no_pilots() -> None:
    short = CampaignDesign(
        ("a",), (RangeAxis("speed_km_h", ValueRange(start=200, stop=214, step=1)),), (), (), ("builtin",)
    )
    assert not choose_pilots(short)
    named = ColumnAxis(("filter.phase",), (["zero"] * 60,))
    assert not choose_pilots(replace(short, axes=(named,)))
    seeds = ColumnAxis(("speed_km_h", "line.variation.droppers.seed"), ([*range(200, 260)], [*range(60)]))
    assert len(choose_pilots(replace(short, axes=(seeds,)))) == 4


@pytest.mark.parametrize(("curvature", "known"), [(0.0, True), (0.001, True), (0.1, False)])
def test_fit_predicts_linear_forces_and_refuses_curved_ones(curvature: float, known: bool) -> None:
    """A curvature of 1e-3 N per (km/h)^2 is 0.08 N over 9 km/h, one of 0.1 is 8 N, above the limit of 0.2 N."""
    pilots = choose_pilots(GRID)
    prediction = fit_uplift(tuned_row(run, curvature) for run in GRID.list_runs() if run.number in pilots)
    for run in GRID.list_runs():
        found, expected = prediction.predict(run.case_id, run.inputs), tuned_row(run, curvature).balance_forces
        assert bool(found) == known
        if known:
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 if curvature == 0 else 0.1)
    assert fit_uplift(compute_row(run) for run in GRID.list_runs()).predict("a", {}) == ()


class Backwards(ThisProcess):
    """Executor that begins with the last run."""

    def execute_all(self, runs: Iterator[PlannedRun], execute: Callable[[PlannedRun], RunRow]) -> Iterator[RunRow]:  # type: ignore[override]
        return super().execute_all(iter([*runs][::-1]), execute)


def test_rows_depend_neither_on_order_nor_on_interruption(tmp_path: Path) -> None:
    """The rows of other runs state their predicted start, so that another prediction would show."""

    def learn(rows: Iterable[RunRow]) -> Callable[[PlannedRun], RunRow]:
        prediction = fit_uplift(rows)
        return lambda run: replace(tuned_row(run), quantities={"start": prediction.predict(run.case_id, run.inputs)[0]})

    pilots = Pilots(choose_pilots(GRID), learn)
    tables = []
    for name, executor, budgets in (
        ("forward", ThisProcess(), (None,)), ("back", Backwards(), (None,)), ("stopped", ThisProcess(), (1e-9, None)),
    ):  # fmt: skip
        with open_store(tmp_path / name, {}) as store:
            for budget in budgets:
                execution = Execution(time_budget_s=budget)
                drive_campaign(GRID, tuned_row, store, executor, execution, lambda _: None, pilots)
            tables.append([(row.run.number, row.quantities) for row in store.rows()])
    assert tables[0] == tables[1] == tables[2]
    assert len(tables[0]) == GRID.count_runs()
    assert sum("start" not in quantities for _, quantities in tables[0]) == len(pilots.numbers)


def test_run_from_its_balance_needs_one_passage(monkeypatch: pytest.MonkeyPatch) -> None:
    """The start of the case is 3 N off, so that it needs a second passage; both have the mean force to 0.02 N."""
    case = shorten_case(select_cases(["en50318-2018/ac-simple/275"])[-1], 200.0, 0.5, 1)
    line = discretise_line(case.line, case.file.discretisation.element_m)
    steps: list[int] = []
    integrate = case_run.integrate_passage

    def count(*arguments: object) -> object:
        steps.append(1)
        return integrate(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(case_run, "integrate_passage", count)
    tuned = case_run.run_passage(case, line, case.file.discretisation)
    assert len(steps) > 2  # one step that compiles, and the passages
    steps.clear()
    again = case_run.run_passage(case, line, case.file.discretisation, start_forces=tuned.uplift_forces)
    assert len(steps) == 2
    np.testing.assert_array_equal(again.record.force, tuned.record.force)
