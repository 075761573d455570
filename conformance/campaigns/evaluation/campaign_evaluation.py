"""Evaluation of a campaign: from the rows of its store to campaign.json."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.campaigns.design_axes import DesignAxis, SampleAxis
from pantocheck.conformance.campaigns.evaluation.campaign_columns import (
    choose_values,
    count_reasons,
    drop_constant,
    read_columns,
)
from pantocheck.conformance.campaigns.evaluation.campaign_comparison import RunPair, compare_values
from pantocheck.conformance.campaigns.evaluation.input_charts import MOST_MAPS, build_input_charts, build_maps
from pantocheck.conformance.campaigns.evaluation.saltelli_evaluation import build_indices, select_independent
from pantocheck.conformance.campaigns.evaluation.sample_evaluation import build_sample_charts, build_statistics
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.input_files.sourced_table import NO_SOURCE, SourcedTable
from pantocheck.conformance.quantities.limit_text import format_stated
from pantocheck.conformance.results.campaign_format import CampaignEnding, CampaignResults
from pantocheck.conformance.results.results_building import build_suite

SEED = ".seed"
"""End of the keys of seeds. Their values have no order: runs that differ in them are random designs."""


def evaluate_campaign(
    prepared: PreparedCampaign, store: CampaignStore, ending: CampaignEnding, pairs: Sequence[RunPair] = ()
) -> CampaignResults:
    """Evaluate the finished runs of a campaign.

    Args:
        prepared: The campaign.
        store: Its finished runs.
        ending: Reason of its end.
        pairs: Runs beside those of another campaign.
    """
    design = prepared.design
    varied = [key for axis in design.axes if not isinstance(axis, SampleAxis) for key in axis.keys]
    grid = [key for key in varied if not key.endswith(SEED)]
    sampled = [key for axis in design.axes if isinstance(axis, SampleAxis) for key in axis.ordered_keys]
    values = choose_values(store, prepared.limits)
    columns = read_columns(store, values, design.keys)
    charted = drop_constant(values, columns)
    saltelli = [axis for axis in design.axes if isinstance(axis, SampleAxis) and axis.sampling.method == "saltelli"]
    independent = select_independent(columns, saltelli[0]) if saltelli else columns
    maps = list(build_maps(columns, charted, grid))
    verdicts, reasons = count_reasons(store)
    finished, failed = store.count()
    return CampaignResults(
        suite=build_suite(),
        title=prepared.file.title,
        ending=ending,
        cases=list(design.case_ids),
        systems=list(design.systems),
        inputs=dict(_describe_inputs(prepared)),
        sources=dict(_list_sources(prepared)),
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


def _describe_inputs(prepared: PreparedCampaign) -> Iterator[tuple[str, str]]:
    """Varied inputs with their ranges, distributions or links."""
    for axis in prepared.design.axes:
        yield from ((key, _describe_axis(axis, key)) for key in axis.keys)
    for link in prepared.design.links:
        yield link.key, f"{format_stated(link.factor)} x {link.follows} + {format_stated(link.offset)}"


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
    if isinstance(axis, SampleAxis):
        distribution = next(item.distribution for item in axis.sampling.input if item.key == key)
        facts = ", ".join(f"{name} {value}" for name, value in distribution if name != "kind" and value is not None)
        described = f"{distribution.kind}: {facts}" if facts else distribution.kind
        return f"{described}; {len(axis)} designs, {axis.sampling.method}"
    first, last = axis.row(0)[key], axis.row(len(axis) - 1)[key]
    return f"{first} to {last}, {len(axis)} values" if len(axis) > 1 else str(first)
