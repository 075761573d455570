"""From results.json to a page: choosing, ordering and wording; nothing is computed here that is not in the results."""

import json
from functools import lru_cache
from typing import Any

from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.reports.certificate import case_facts as facts
from pantocheck.conformance.reports.certificate import quantity_tables as tables
from pantocheck.conformance.reports.certificate import verdict_reasons as reasons
from pantocheck.conformance.reports.certificate.criteria_rows import build_criterion_row
from pantocheck.conformance.reports.certificate.page_content import CaseSection, Figure, InputRow, Page, PlainTable
from pantocheck.conformance.reports.figures import charts
from pantocheck.conformance.reports.figures import force_figures as figures
from pantocheck.conformance.reports.page_text import clean_tree, format_plain, format_value
from pantocheck.conformance.reports.words import read_words

TITLE = "Conformance report"


def build_certificate(results: dict[str, Any]) -> Page:
    """Everything a certificate says.

    Parameters
    ----------
    results : dict[str, Any]
        results.json as a dictionary.
    """
    results = clean_tree(results)
    trust = results.get("trust") or ""
    meaning = read_words()["trust"].get(trust, {}).get("meaning")
    return Page(
        title=TITLE,
        statement=results.get("statement") or "",
        verdict=results["verdict"],
        headline=reasons.build_headline(results),
        trust=trust,
        trust_sentence=f"Lowest trust of the limits that count: {trust} ({meaning})." if meaning else "",
        system=facts.name_system(results),
        suite=facts.name_suite(results),
        reasons=reasons.build_reasons(results),
        cases=tuple(_case(case, at) for at, case in enumerate(results["cases"], start=1)),
        facts=facts.list_suite_facts(results),
    )


def _case(case: dict[str, Any], at: int) -> CaseSection:
    sources: list[str] = []
    rows = tuple(build_criterion_row(row, sources) for row in case["criteria"])
    return CaseSection(
        anchor=f"case-{at}",
        id=case["id"],
        title=case.get("title") or case["id"],
        verdict=case["verdict"],
        sentence=reasons.build_case_reasons(case),
        criteria=rows,
        error_name=error_name(case),
        sources=tuple(sources),
        bands=tables.bands(case),
        quantities=tables.quantities(case),
        skipped=tables.skipped(case),
        tables=tuple(
            PlainTable(one["caption"], tuple(one["columns"]), tuple(tuple(row) for row in one["rows"]))
            for one in case.get("tables") or []
        ),
        figures=_figures(case),
        inputs=tuple(InputRow(one["group"], one["trust"], one.get("source") or "") for one in case.get("inputs") or []),
        notes=tuple(case.get("notes") or []),
        warnings=tuple(case.get("warnings") or []),
        facts=facts.list_case_facts(case),
    )


def error_name(case: dict[str, Any]) -> str:
    """What stands beside the values of a case: their uncertainty, or their discretisation error."""
    uncertain = any(row.get("uncertainty") is not None for row in case["criteria"])
    return "Uncertainty (95 %)" if uncertain else "Discretisation error"


def _figures(case: dict[str, Any]) -> tuple[Figure, ...]:
    return _drawn(json.dumps({key: case.get(key) for key in ("charts", "traces", "uplift", "criteria", "quantities")}))


@lru_cache(maxsize=32)
def _drawn(content: str) -> tuple[Figure, ...]:
    """Figures of the parts of a case that are drawn. Drawing takes most of a page's time, so HTML and PDF share it."""
    case = json.loads(content)
    drawn = [
        Figure(charts.draw_chart(one), one["alternative"], one["caption"], one["wide"])
        for one in case.get("charts") or []
    ]
    for key, trace in sorted((case.get("traces") or {}).items(), key=lambda item: (len(item[0]), item[0])):
        rows = [row for row in case["criteria"] if str(row.get("pantograph")) == key]
        if trace.get("position_m"):
            drawn.append(_force(key, trace, rows))
        if (trace.get("spectrum") or {}).get("frequency_Hz"):
            drawn.append(_spectrum(key, trace, case["quantities"].get(key, {})))
        if (trace.get("histogram") or {}).get("share_pct"):
            drawn.append(_histogram(key, trace))
    supports = [support for support in case.get("uplift") or [] if support["time_s"]]
    if supports:
        peaks = ", ".join(
            f"{format_value(max(s['uplift_mm']), 3)} mm at {format_plain(s['support_m'])} m" for s in supports
        )
        caption = f"Uplift at the supports. Largest: {peaks}."
        drawn.append(Figure(figures.draw_uplift(supports, case["criteria"]), caption, caption, wide=True))
    return tuple(drawn)


def _force(key: str, trace: dict[str, Any], rows: list[dict[str, Any]]) -> Figure:
    start, end = trace["position_m"][0], trace["position_m"][-1]
    mean, std = trace.get("mean_N"), trace.get("std_N")
    text = f"Pantograph {key}: contact force from {format_plain(start)} m to {format_plain(end)} m"
    if mean is not None and std is not None:
        low, high = format_value(mean - 3 * std), format_value(mean + 3 * std)
        text += f"; mean {format_value(mean)} N, mean ± 3 σ from {low} N to {high} N"
    limited = figures.limited_rows(rows)
    strip = " On the right: the limits of the force's statistics, and where the values lie." if limited else ""
    return Figure(figures.draw_force(trace, limited), f"{text}.", f"{text}.{strip}", wide=True)


def _spectrum(key: str, trace: dict[str, Any], quantities: dict[str, Any]) -> Figure:
    bands = [
        f"{low} to {high} Hz: {format_value(quantities[name])} N"
        for low, high, name in BANDS
        if quantities.get(name) is not None
    ]
    caption = f"Pantograph {key}: amplitude spectrum of the force, with the RMS of its bands."
    alternative = f"{caption} {'; '.join(bands)}." if bands else caption
    return Figure(figures.draw_spectrum(trace, quantities), alternative, caption, wide=False)


def _histogram(key: str, trace: dict[str, Any]) -> Figure:
    edges = trace["histogram"]["edges_N"]
    caption = f"Pantograph {key}: histogram of the 20 Hz force."
    alternative = f"{caption} From {format_value(edges[0])} N to {format_value(edges[-1])} N."
    return Figure(figures.draw_histogram(trace), alternative, caption, wide=False)
