"""Page of a case on a site: its values and verdicts by system and version over time."""

from collections.abc import Sequence

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.site_index import PublishedResults
from pantocheck.conformance.pages.study_chart import draw_chart, find_common_range
from pantocheck.conformance.pages.words import clean_text, format_value, name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.results.results_format import CaseResult

HISTORY_QUANTITIES = (
    *("mean_force_N", "std_force_N", "std_force_50_N", "rms_20_50_N"),
    *("max_force_N", "min_force_N", "max_uplift_at_support_mm"),
)
"""Quantities whose history a page shows."""

MOST_TICKS = 12
"""Largest number of runs whose dates stand below a figure."""

Run = tuple[PublishedResults, CaseResult]
"""A run, and its result of the case."""


def build_case_page(case_id: str, published: Sequence[PublishedResults]) -> doc.Document:
    """Page of a case.

    Args:
        case_id: Id of the case.
        published: Results from the oldest to the latest.
    """
    runs = [(run, case) for run in published for case in run.results.cases if case.id == case_id]
    titles = clean_text(runs[-1][1].title)
    header = doc.PlainHeader(clean_text(case_id), titles)
    blocks: list[doc.Block] = [doc.Paragraph((doc.PageLink("All systems and cases", "../index.html"),))]
    blocks.append(doc.Section("Verdicts", (_build_verdict_table(runs),)))
    # One run per system has no history: the table shows its values.
    repeated = len(runs) > len({run.system for run, _ in runs})
    for owner in sorted({owner for _, case in runs for owner in case.quantities}, key=int):
        names = [name for name in HISTORY_QUANTITIES if any(_read(case, owner, name) is not None for _, case in runs)]
        if names:
            table = _build_value_table(runs, owner, names)
            figures = doc.Figures(tuple(_draw_history(runs, owner, name) for name in names))
            blocks.append(doc.Section(name_pantograph(owner).capitalize(), (table, figures) if repeated else (table,)))
    return doc.Document(header.heading, header, tuple(blocks))


def _read(case: CaseResult, owner: str, name: str) -> float | None:
    """Value of a quantity; None if it is not known."""
    value = case.quantities.get(owner, {}).get(name)
    return select_single(value)


def _build_verdict_table(runs: Sequence[Run]) -> doc.Table:
    columns = (*map(doc.Column, ("Date", "System", "Version", "Verdict")), doc.Column("Reason", share=1))
    rows = tuple(
        (
            run.date[:10] or "not stated",
            clean_text(run.system),
            doc.PageLink(clean_text(run.version) or "certificate", f"../{run.folder}/certificate.html"),
            doc.VerdictMark(run.verdict(case.verdict)),
            clean_text(run.discrepancies[0] if run.discrepancies else case.reason or ""),
        )
        for run, case in reversed(runs)
    )
    return doc.Table(columns, rows, "The latest run first")


def _build_value_table(runs: Sequence[Run], owner: str, names: Sequence[str]) -> doc.Table:
    columns = (
        *map(doc.Column, ("System", "Version")),
        *(doc.Column(f"{quantity_label(name)} [{quantity_unit(name)}]", number=True) for name in names),
    )
    rows = tuple(
        (
            clean_text(run.system),
            clean_text(run.version),
            *(format_value(_read(case, owner, name)) for name in names),
        )
        for run, case in reversed(runs)
    )
    return doc.Table(columns, rows, "Values, the latest run first")


def _draw_history(runs: Sequence[Run], owner: str, name: str) -> doc.Figure:
    """Values of a quantity in the order of the runs, one series per system."""
    places: dict[str, tuple[list[float], list[float]]] = {}
    for place, (run, case) in enumerate(runs):
        if (value := _read(case, owner, name)) is not None:
            x, y = places.setdefault(clean_text(run.system), ([], []))
            x.append(float(place))
            y.append(value)
    caption = f"{quantity_label(name)} by run, from the oldest to the latest."
    chart = Chart(
        caption=caption,
        alternative=f"{caption} The values are in the table.",
        x_label="run",
        y_label=f"{quantity_label(name)} [{quantity_unit(name)}]",
        ticks=[run.date[:10] or "no date" for run, _ in runs] if len(runs) <= MOST_TICKS else None,
        series=[Series(label=system, style="points", x=x, y=y) for system, (x, y) in places.items()],
    )
    return doc.Figure(draw_chart(chart, find_common_range([chart])), chart.alternative, caption)
