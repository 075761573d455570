"""Design of a campaign: grids, columns, tables, samples, links and conditions, computed by number."""

import time
import tomllib
import tracemalloc
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from helpers.cheap_campaign import speed_design
from pantocheck.conformance.campaigns.campaign_design import PlannedRun
from pantocheck.conformance.campaigns.campaign_file import CampaignFile, check_variation, parse_variation
from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign, prepare_campaign
from pantocheck.conformance.campaigns.distributions import Normal, TruncatedNormal
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import validate_model

CASE = "en50318-2002/250"


def prepare(folder: Path = Path(), **content: Any) -> PreparedCampaign:
    return prepare_campaign(validate_model({"cases": [CASE], **content}, CampaignFile, "campaign"), folder)


def list_runs(folder: Path = Path(), **content: Any) -> list[PlannedRun]:
    return list(prepare(folder, **content).design.list_runs())


def test_ranges_and_tables_of_designs_keep_their_numbers(tmp_path: Path) -> None:
    runs = list_runs(vary=[parse_variation("speed_km_h=250.1:250.5:0.1")])
    assert [run.inputs["speed_km_h"] for run in runs] == [250.1, 250.2, 250.3, 250.4, 250.5]
    assert list_runs(vary=[parse_variation("speed_km_h=200:230:20")])[-1].inputs == {"speed_km_h": 220}
    (tmp_path / "designs.csv").write_text("speed_km_h;filter.phase\n250,5;zero\n260;causal\n")
    runs = list_runs(tmp_path, vary=[{"table": "designs.csv"}])
    expected = [{"speed_km_h": 250.5, "filter.phase": "zero"}, {"speed_km_h": 260, "filter.phase": "causal"}]
    assert [run.inputs for run in runs] == expected
    first, second, other = ([run.inputs for run in sample("random", 10, UNIFORM, seed=seed)] for seed in (3, 3, 4))
    assert first == second != other


def test_grid_varies_the_last_axis_fastest_and_the_system_from_run_to_run(tmp_path: Path) -> None:
    columns = {"filter.cutoff_Hz": [20, 50], "filter.order": [6, 4]}
    runs = list_runs(
        vary=[parse_variation("speed_km_h=200,250"), {"columns": columns}],
        systems=["builtin", f"record:{tmp_path}/{{design}}"],
    )
    assert [run.number for run in runs] == list(range(1, 9))
    assert [tuple(run.inputs.values()) for run in runs[::2]] == [(200, 20, 6), (200, 50, 4), (250, 20, 6), (250, 50, 4)]
    assert runs[5].system == f"record:{tmp_path}/3"


def test_link_follows_and_condition_leaves_designs_out_without_a_change_of_numbers() -> None:
    prepared = prepare(
        vary=[parse_variation("speed_km_h=200:300:50"), parse_variation("line.contact_wire.tension_N=18e3,22e3")],
        link=[{"key": "line.messenger_wire.tension_N", "follows": "line.contact_wire.tension_N", "factor": 0.8}],
        conditions=["speed_km_h <= 250", "line.messenger_wire.tension_N > 15e3"],
    )
    runs = list(prepared.design.list_runs())
    assert [run.number for run in runs] == [2, 4]
    assert runs[0].inputs["line.messenger_wire.tension_N"] == pytest.approx(17600, rel=1e-15)
    assert prepared.design.count_runs() == 2


def sample(method: str, runs: int, *inputs: dict[str, Any], seed: int = 0) -> list[PlannedRun]:
    pairs = zip(("speed_km_h", "start_m", "run_out_m"), inputs, strict=False)
    table = [{"key": key, "distribution": content} for key, content in pairs]
    return list_runs(sampling={"method": method, "runs": runs, "seed": seed, "input": table})


UNIFORM = {"kind": "uniform", "lower": 200.0, "upper": 300.0}


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol"])
def test_stratified_samples_have_one_value_per_stratum(method: str) -> None:
    """Both methods divide the range of every input into as many strata of equal probability as there are runs."""
    runs = sample(method, 64, UNIFORM, {"kind": "normal", "mean": 60.0, "std": 5.0})
    speeds = np.array([run.inputs["speed_km_h"] for run in runs])
    assert sorted((64 * (speeds - 200) / 100).astype(int)) == list(range(64))
    starts = stats.norm.cdf([run.inputs["start_m"] for run in runs], 60.0, 5.0)
    assert sorted((64 * starts).astype(int)) == list(range(64))


def test_truncated_and_discrete_values_follow_their_distribution() -> None:
    """The share of a discrete value deviates from its weight by less than one run in stratified samples."""
    speed = {"kind": "truncated-normal", "mean": 250.0, "std": 20.0, "lower": 240.0, "upper": 280.0}
    runs = sample("latin-hypercube", 1000, speed, {"kind": "discrete", "values": [60.0, 70.0], "weights": [3.0, 1.0]})
    speeds = np.array([run.inputs["speed_km_h"] for run in runs])
    assert 240 <= speeds.min() < 240.1
    assert 279 < speeds.max() <= 280
    # The mean of 1000 strata is within a thousandth of the range of the exact mean.
    assert speeds.mean() == pytest.approx(stats.truncnorm.mean(-0.5, 1.5, 250, 20), abs=0.04)
    assert abs(sum(run.inputs["start_m"] == 60.0 for run in runs) - 750) <= 1


