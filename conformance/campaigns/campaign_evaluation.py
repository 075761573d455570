"""Evaluation of a campaign: from the rows of its store to campaign.json."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.campaigns.campaign_columns import (
    CampaignColumns,
    EvaluatedValue,
    choose_values,
    count_reasons,
    leave_out_constant,
    read_columns,
)
from pantocheck.conformance.campaigns.campaign_design import DesignAxis, SampleAxis
from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.campaigns.input_charts import MOST_MAPS, build_input_charts, build_maps, mark_limit
from pantocheck.conformance.campaigns.sample_statistics import (
    build_indices,
    linear_influences,
    mean_interval,
    select_independent,
    wilson_interval,
)
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import NO_SOURCE, SourcedTable
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.quantities.limit_text import format_input_number
from pantocheck.conformance.results.campaign_format import (
    CampaignEnding,
    CampaignResults,
    Estimate,
    ValueComparison,
    ValueStatistics,
)


@dataclass(frozen=True)
class RunPair:
    """Values of two runs with equal inputs."""

    place: str
    """Case and inputs in words."""
    values: dict[str, float]
    other_values: dict[str, float]
    """Quantities of this campaign and of the other one, by column."""


def pair_runs(store: CampaignStore, other: CampaignStore, values: Sequence[EvaluatedValue]) -> list[RunPair]:
    """Pair the finished runs of two campaigns that have the same case, inputs and system, with some of their values.

    The system does not count if the campaigns have no system in common: then their systems are compared.

    Raises:
        InputError: No run of one campaign has the inputs of a run of the other.
    """
    systems = [{row.run.system for row in each.rows()} for each in (store, other)]
    with_system = bool(systems[0] & systems[1])
    columns = [value.column for value in values]
    others = {key: quantities for key, _, quantities in _list_runs(other, with_system, columns)}
    pairs = [
        RunPair(place, quantities, others[key])
        for key, place, quantities in _list_runs(store, with_system, columns)
        if key in others
    ]
    if not pairs:
        hint = "Compare campaigns of the same cases with equal inputs."
        raise InputError("option --compare", "no run has the inputs of a run of the other campaign", hint)
    return pairs


def compare_values(pairs: Sequence[RunPair], values: Sequence[EvaluatedValue]) -> Iterator[ValueComparison]:
    """Differences of each value, this campaign minus the other one."""
    for value in values:
        common = [pair for pair in pairs if value.column in pair.values and value.column in pair.other_values]
        if common:
            difference = np.array([pair.values[value.column] - pair.other_values[value.column] for pair in common])
            largest = int(np.argmax(np.abs(difference)))
            yield ValueComparison(
                label=value.title,
                runs=len(common),
                mean=float(difference.mean()),
                rms=float(np.sqrt(np.mean(difference**2))),
                largest=float(difference[largest]),
                place=common[largest].place,
            )


def _list_runs(
    store: CampaignStore, with_system: bool, columns: Sequence[str]
) -> Iterator[tuple[str, str, dict[str, float]]]:
    """Key, place in words and some quantities of the runs that have a result."""
    for row in store.rows():
        if row.quantities:
            run = row.run
            key = json.dumps([run.case_id, run.system if with_system else None, run.inputs], sort_keys=True)
            place = ", ".join([run.case_id, *(f"{name} = {value}" for name, value in run.inputs.items())])
            yield key, place, {name: row.quantities[name] for name in columns if name in row.quantities}


SEED = ".seed"
"""End of the keys of seeds. Their values have no order: runs that differ in them are random designs."""


def evaluate_campaign(
    prepared: PreparedCampaign, store: CampaignStore, ending: CampaignEnding, pairs: Sequence[RunPair] = ()
) -> CampaignResults:
    """Evaluate the finished runs of a campaign, alone and in pairs with those of another campaign."""
    design = prepared.design
    varied = [key for axis in design.axes if not isinstance(axis, SampleAxis) for key in axis.keys]
    grid = [key for key in varied if not key.endswith(SEED)]
    sampled = [key for axis in design.axes if isinstance(axis, SampleAxis) for key in axis.ordered_keys]
    values = choose_values(store, prepared.limits)
    columns = read_columns(store, values, design.keys)
    charted = leave_out_constant(values, columns)
    saltelli = [axis for axis in design.axes if isinstance(axis, SampleAxis) and axis.sampling.method == "saltelli"]
    independent = select_independent(columns, saltelli[0]) if saltelli else columns
    inputs = {key: _describe_axis(axis, key) for axis in design.axes for key in axis.keys}
    for link in design.links:
        inputs[link.key] = f"{format_input_number(link.factor)} x {link.follows} + {format_input_number(link.offset)}"
    maps = list(build_maps(columns, charted, grid))
    verdicts, reasons = count_reasons(store)
    finished, failed = store.count()
    return CampaignResults(
        suite=build_suite(),
        title=prepared.file.title,
        ending=ending,
        cases=list(design.case_ids),
        systems=list(design.systems),
        inputs=inputs,
        sources=dict(_list_sources(prepared)),
        contacts=prepared.contacts,
        total=design.count_runs(),
        finished=finished,
        failed=failed,
        verdicts=verdicts,
        reasons=reasons,
        charts=[
            *build_input_charts(columns, charted, grid),
            *build_sample_charts(independent, charted, grid, sampled),
        ],
        maps=maps[:MOST_MAPS],
        omitted_maps=len(maps[MOST_MAPS:]),
        indices=[item for axis in saltelli for item in build_indices(columns, charted, grid, axis)],
        comparison=list(compare_values(pairs, values)),
        statistics=list(build_statistics(independent, values, grid)),
    )


def _list_sources(prepared: PreparedCampaign) -> Iterator[tuple[str, str]]:
    """Cases from outside, and varied inputs whose source is stated, with their source."""
    for case_id, origin in prepared.origins.items():
        yield case_id, f"{origin.text}, {origin.digest}, stated by its author"
    file = prepared.file
    tables: list[tuple[tuple[str, ...], SourcedTable]] = [
        (axis.keys, table) for axis, table in zip(prepared.design.axes, file.vary, strict=False)
    ]
    tables += [((item.key,), item) for item in (file.sampling.input if file.sampling is not None else ())]
    for keys, table in tables:
        if table.source != NO_SOURCE:
            yield ", ".join(keys), f"{source_text(table.source)} ({table.trust})"


def _describe_axis(axis: DesignAxis, key: str) -> str:
    """Range or distribution of a varied input."""
    if isinstance(axis, SampleAxis):
        distribution = next(item.distribution for item in axis.sampling.input if item.key == key)
        facts = ", ".join(f"{name} {value}" for name, value in distribution if name != "kind" and value is not None)
        described = f"{distribution.kind}: {facts}" if facts else distribution.kind
        return f"{described}; {len(axis)} designs, {axis.sampling.method}"
    first, last = axis.row(0)[key], axis.row(len(axis) - 1)[key]
    return f"{first} to {last}, {len(axis)} values" if len(axis) > 1 else str(first)


# Evaluation of random designs: statistics, distributions, convergence and influences of the inputs.
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
