"""Evaluation of random designs: statistics, distributions, convergence and influences of the inputs."""

import re
from collections.abc import Iterator, Sequence

import numpy as np

from pantocheck.conformance.array_types import IntegerArray, RealArray
from pantocheck.conformance.campaigns.evaluation.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.campaigns.evaluation.input_charts import mark_limit
from pantocheck.conformance.campaigns.evaluation.sample_statistics import (
    linear_influences,
    mean_interval,
    wilson_interval,
)
from pantocheck.conformance.results.campaign_format import Estimate, ValueStatistics
from pantocheck.conformance.results.figure_data import Chart, Series

FEWEST_SAMPLES = 8
"""Fewest runs of a distribution: with fewer, its 5 and 95 % quantiles are the outermost runs."""

QUANTILES = (0.05, 0.5, 0.95)

MOST_DISTRIBUTIONS = 6
"""Largest number of distributions in a chart."""

DISTRIBUTION_POINTS = 500
"""Largest number of points of a distribution."""

CONVERGENCE_POINTS = 50
"""Number of points of a curve against the number of runs."""


def build_statistics(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str]
) -> Iterator[ValueStatistics]:
    """Statistics of each value over the random designs of each point of the grid."""
    for name, numbers in columns.group(grid_keys).items():
        for value in values:
            sample = _select_known(columns.values[value.column][numbers])
            if sample.size >= FEWEST_SAMPLES:
                low, high = mean_interval(sample)
                quantiles = np.quantile(sample, QUANTILES)
                yield ValueStatistics(
                    label=value.title,
                    group=name,
                    runs=sample.size,
                    mean=Estimate(value=float(sample.mean()), low=low, high=high),
                    std=float(sample.std(ddof=1)),
                    quantiles={f"{100 * q:g} %": float(x) for q, x in zip(QUANTILES, quantiles, strict=True)},
                    limit=value.limit,
                    exceedance=None if value.limit is None else estimate_exceedance(_exceed(sample, value)),
                )


def build_sample_charts(
    columns: CampaignColumns,
    values: Sequence[EvaluatedValue],
    grid_keys: Sequence[str],
    sampled_keys: Sequence[str],
) -> Iterator[Chart]:
    """Charts of random designs: distribution of each value, convergence of its exceedance, influence of the inputs."""
    groups = {name: numbers for name, numbers in columns.group(grid_keys).items() if numbers.size >= FEWEST_SAMPLES}
    for value in values:
        samples = {name: _select_known(columns.values[value.column][i]) for name, i in groups.items()}
        shown = dict(list(samples.items())[:MOST_DISTRIBUTIONS])
        if shown:
            yield _chart_distribution(value, shown)
        if value.limit is not None:
            yield from (_chart_convergence(value, name, sample) for name, sample in shown.items())
    keys = [key for key in sampled_keys if columns.is_numeric(key)]
    for name, numbers in list(groups.items())[:MOST_DISTRIBUTIONS]:
        for value in values:
            yield from _chart_influences(columns, value, name, numbers, keys)


def estimate_exceedance(exceeds: RealArray) -> Estimate:
    """Share of runs outside a limit with its interval; `exceeds` is true or false for each run."""
    count, runs = int(np.sum(exceeds)), int(exceeds.size)
    low, high = wilson_interval(count, runs)
    return Estimate(value=count / runs, low=low, high=high)


def _chart_distribution(value: EvaluatedValue, samples: dict[str, RealArray]) -> Chart:
    """Share of the runs below each value."""
    series = []
    for name, sample in samples.items():
        ranks = np.unique(np.linspace(1, sample.size, min(sample.size, DISTRIBUTION_POINTS)).astype(int))
        x, shares = np.sort(sample)[ranks - 1], ranks / sample.size
        series.append(Series(label=name or "runs", style="line", x=x.tolist(), y=shares.tolist()))
    return Chart(
        caption=f"Distribution of {value.title} under the random inputs.",
        alternative=f"Distribution of {value.title}.",
        x_label=value.title,
        y_label="share of runs below [-]",
        series=series,
        marks=mark_limit(value, "x"),
        wide=False,
    )


def _chart_convergence(value: EvaluatedValue, name: str, sample: RealArray) -> Chart:
    """Share of exceedances and its interval against the number of runs."""
    exceeds = _exceed(sample, value)
    runs = np.unique(np.linspace(FEWEST_SAMPLES, sample.size, CONVERGENCE_POINTS).astype(int))
    estimates = [estimate_exceedance(exceeds[:n]) for n in runs]
    group = f" ({name})" if name else ""
    return Chart(
        caption=f"Share of runs whose {value.title} is outside {value.limit}, by number of runs{group}.",
        alternative=f"Convergence of the exceedance of {value.title}{group}.",
        x_label="number of runs",
        y_label="share of exceedances [-]",
        series=[
            Series(label=label, style="line", x=runs.tolist(), y=[getattr(item, part) for item in estimates])
            for label, part in (("estimate", "value"), ("lower end", "low"), ("upper end", "high"))
        ],
        wide=False,
    )


def _chart_influences(
    columns: CampaignColumns, value: EvaluatedValue, name: str, numbers: IntegerArray, keys: Sequence[str]
) -> Iterator[Chart]:
    """Influence of each random input by linear regression, the largest first."""
    output = columns.values[value.column][numbers]
    known = ~np.isnan(output)
    if len(keys) < 2 or known.sum() <= 2 * len(keys):
        return
    inputs = np.column_stack([np.array(columns.inputs[key], float)[numbers][known] for key in keys])
    influences, determination = linear_influences(inputs, output[known])
    order = np.argsort(-np.abs(influences))
    group = f" ({name})" if name else ""
    yield Chart(
        caption=(
            f"Change of {value.title} by one standard deviation of each input{group}, from linear regression, which "
            f"explains {100 * determination:.0f} % of the variance. Seeds are left out."
        ),
        alternative=f"Influences of the inputs on {value.title}{group}.",
        x_label="",
        y_label=f"change of {value.label}",
        ticks=[re.sub("[._]", " ", keys[i]) for i in order],
        series=[
            Series(label=f"{side} input", style="tornado", x=list(map(float, range(len(keys)))), y=changes.tolist())
            for side, changes in (("larger", influences[order]), ("smaller", -influences[order]))
        ],
    )


def _exceed(sample: RealArray, value: EvaluatedValue) -> RealArray:
    lower = -np.inf if value.lower is None else value.lower
    upper = np.inf if value.upper is None else value.upper
    return np.asarray((sample < lower) | (sample > upper), float)


def _select_known(values: RealArray) -> RealArray:
    return values[~np.isnan(values)]
