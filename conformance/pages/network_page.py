"""Pages of an assessed collection: lines by kilometre, sections, worst places, and a page per run."""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.verdicts import WORST_FIRST
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.network_figures import draw_network_map, draw_trace, draw_track, list_coordinates
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import (
    clean_text,
    clean_tree,
    format_plain,
    format_value,
    quantity_label,
    quantity_unit,
)
from pantocheck.conformance.results.network_format import (
    ForcePlace,
    MisplacedRun,
    NetworkResults,
    SectionGroup,
    SectionPassage,
    TrackSection,
    UnusualValue,
)

NETWORK_SCOPE = (
    "A section passes if every passage over its whole length passes. A section without such a passage is skipped. The "
    "verdict is self-declared, in the style of EN 50318. passages.csv lists every passage. The range of a mean follows "
    "from Student's t over the passages; its coverage is not measured."
)

NETWORK_COLUMNS = (
    *("mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N", "contact_loss_pct"),
    "max_uplift_at_support_mm",
)
"""Quantities in the tables."""

VALUES_IN_TABLES = "The values are in the tables."

MOST_GROUPS = 20_000
"""Largest number of sections on the page; those that do not pass come first where there are more."""


def build_network_page(results: NetworkResults) -> doc.Document:
    """First page of an assessed collection."""
    results = clean_tree(results)
    measured = f"{results.measured_km:.1f} of {results.total_km:.1f} km were measured as whole sections, "
    headline = f"{measured}by {count_noun(results.runs, 'run')}. {results.reason}."
    blocks: list[doc.Block] = [doc.Paragraph((doc.VerdictMark(results.verdict), " ", NETWORK_SCOPE))]
    blocks += doc.warn(f"{refused.file} is not part of the assessment: {refused.reason}" for refused in results.refused)
    suspicions = [f"run {run}: {remark}" for run, remarks in results.suspicious.items() for remark in remarks]
    tracks = groupby(results.groups, key=lambda group: (group.section.line, group.section.track))
    figures = tuple(_draw_track(*names, list(groups)) for names, groups in tracks)
    blocks.append(doc.Section("Lines by kilometre", (doc.Figures(figures),)))
    if tracks_on_map := list_coordinates(results):
        caption = "Map of the sections by verdict, with the worst places that no known place explains."
        alternative = f"{caption} {VALUES_IN_TABLES}"
        network_map = doc.Figure(draw_network_map(results, tracks_on_map), alternative, caption)
        blocks.append(doc.Section("Map", (doc.Figures((network_map,)),)))
    if results.places:
        traced = [place for place in results.places if place.trace is not None]
        drawn = doc.Section("Force at the worst places", (doc.Figures(tuple(map(_draw_place, traced))),), folded=True)
        blocks.append(doc.Section("Worst places", (_tabulate_places(results.places), drawn)))
    if results.misplaced:
        blocks.append(doc.Section("Misplaced runs", (_tabulate_misplaced(results.misplaced),)))
    if results.unusual:
        blocks.append(doc.Section("Unusual values", (_tabulate_unusual(results.unusual),)))
    blocks.append(doc.Section("Sections", (_tabulate_groups(results.groups),)))
    drifts = [doc.BulletList(tuple(_list_drifts(results.groups)))] if any(_list_drifts(results.groups)) else []
    if drifts:
        blocks.append(doc.Section("Changes between the dates", tuple(drifts)))
    if suspicions:
        blocks.append(doc.Section("Remarks on imported runs", (doc.BulletList(tuple(suspicions)),), folded=True))
    facts = {
        "Profile": results.profile,
        "Lowest trust of the rules": results.trust,
        "Grouped by": ", ".join(results.by),
    }
    suite = {"Suite": f"Pantocheck {results.suite.version}", "Digest of the suite": results.suite.digest}
    blocks.append(doc.select_facts(facts | suite))
    return doc.build_plain_document("Measured lines", headline, blocks)


