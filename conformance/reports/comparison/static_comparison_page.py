"""Report on a static comparison, from static_comparison.json."""

from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.static_figure import draw_static_values
from pantocheck.conformance.reports.page_text import clean_tree, format_plain, format_value, replace_minus
from pantocheck.conformance.reports.words import quantity_label

SPANS_OF_A_FIGURE = 10
"""Largest number of spans in a figure: the droppers of each span stay visible on paper."""

COMPARISON_STATEMENT = "self-declared comparison with measured values"

HEADLINES = {
    "pass": "The graded differences between model and measurement lie within the tolerances of the user.",
    "fail": "A difference between model and measurement exceeds a tolerance of the user.",
    "skip": "The record is not complete for every tolerance.",
    "info": "No tolerance was given: the differences are shown and not graded.",
}
SCOPE = (
    "Static check of the line model against measured values. The tolerances are those of the user, not of a standard. "
    "Every measured value of the evaluated section counts, also an outlier. Differences are model minus measurement. "
    "The record is unverified: a table of static values has no second channel that could confirm it."
)


def build_static_comparison(results: dict[str, Any]) -> doc.Document:
    """The report on the content of static_comparison.json."""
    results = clean_tree(results)
    suite = f"Pantocheck {results['suite']['version']}"
    header = doc.VerdictHeader(
        "Static values of a line: measurement and model",
        results["verdict"],
        COMPARISON_STATEMENT,
        HEADLINES[results["verdict"]],
        f"Line: {results['line']}. Measured values: {results['record']}. {suite}.",
        f"{suite} · {results['line']}",
    )
    remarks = tuple(list_remarks(results))
    blocks: list[doc.Block] = [doc.WarningBox(remarks)] if remarks else []
    blocks += [doc.Paragraph(SCOPE), doc.Facts(_list_facts(results))]
    if results["criteria"]:
        blocks.append(doc.Section("Criteria", (_build_criteria_table(results["criteria"]),)))
    blocks += build_static_sections(results)
    return doc.Document(header.heading, header, tuple(blocks))


def build_static_sections(results: dict[str, Any]) -> tuple[doc.Section, ...]:
    """Section of each kind of values, with figures and a table of the spans."""
    return tuple(_build_section(values, results) for values in results["values"])


def list_remarks(results: dict[str, Any]) -> list[str]:
    """Caveats: values without tolerance, missing or far from the others, and criteria close to their tolerance."""
    remarks = []
    graded = [item["quantity"] for item in results["criteria"]]
    for values in results["values"]:
        name = values["name"].replace("_", " ")
        if graded and not any(quantity.startswith(values["name"]) for quantity in graded):
            remarks.append(f"{name}: no tolerance was given, so that the differences are not graded")
        if values["missing_rows"]:
            remarks.append(f"{name}: no value in {_name_rows(values['missing_rows'])}")
        if values["outlier_rows"]:
            remarks.append(
                f"{name}: the differences of {_name_rows(values['outlier_rows'])} are outliers among those of the "
                "record; they count"
            )
    for item in results["criteria"]:
        remarks += [f"{item['quantity']} {text}" for text in item["close"]]
    return remarks


def _name_rows(rows: list[int]) -> str:
    names = ", ".join(map(str, rows[:20]))
    return f"row{'s' if len(rows) > 1 else ''} {names}" + (f" and {len(rows) - 20} more" if len(rows) > 20 else "")


def _list_facts(results: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    first, last = results["evaluated_spans"]
    start, end = map(format_plain, results["evaluated_m"])
    force = " and ".join(f"{format_plain(force)} N" for force in results["force_N"])
    facts = {
        "Evaluated section": f"spans {first} to {last}, {start} to {end} m",
        "Largest distance of measured positions": f"{format_plain(results['largest_distance_m'])} m"
        if results["largest_distance_m"]
        else "not stated",
        "Static force of the elasticity": force,
        "Element length of the model": f"{format_plain(results['element_m'])} m",
        "Digest of the line": results["line_digest"],
        "Digest of the record": results["record_digest"],
        "Digest of the suite": results["suite"]["digest"],
        "Note": results["note"],
    }
    return tuple((name, text) for name, text in facts.items() if text)


def _build_criteria_table(criteria: list[dict[str, Any]]) -> doc.Table:
    columns = (
        doc.Column("Criterion", share=3),
        doc.Column("Value", number=True),
        doc.Column("Tolerance", number=True),
        doc.Column("± model", number=True),
        doc.Column("± measured", number=True),
        doc.Column("Verdict"),
        doc.Column("Remark", share=3),
    )
    rows: list[tuple[doc.RichText, ...]] = [
        (
            f"{quantity_label(item['quantity'])} [{item['unit']}]",
            format_value(item["value"]),
            format_plain(item["tolerance"]),
            format_value(item["discretisation"], 2),
            format_value(item["measurement"], 2) if item["measurement"] else "not stated",
            doc.VerdictMark(item["verdict"]),
            item["reason"] or "–",
        )
        for item in criteria
    ]
    return doc.Table(columns, tuple(rows))


def _build_section(values: dict[str, Any], results: dict[str, Any]) -> doc.Section:
    name, unit = values["name"].replace("_", " "), values["unit"]
    tolerance = next((c["tolerance"] for c in results["criteria"] if c["quantity"] == _name_criterion(values)), None)
    spans = values["spans"]
    figures = tuple(
        doc.Figure(
            draw_static_values(values, part, tolerance, tuple(results["evaluated_m"])),
            f"{name} measured and of the model in spans {part[0]['number']} to {part[-1]['number']}.",
            f"Spans {part[0]['number']} to {part[-1]['number']}, numbered at the lower edge; dotted: supports.",
        )
        for part in (spans[i : i + SPANS_OF_A_FIGURE] for i in range(0, len(spans), SPANS_OF_A_FIGURE))
        if any(span["values"] for span in part)
    )
    text = (
        f"Model minus measurement in the evaluated section: mean {format_value(values['mean_difference'], 3)} {unit}, "
        f"RMS {format_value(values['rms_difference'], 3)} {unit}."
    )
    heading = f"{name[0].upper()}{name[1:]}"
    return doc.Section(heading, (doc.Paragraph(text), doc.Figures(figures), _build_span_table(values)))


def _name_criterion(values: dict[str, Any]) -> str:
    """Name of the criterion whose unit is that of the values."""
    return f"{values['name']}_difference_{values['unit'].replace('/', '_')}"


def _build_span_table(values: dict[str, Any]) -> doc.Table:
    def limits(pair: list[float] | None) -> str:
        return "–" if pair is None else f"{format_value(pair[0])} to {format_value(pair[1])}"

    def signed(value: float | None) -> str:
        return "–" if value is None else replace_minus(f"{value:+.3g}")

    cells = {
        "Span": lambda span: str(span["number"]),
        "From [m]": lambda span: format_plain(span["start_m"]),
        "To [m]": lambda span: format_plain(span["end_m"]),
        "Values": lambda span: str(span["values"]),
        "Measured": lambda span: limits(span["measured"]),
        "Model": lambda span: limits(span["model"]),
        "Mean difference": lambda span: signed(span["mean_difference"]),
        "Largest difference": lambda span: signed(span["largest_difference"]),
    }
    return doc.make_grid(f"Lowest and highest values span by span [{values['unit']}]", values["spans"], cells)
