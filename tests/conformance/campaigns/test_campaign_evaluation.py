"""Evaluation of a campaign: charts, maps and statistics of known columns, and their report."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.campaign_columns import build_columns
from helpers.cheap_campaign import compute_row, fill_store, speed_design
from pantocheck.conformance.campaigns.campaign_columns import CampaignColumns, EvaluatedValue, leave_out_constant
from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_evaluation import (
    _chart_influences,
    build_sample_charts,
    build_statistics,
    compare_values,
    evaluate_campaign,
    pair_runs,
)
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.campaigns.campaign_run import RunRow, build_failed_row
from pantocheck.conformance.campaigns.campaign_store import open_store, read_store
from pantocheck.conformance.campaigns.input_charts import build_input_charts, build_maps
from pantocheck.conformance.campaigns.run_executors import Execute
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.pages.campaign_page import _join_sources, build_campaign_report
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.study_chart import draw_tornado
from pantocheck.conformance.results.campaign_format import CampaignResults

FRONT, REAR = EvaluatedValue("1.std_force_N", upper=50.0), EvaluatedValue("2.std_force_N", upper=50.0)
GRID = ("speed_km_h", "spacing_m")


@pytest.fixture
def columns() -> CampaignColumns:
    """Three speeds and three spacings of two pantographs; the last run has no value of the rear one."""
    designs = list(itertools.product((200, 250, 300), (85.0, 120.0, 200.0)))
    front = np.array([speed / 6 for speed, _ in designs])
    rear = np.array([speed / 6 + spacing / 20 for speed, spacing in designs])
    rear[-1] = np.nan
    speeds, spacings = zip(*designs, strict=True)
    inputs = {"speed_km_h": speeds, "spacing_m": spacings}
    return build_columns(inputs, {FRONT.column: front, REAR.column: rear})


def test_chart_has_a_curve_per_pantograph_and_other_input_with_the_limit(columns: CampaignColumns) -> None:
    chart, other = build_input_charts(columns, [FRONT, REAR], GRID)
    assert (chart.x_label, other.x_label) == GRID
    labels = [series.label for series in chart.series]
    assert labels[0] == "pantograph 1, spacing_m = 85.0"
    assert labels[-1] == "pantograph 2, spacing_m = 200.0"
    assert chart.series[3].x == [200, 250, 300]
    assert chart.series[3].y == pytest.approx([200 / 6 + 4.25, 250 / 6 + 4.25, 300 / 6 + 4.25])
    assert chart.series[5].x == [200, 250]  # the missing value is left out
    assert [(mark.axis, mark.low) for mark in chart.marks] == [("y", 50.0)]


def test_curve_of_single_runs_has_their_intervals_and_a_mean_has_a_range(columns: CampaignColumns) -> None:
    """Several runs at one speed, here with three spacings that are not told apart, have 5 and 95 % quantiles."""
    columns.widths[FRONT.column] = np.full(9, 1.5)
    chart, _ = build_input_charts(columns, [FRONT, REAR], GRID)
    assert chart.series[0].error == [1.5, 1.5, 1.5]
    assert chart.series[3].error is None
    (mean,) = build_input_charts(columns, [REAR], ["speed_km_h"])
    line, band = mean.series
    rear = columns.values[REAR.column].reshape(3, 3)
    assert line.y == pytest.approx([rear[0].mean(), rear[1].mean(), rear[2, :2].mean()])
    assert band.y[0] == pytest.approx(np.quantile(rear[0], 0.05))
    assert band.high[1] == pytest.approx(np.quantile(rear[1], 0.95))
    assert "5 to 95 % of the runs" in mean.caption


def test_figures_of_many_runs_stay_small() -> None:
    """20,000 runs over 4000 values of one input and 5 of another: curves of 500 points, maps of 40 x 5 cells."""
    speeds, forces = np.meshgrid(np.linspace(200.0, 300.0, 4000), np.linspace(100.0, 104.0, 5))
    inputs = {"speed_km_h": tuple(speeds.ravel().tolist()), "force": tuple(forces.ravel().tolist())}
    numbers = speeds.ravel() / 5 + forces.ravel()
    columns = build_columns(inputs, {FRONT.column: numbers})
    chart, _ = build_input_charts(columns, [FRONT], ("speed_km_h", "force"))
    line, band = chart.series[:2]
    assert len(line.x) == len(band.x) == 500
    # The mean of each interval of 0.2 km/h lies on the straight line of its force.
    assert line.y == pytest.approx(np.array(line.x) / 5 + 100, abs=0.02)
    (value_map,) = build_maps(columns, [FRONT], ("speed_km_h", "force"))
    assert (len(value_map.x), len(value_map.y)) == (40, 5)
    distribution, *_ = build_sample_charts(columns, [FRONT], (), ("speed_km_h", "force"))
    assert len(distribution.series[0].x) == 500
    assert (distribution.series[0].x[-1], distribution.series[0].y[-1]) == (numbers.max(), 1.0)


def test_tornado_has_both_signs_of_every_input_the_largest_first() -> None:
    """A linear value: its changes by one standard deviation are the coefficients times the deviations."""
    inputs = np.random.default_rng(1).standard_normal((50, 2))
    numbers = 100 + inputs @ np.array([1.0, -3.0])
    named = {key: tuple(column.tolist()) for key, column in zip("ab", inputs.T, strict=True)}
    columns = build_columns(named, {FRONT.column: numbers})
    *_, tornado = build_sample_charts(columns, [EvaluatedValue(FRONT.column)], (), ("a", "b"))
    assert tornado.ticks == ["b", "a"]
    larger, smaller = tornado.series
    assert larger.y == pytest.approx([-3 * inputs[:, 1].std(), inputs[:, 0].std()])
    assert smaller.y == pytest.approx([-change for change in larger.y])
    assert draw_tornado(tornado).startswith("<svg")
    # A regression needs more than two runs per input.
    named = {key: tuple(range(9)) for key in "abcd"}
    for runs, charts in ((8, 1), (9, 2)):
        numbers = np.where(np.arange(9) < runs, np.arange(9.0), np.nan)
        columns = build_columns(named, {FRONT.column: numbers})
        assert len(list(build_sample_charts(columns, [EvaluatedValue(FRONT.column)], (), tuple("abcd")))) == charts


def test_influences_need_more_than_twice_as_many_runs_as_inputs(columns: CampaignColumns) -> None:
    for runs, charts in ((4, 0), (5, 1)):
        assert len(list(_chart_influences(columns, FRONT, "", np.arange(runs), GRID))) == charts


def test_map_has_a_cell_per_run_and_many_curves_become_one(columns: CampaignColumns) -> None:
    (value_map,) = build_maps(columns, [REAR], GRID)
    assert value_map.x == [200, 250, 300]
    assert value_map.y == [85, 120, 200]
    assert value_map.values[0] == pytest.approx([200 / 6 + 4.25, 250 / 6 + 4.25, 300 / 6 + 4.25])
    assert value_map.values[2][2] is None
    assert (value_map.lower, value_map.upper) == (None, 50.0)
    # Three values and three spacings are nine curves: each value keeps one.
    values = [EvaluatedValue(FRONT.column), REAR, EvaluatedValue("3.std_force_N")]
    columns.values["3.std_force_N"] = columns.values[FRONT.column]
    chart, _ = build_input_charts(columns, values, GRID)
    assert [series.style for series in chart.series] == ["line", "band"] * 3
    assert [series.label for series in chart.series[::2]] == ["pantograph 1", "pantograph 2", "pantograph 3"]


def test_inputs_share_a_source_and_constant_values_are_not_drawn(columns: CampaignColumns) -> None:
    loss = EvaluatedValue("1.contact_loss_pct")
    columns.values[loss.column] = np.zeros(9)
    tuned = EvaluatedValue("1.mean_force_N")
    columns.values[tuned.column] = 144 + np.linspace(-0.002, 0.002, 9)  # a tuned force differs by its tolerance
    assert leave_out_constant([FRONT, loss, tuned], columns) == [FRONT]
    facts = {"a": "book (secondary)", "b": "assumed (provisional)", "c": "book (secondary)"}
    assert _join_sources(facts) == {"Source 1": "book (secondary): a, c", "Source 2": "assumed (provisional): b"}
    assert _join_sources({"a": "book"}) == {"Source of the varied inputs": "book"}


def test_statistics_of_random_designs_are_those_of_each_point_of_the_grid() -> None:
    """At both speeds 100 runs with the values 1 to 100, and 101 to 200: a limit of 150 is exceeded by 0 and 50 %."""
    numbers = np.arange(1.0, 201.0)
    inputs = {"speed_km_h": (200,) * 100 + (300,) * 100, "tension": tuple(numbers)}
    value = EvaluatedValue("1.mean_force_N", upper=150.0)
    columns = build_columns(inputs, {value.column: numbers})
    low, high = build_statistics(columns, [value], ["speed_km_h"])
    assert (low.group, high.group) == ("speed_km_h = 200", "speed_km_h = 300")
    assert (low.runs, low.mean.value, high.mean.value) == (100, 50.5, 150.5)
    assert low.quantiles == pytest.approx({"5 %": 5.95, "50 %": 50.5, "95 %": 95.05})
    assert (low.exceedance.value, low.exceedance.low, high.exceedance.value) == (0.0, 0.0, 0.5)
    distribution, *convergence = build_sample_charts(columns, [value], ["speed_km_h"], ["tension"])
    assert [series.y[-1] for series in distribution.series] == [1.0, 1.0]
    assert [chart.series[0].y[-1] for chart in convergence] == [0.0, 0.5]
    assert not any(chart.wide for chart in convergence)


def test_report_has_facts_statistics_maps_and_charts(columns: CampaignColumns) -> None:
    counts = {"total": 12, "finished": 10, "failed": 1, "verdicts": {"pass": 6, "fail": 3, "error": 1}}
    drawn = {"charts": build_input_charts(columns, [FRONT, REAR], GRID), "maps": build_maps(columns, [REAR], GRID)}
    results = CampaignResults(
        suite=build_suite(), title="Map <b>", ending="time budget", cases=["a"], systems=["builtin"], **counts,
        inputs={"speed_km_h": "200 to 300, 3 values"}, reasons={"SimulationError: diverged": 1},
        statistics=list(build_statistics(columns, [FRONT], [])), **{key: list(part) for key, part in drawn.items()},
    )  # fmt: skip
    text = render_html(build_campaign_report(results))
    assert "10 of 12 runs are finished, 1 of them failed. It stopped at the end of its time budget." in text
    assert "Map &lt;b&gt;" in text
    assert "1 run: SimulationError: diverged" in text
    assert "pass: 6, fail: 3, error: 1" in text
    assert text.count("<figure") == 3


def evaluate(folder: Path, content: dict[str, object], execute: Execute) -> CampaignResults:
    """Evaluation of a campaign that runs in this process."""
    prepared = prepare_campaign(CampaignFile.model_validate(content), Path())
    with open_store(folder, {}) as store:
        fill_store(store, prepared.design, execute)
        return evaluate_campaign(prepared, store, "complete")


def test_campaign_without_any_result_is_evaluated(tmp_path: Path) -> None:
    """Its report has the reasons and no figure."""
    content = {"cases": ["en50318-2002/250"], "vary": [{"key": "speed_km_h", "values": [200, 210, 220]}]}
    results = evaluate(tmp_path, content, lambda run: build_failed_row(run, "no power", 0.0))
    assert (results.total, results.finished, results.failed) == (3, 3, 3)
    assert results.reasons == {"no power": 3}
    assert (results.charts, results.maps, results.statistics) == ([], [], [])
    assert "3 runs: no power" in render_html(build_campaign_report(results))


def test_runs_that_differ_in_a_seed_have_statistics(tmp_path: Path) -> None:
    """Ten seeds with the forces 1 to 10: their mean is 5.5, and no curve runs over the seed."""
    droppers = "line.variation.droppers"
    seeds = {"key": f"{droppers}.seed", "values": list(range(1, 11)), "trust": "secondary", "source": "draw of 2026"}
    content = {"cases": ["en50318-2002/250"], "set": [f"{droppers}.tolerance_m=0.003"], "vary": [seeds]}

    def deliver(run: PlannedRun) -> RunRow:
        return RunRow(run, {"verdict": "info"}, None, {"1.mean_force_N": float(run.number)}, 0.0)

    results = evaluate(tmp_path, content, deliver)
    (statistics,) = results.statistics
    assert (statistics.runs, statistics.mean.value) == (10, 5.5)
    assert [chart for chart in results.charts if chart.x_label.endswith("seed")] == []
    assert results.sources == {f"{droppers}.seed": "draw of 2026 (secondary)"}
    assert set(results.contacts.values()) == {"contact spring of 50 kN/m (secondary)"}
    assert "contact spring of 50 kN/m (secondary)" in render_html(build_campaign_report(results))


def shift_force(row: RunRow, shift: float, system: str) -> RunRow:
    """The same run on another system, with another mean force."""
    quantities = {name: value + shift for name, value in row.quantities.items()}
    return replace(row, run=replace(row.run, system=system), quantities=quantities)


@pytest.mark.parametrize("system", ["builtin", "command:other"])
def test_comparison_has_the_differences_of_equal_inputs(tmp_path: Path, system: str) -> None:
    """The other campaign lacks run 1; its forces are 2 N smaller, in run 3 by 5 N."""
    mean_force = EvaluatedValue("1.mean_force_N")
    with open_store(tmp_path / "a", {}) as store, open_store(tmp_path / "b", {}) as other:
        for run in speed_design(4).list_runs():
            row = compute_row(run)
            store.add(row)
            if run.number > 1:
                other.add(shift_force(row, -5.0 if run.number == 3 else -2.0, system))
        other.commit()
        with read_store(tmp_path / "b") as opened:
            (comparison,) = compare_values(pair_runs(store, opened, [mean_force]), [mean_force])
    assert (comparison.runs, comparison.place) == (3, "cheap, speed_km_h = 200.2")
    assert comparison.mean == pytest.approx(3)
    assert comparison.rms == pytest.approx((33 / 3) ** 0.5)
    assert comparison.largest == pytest.approx(5)


def test_comparison_without_common_inputs_is_refused(tmp_path: Path) -> None:
    with open_store(tmp_path / "a", {}) as store, open_store(tmp_path / "b", {}) as other:
        store.add(compute_row(next(speed_design(1).list_runs())))
        with pytest.raises(InputError, match="no run has the inputs"):
            pair_runs(store, other, [])
    with pytest.raises(InputError, match=r"has no campaign\.sqlite"), read_store(tmp_path):
        pass