@pytest.mark.parametrize(("lower", "upper"), [(240.0, 280.0), (330.0, 400.0), (-400.0, -290.0)])
def test_truncated_quantiles_are_exact_in_both_tails(lower: float, upper: float) -> None:
    """Bounds on both sides of the mean, and three to ten standard deviations above and below it."""
    probability = np.linspace(0.01, 0.99, 9)
    mean, std = (300.0 if lower > 300 else 260.0) * np.sign(upper), 10.0
    tail = TruncatedNormal(kind="truncated-normal", mean=mean, std=std, lower=lower, upper=upper)
    exact = stats.truncnorm.ppf(probability, (lower - mean) / std, (upper - mean) / std, mean, std)
    assert_allclose(tail.quantiles(probability), exact, rtol=1e-9)


def test_normal_quantiles_rise_and_stay_finite() -> None:
    """97.5 % of the values lie below the mean plus 1.96 standard deviations."""
    values = Normal(kind="normal", mean=10.0, std=2.0).quantiles(np.array([0.025, 0.975, 1.0]))
    assert_allclose(values[:2], [10 - 2 * 1.95996, 10 + 2 * 1.95996], rtol=1e-5)
    assert values[1] < values[2] < np.inf


def test_plan_of_a_hundred_thousand_runs_is_computed_run_by_run() -> None:
    """A list of 20,000 runs would take 6 MB; tracemalloc makes more of them slow."""
    design = speed_design(100_000)
    start = time.perf_counter()
    assert next(design.list_runs()).number == 1
    assert time.perf_counter() - start < 0.1
    tracemalloc.start()
    listed = sum(1 for _ in islice(design.list_runs(), 20_000))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert (listed, design.count_runs()) == (20_000, 100_000)
    assert peak < 100_000


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"vary": [{"key": "speed", "values": [1]}]}, "campaign, key speed: unknown key.\n  Speeds are given"),
        ({"vary": [parse_variation("speed_km_h=1,2"), parse_variation("speed_km_h=3")]}, "is varied twice"),
        ({"vary": [{"columns": {"speed_km_h": [1], "start_m": [1, 2]}}]}, "lists of different length"),
        ({"vary": [{"key": "speed_km_h", "range": {"start": 2, "stop": 1, "step": 1}}]}, "1 is less than start = 2"),
        ({"vary": [{"key": "speed_km_h", "values": [-1, -2]}]}, "key speed_km_h: -1 must be at least 1"),
        ({"conditions": ["speed_km_h < 3"]}, "'speed_km_h' is not a varied input"),
        ({"vary": [parse_variation("speed_km_h=250")], "conditions": ["speed_km_h near 3"]}, "is not a condition"),
        ({"vary": [parse_variation("speed_km_h=250")], "conditions": ["speed_km_h < 3"]}, "no design meets them"),
        ({"link": [{"key": "start_m", "follows": "speed_km_h"}]}, "'speed_km_h' is not a varied input"),
        ({"systems": ["magic"]}, "system 'magic': there is no such system"),
        (
            {"sampling": {"method": "sobol", "runs": 100, "input": [{"key": "speed_km_h", "distribution": UNIFORM}]}},
            "100 is not a power of two.\n  A Sobol sequence is balanced for powers of two, e.g. 64 or 128.",
        ),
    ],
)  # fmt: skip
def test_wrong_campaign_is_refused_before_the_first_run(content: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        list_runs(**content)
    assert message in str(caught.value)


def test_single_invalid_design_is_accepted_and_a_wrong_value_named() -> None:
    """Its run fails, and the row has the reason."""
    assert len(list_runs(vary=[parse_variation("speed_km_h=0,250")])) == 2
    with pytest.raises(InputError) as caught:
        list_runs(vary=[parse_variation("line.contact_wire.tension_N=-1,-2")])
    assert str(caught.value).startswith("line 'line.toml' with line.contact_wire.tension_N = -1 (file: ")


@pytest.mark.parametrize(
    ("text", "values"),
    [("a=1,2.5", [1, 2.5]), ("a=[5, 6],[7, 8]", [[5, 6], [7, 8]]), ("a=zero,causal", ["zero", "causal"])],
)
def test_values_of_the_short_form(text: str, values: list[Any]) -> None:
    assert parse_variation(text) == {"key": "a", "values": values}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("line.dropper.x_m=1,2", "option --vary, key line.dropper.x_m: unknown key.\n  Did you mean line.droppers ?"),
        ("speed=200:300:50", "option --vary, key speed: unknown key.\n  Speeds are given in"),
        ("title=a,b", "option --vary, key title: cannot be changed"),
    ],
)
def test_wrong_key_of_the_short_form_names_its_option(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        check_variation(parse_variation(text))
    assert message in str(caught.value)


def test_campaign_of_the_documentation_is_valid(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "docs" / "campaigns.md").read_text(encoding="utf-8")
    content = tomllib.loads(text.partition("```toml\n")[2].partition("```")[0])
    (tmp_path / "limits.toml").write_text('[[limit]]\ncase = "*"\nquantity = "mean_force_N"\nupper = 200.0\n')
    prepared = prepare(tmp_path, **content)
    assert prepared.design.candidates == 21 * 2 * 64
    assert prepared.design.count_runs() == 17 * 2 * 64
    tension = prepared.design.keys.index("line.messenger_wire.tension_N")
    assert tension == len(prepared.design.keys) - 1