def build_run_page(run: str, passages: Sequence[SectionPassage]) -> doc.Document:
    """Page of one run: its passages over the sections."""
    passages = [clean_tree(passage) for passage in passages]
    cells = {
        **_list_section_columns(),
        doc.Column("Pantograph"): lambda x: x.pantograph,
        doc.Column("Speed [km/h]", number=True): lambda x: format_value(x.speed_km_h),
        doc.Column("Verdict"): lambda x: doc.VerdictMark(x.verdict),
        **{_head(name): lambda x, name=name: format_value(x.values.get(name)) for name in _list_known(passages)},
        **_list_clock_column(passages),
        doc.Column("Reason", share=1): lambda x: x.reason,
    }
    back = doc.Paragraph((doc.PageLink("All lines", "../index.html"),))
    first = passages[0] if passages else None
    parts = () if first is None else (first.section.line, first.section.track, str(first.date), first.direction)
    headline = ", ".join(parts)
    table = doc.make_table(passages, cells)  # type: ignore[arg-type]
    figures = doc.Figures(tuple(_draw_run(passages)))
    blocks = (back, figures, table) if figures.figures else (back, table)
    return doc.build_plain_document(f"Run {clean_text(run)}", headline or "No section is passed.", blocks)


def _head(quantity: str) -> doc.Column:
    return doc.Column(f"{quantity_label(quantity)} [{quantity_unit(quantity)}]", number=True)


def _list_section_columns() -> dict[doc.Column, object]:
    return {
        doc.Column("Line", choice="value"): lambda x: x.section.line,
        doc.Column("Track", choice="value"): lambda x: x.section.track,
        doc.Column("Section", number=True): lambda x: _name_section(x.section),
    }


def _name_section(section: TrackSection) -> str:
    return f"{section.from_km:.3f} to {section.to_km:.3f} km {section.name}".strip()


def _name_dates(group: SectionGroup) -> str:
    return " to ".join(str(date) for date in dict.fromkeys(group.dates))


def _tabulate_groups(groups: Sequence[SectionGroup]) -> doc.Table:
    shown = list(groups)
    if len(shown) > MOST_GROUPS:
        shown = sorted(shown, key=lambda group: WORST_FIRST.index(group.verdict))[:MOST_GROUPS]
    classes: dict[doc.Column, Callable[[SectionGroup], str]] = {
        doc.Column("Speed [km/h]", choice="value"): _name_speed,
        doc.Column("Kilometres", choice="value"): lambda x: x.direction or "",
        doc.Column("Pantograph", choice="value"): lambda x: x.pantograph or "",
    }
    cells = {
        **_list_section_columns(),
        doc.Column("Passages", number=True): lambda x: str(x.passages),
        doc.Column("Dates", number=True, choice="date"): _name_dates,
        **{column: call for column, call in classes.items() if any(map(call, shown))},
        doc.Column("Verdict"): lambda x: doc.VerdictMark(x.verdict),
        **{_head(name): lambda x, name=name: _format_repeated(x, name) for name in _list_known(shown)},
        **_list_clock_column(shown),
        doc.Column("Reason", share=1): lambda x: x.reason,
        doc.Column("Run"): lambda x: _link_run(x.run) if x.run else "",
    }
    caption = "Filter by a date, speed, kilometre or verdict; the run is that of the worst passage"
    return doc.make_table(shown, cells, caption)  # type: ignore[arg-type]


def _list_known(items: Sequence[SectionGroup | SectionPassage]) -> list[str]:
    """Quantities that one of the groups or passages has."""
    return [name for name in NETWORK_COLUMNS if any(name in item.values for item in items)]


def _list_clock_column(items: Sequence[SectionGroup | SectionPassage]) -> dict[doc.Column, object]:
    """Column of the clocks, if a run has several files."""
    return {doc.Column("Clocks"): lambda x: x.clocks} if any(item.clocks for item in items) else {}


def _name_speed(group: SectionGroup) -> str:
    return "" if group.speed_km_h is None else "{:g} to {:g}".format(*group.speed_km_h)


def _format_repeated(group: SectionGroup, name: str) -> str:
    value = group.values.get(name)
    if value is None:
        return "–"
    return format_value(value.mean) + ("" if value.mean_range is None else f" ± {format_value(value.mean_range, 2)}")


def _link_run(run: str) -> doc.PageLink:
    return doc.PageLink(run, f"runs/{run}.html")


def _tabulate_places(places: Sequence[ForcePlace]) -> doc.Table:
    cells = {
        doc.Column("Line", choice="value"): lambda x: x.line,
        doc.Column("Track", choice="value"): lambda x: x.track,
        doc.Column("km", number=True): lambda x: f"{x.km:.3f}",
        doc.Column("Force [N]", number=True): lambda x: format_value(x.force_N),
        doc.Column("Deviation", number=True): lambda x: format_plain(round(x.deviation, 1)),
        doc.Column("Threshold", number=True): lambda x: f"{x.threshold:.1f}",
        doc.Column("Extent [m]", number=True): lambda x: f"{x.extent_m:g}",
        doc.Column("Seen in"): lambda x: f"{x.found} of {x.passages}",
        doc.Column("Date", choice="date"): lambda x: str(x.date),
        doc.Column("Pantograph"): lambda x: x.pantograph,
        doc.Column("Known place", share=1): lambda x: x.place,
        doc.Column("Explained by place", choice="value"): lambda x: "yes" if x.explained else "no",
        doc.Column("Run"): lambda x: _link_run(x.run),
    }
    caption = "Deviation of the filtered force from the neighbouring spans, in robust standard deviations"
    return doc.make_table(places, cells, caption)


