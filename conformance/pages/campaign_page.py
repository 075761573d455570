"""Report on a campaign, from campaign.json."""

from collections.abc import Callable, Sequence

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.condition_sections import BAND_MARK
from pantocheck.conformance.pages.study_chart import draw_chart, draw_map, draw_tornado
from pantocheck.conformance.pages.words import clean_tree, format_percent, format_value
from pantocheck.conformance.results.campaign_format import (
    CampaignResults,
    Estimate,
    InputShare,
    SobolIndices,
    ValueComparison,
    ValueStatistics,
)

CAMPAIGN_ENDINGS = {
    "complete": "",
    "failure share": " It stopped because too many runs failed.",
    "time budget": " It stopped at the end of its time budget.",
    "interrupted": " It was interrupted.",
}

CAMPAIGN_SCOPE = (
    "Each run is one simulation with the discretisation of its case, unless the campaign states refined runs. A "
    "changed library case has no limits: without limits of the user, its verdict is info. The table campaign.csv has "
    "all inputs, verdicts and quantities of every run."
)

SHOWN_ROWS = 100
"""Largest number of rows of a table: four pages."""

INDICES = (
    "First order (Saltelli et al. 2010): share of the variance that an input causes alone. Total (Jansen 1999): share "
    "that it causes with its interactions. Estimates of small shares can be negative."
)


def build_campaign_report(results: CampaignResults) -> doc.Document:
    """The report on the content of campaign.json."""
    results = clean_tree(results)
    counts = f"{results.finished} of {results.total} runs are finished, {results.failed} of them failed."
    blocks: list[doc.Block] = [doc.Paragraph(CAMPAIGN_SCOPE), _build_facts(results)]
    blocks += _list_reasons(results.reasons)
    maps = [doc.Figure(draw_map(data), data.alternative, data.caption) for data in results.maps]
    charts = [doc.Figure(_draw(data), data.alternative, data.caption, data.wide) for data in results.charts]
    if results.statistics:
        blocks.append(doc.Section("Random inputs", (_build_statistics_table(results.statistics),)))
    if results.comparison:
        blocks.append(doc.Section("Comparison with another campaign", (_build_comparison_table(results.comparison),)))
    if results.indices:
        blocks.append(doc.Section("Sobol indices", (_build_indices_table(results.indices), doc.SmallPrint(INDICES))))
    if results.omitted_maps:
        blocks.append(doc.Paragraph(f"{results.omitted_maps} further maps are left out; campaign.csv has all values."))
    if maps or charts:
        blocks.append(doc.Section("Figures", (doc.Figures((*maps, *charts)),)))
    return doc.build_plain_document(f"Campaign: {results.title}", counts + CAMPAIGN_ENDINGS[results.ending], blocks)


def _draw(chart: Chart) -> str:
    """Draw a chart as a tornado, or against its axes."""
    is_tornado = any(series.style == "tornado" for series in chart.series)
    return draw_tornado(chart) if is_tornado else draw_chart(chart)


def _build_facts(results: CampaignResults) -> doc.Facts:
    verdicts = ", ".join(f"{verdict}: {count}" for verdict, count in results.verdicts.items())
    facts = {
        "Cases": ", ".join(results.cases),
        "Systems": ", ".join(results.systems),
        "Verdicts of the runs": verdicts,
        **results.inputs,
        **_join_sources(results.sources),
        f"{BAND_MARK} Condition of 20-50 Hz": "; ".join(dict.fromkeys(results.contacts.values())),
        "Suite": f"Pantocheck {results.suite.version}",
        "Digest of the suite": results.suite.digest,
    }
    return doc.select_facts(facts)


def _join_sources(sources: dict[str, str]) -> dict[str, str]:
    """Facts on the sources of the varied inputs; inputs with one source share it."""
    keys: dict[str, list[str]] = {}
    for key, text in sources.items():
        keys.setdefault(text, []).append(key)
    if len(keys) == 1:
        return {"Source of the varied inputs": next(iter(keys))}
    return {f"Source {i}": f"{text}: {', '.join(names)}" for i, (text, names) in enumerate(keys.items(), 1)}


def _list_reasons(reasons: dict[str, int]) -> list[doc.Block]:
    """Section on runs without a result."""
    if not reasons:
        return []
    items = tuple(f"{count} run{'s' if count > 1 else ''}: {reason}" for reason, count in reasons.items())
    return [doc.Section("Runs without a result", (doc.BulletList(items),))]


def _build_comparison_table(comparison: Sequence[ValueComparison]) -> doc.Table:
    cells: dict[str, Callable[[ValueComparison], str]] = {
        "Value": lambda row: row.label,
        "Runs": lambda row: str(row.runs),
        "Mean": lambda row: format_value(row.mean, 3),
        "RMS": lambda row: format_value(row.rms, 3),
        "Largest": lambda row: format_value(row.largest, 3),
        "Place of the largest": lambda row: row.place,
    }
    return doc.make_grid("Differences of runs with equal inputs: this campaign minus the other", comparison, cells)


def _build_indices_table(indices: Sequence[SobolIndices]) -> doc.Table:
    rows = [(item, share) for item in indices for share in item.shares][:SHOWN_ROWS]
    cells: dict[str, Callable[[tuple[SobolIndices, InputShare]], str]] = {
        "Value": lambda row: _name_value(row[0]),
        "Runs per set": lambda row: str(row[0].runs),
        "First order [%]": lambda row: _format_share(row[1].first),
        "Total [%]": lambda row: _format_share(row[1].total),
        "Input": lambda row: row[1].input,
    }
    return doc.make_grid("Shares of the variance with their 95 % intervals (bootstrap)", rows, cells)


def _name_value(row: SobolIndices | ValueStatistics) -> str:
    """Label of a value with its group."""
    return row.label + (f", {row.group}" if row.group else "")


def _format_share(estimate: Estimate | None) -> str:
    """Share in per cent with its interval; a dash for no estimate."""
    if estimate is None:
        return "–"
    value, low, high = (format_percent(part, 3) for part in (estimate.value, estimate.low, estimate.high))
    return f"{value} ({low} to {high})"


def _build_statistics_table(statistics: Sequence[ValueStatistics]) -> doc.Table:
    def quantile(name: str) -> Callable[[ValueStatistics], str]:
        return lambda row: format_value(row.quantiles[name])

    cells: dict[str, Callable[[ValueStatistics], str]] = {
        "Value": _name_value,
        "Runs": lambda row: str(row.runs),
        "Mean": lambda row: format_value(row.mean.value),
        "Std": lambda row: format_value(row.std, 3),
        **{name: quantile(name) for name in ("5 %", "50 %", "95 %")},
        "Limit": lambda row: row.limit or "–",
        "Outside [%]": lambda row: _format_share(row.exceedance),
    }
    caption = (
        "Values over the random designs; share of runs outside the limit with its interval of uncertainty (Wilson 1927)"
    )
    if len(statistics) > SHOWN_ROWS:
        caption += f" (the first {SHOWN_ROWS} of {len(statistics)} rows; campaign.json has all)"
    return doc.make_grid(caption, statistics[:SHOWN_ROWS], cells)