def _tabulate_misplaced(runs: Sequence[MisplacedRun]) -> doc.Table:
    cells = {
        doc.Column("Line", choice="value"): lambda x: x.line,
        doc.Column("Track", choice="value"): lambda x: x.track,
        doc.Column("Section"): lambda x: f"{x.from_km:.3f} to {x.to_km:.3f} km",
        doc.Column("Pantograph"): lambda x: x.pantograph,
        doc.Column("Offset [m]", number=True): lambda x: format_plain(x.offset_m and round(x.offset_m, 1)),
        doc.Column("Error of clock [s]", number=True): lambda x: format_plain(x.offset_s and round(x.offset_s, 2)),
        doc.Column("Agreement", number=True): lambda x: f"{x.agreement:.2f}",
        doc.Column("Run"): lambda x: _link_run(x.run),
    }
    caption = "Wrong kilometre, or clock with this error; without an offset, the force is that of another line or place"
    return doc.make_table(runs, cells, caption)


def _tabulate_unusual(values: Sequence[UnusualValue]) -> doc.Table:
    cells = {
        **_list_section_columns(),
        doc.Column("Quantity"): lambda x: quantity_label(x.quantity),
        doc.Column("Value", number=True): lambda x: format_value(x.value),
        doc.Column("Expected", number=True): lambda x: format_value(x.expected),
        doc.Column("Deviation", number=True): lambda x: format_plain(round(x.deviation, 1)),
        doc.Column("Run"): lambda x: "all" if x.run is None else _link_run(x.run),
    }
    caption = (
        "Run 'all': a section compared with the other sections of its track. Otherwise: one passage compared with the "
        "other passages over its section. Deviation in robust standard deviations"
    )
    return doc.make_table(values, cells, caption)  # type: ignore[arg-type]


def _draw_track(line: str, track: str, groups: Sequence[SectionGroup]) -> doc.Figure:
    caption = f"Line {line}, track {track}: mean force of the sections with its lowest and highest value, and verdicts."
    return doc.Figure(draw_track(groups), f"{caption} {VALUES_IN_TABLES}", caption)


def _draw_run(passages: Sequence[SectionPassage]) -> Iterator[doc.Figure]:
    """Statistics of the force by kilometre, one figure per pantograph."""
    names = {"statistical_max_N": "mean + 3 sigma", "mean_force_N": "mean", "statistical_min_N": "mean - 3 sigma"}
    for pantograph in dict.fromkeys(passage.pantograph for passage in passages):
        own = [x for x in passages if x.pantograph == pantograph and names.keys() <= x.values.keys()]
        middles = [(x.section.from_km + x.section.to_km) / 2 for x in own]
        series = [
            Series(label=label, style="line", x=middles, y=[x.values[name] for x in own])
            for name, label in names.items()
        ]
        if len(own) > 1:
            yield _draw(f"Pantograph {pantograph}: force by section.", "kilometre", "force [N]", series)


def _draw_place(place: ForcePlace) -> doc.Figure:
    caption = f"Line {place.line}, track {place.track}, {place.km:.3f} km, {place.date}, run {place.run} {place.place}"
    return doc.Figure(draw_trace(place), f"{caption.strip()}. {VALUES_IN_TABLES}", f"{caption.strip()}.", wide=False)


def _draw(caption: str, x_label: str, y_label: str, series: list[Series]) -> doc.Figure:
    alternative = f"{caption} {VALUES_IN_TABLES}"
    chart = Chart(caption=caption, alternative=alternative, x_label=x_label, y_label=y_label, series=series)
    return doc.Figure(draw_chart(chart), alternative, caption)


def _list_drifts(groups: Sequence[SectionGroup]) -> Iterator[str]:
    for group in groups:
        for name, value in group.values.items():
            if value.drifts and value.drift is not None:
                place = f"line {group.section.line}, track {group.section.track}, {_name_section(group.section)}"
                yield f"{place}: {quantity_label(name)} changes by {format_value(value.drift, 3)} {quantity_unit(name)}"
