"""Report on a comparison of runs, from comparison.json."""

from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.study_chart import draw_chart
from pantocheck.conformance.reports.page_text import clean_tree, format_plain, format_value, replace_minus
from pantocheck.conformance.reports.words import name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.results.figure_data import Chart

RUN_COMPARISON_SCOPE = (
    "The comparison judges nothing: it has no limits and no verdict. A number in parentheses is the difference from "
    "the first subject. An asterisk marks a difference that exceeds the joint 95 % uncertainty of both values. "
    "The uncertainty of a record is that of its length; its discretisation error is not known."
)


def build_run_comparison(results: dict[str, Any]) -> doc.Document:
    """The report on the content of comparison.json."""
    results = clean_tree(results)
    names = [subject["name"] for subject in results["subjects"]]
    header = doc.PlainHeader("Comparison of runs", f"{', '.join(names[1:])} beside {names[0]}.")
    facts = {subject["name"]: _describe_subject(subject) for subject in results["subjects"]}
    suite = results["suite"]
    facts |= {"Suite": f"Pantocheck {suite['version']}", "Digest of the suite": suite["digest"] or "not known"}
    blocks: list[doc.Block] = [doc.Paragraph(RUN_COMPARISON_SCOPE), doc.Facts(tuple(facts.items()))]
    for case in results["cases"]:
        owners = [_build_owner(owner, names) for owner in case["owners"] if owner["quantities"]]
        notes: list[doc.Block] = [doc.WarningBox(tuple(case["notes"]))] if case["notes"] else []
        blocks.append(doc.Section(case["id"] or "Records", (*notes, *owners)))
    return doc.Document(header.headline, header, tuple(blocks))


def _describe_subject(subject: dict[str, Any]) -> str:
    return f"{subject['source']}, {subject['digest']}" if subject["digest"] else str(subject["source"])


def _build_owner(owner: dict[str, Any], names: list[str]) -> doc.Section:
    """Figures, agreement and quantities of a pantograph or of the line."""
    blocks: list[doc.Block] = []
    if owner["charts"]:
        figures = (
            doc.Figure(draw_chart(Chart.model_validate(data)), data["alternative"], data["caption"], data["wide"])
            for data in owner["charts"]
        )
        blocks.append(doc.Figures(tuple(figures)))
    if owner["reasons"]:
        blocks.append(doc.BulletList(tuple(owner["reasons"])))
    if owner["agreements"]:
        blocks.append(_build_agreement_table(owner["agreements"], names[0]))
    blocks.append(_build_quantity_table(owner["quantities"], names))
    return doc.Section(name_pantograph(owner["number"]).capitalize(), tuple(blocks))


def _draw_figure(data: dict[str, Any]) -> doc.Figure:
    return doc.Figure(draw_chart(Chart.model_validate(data)), data["alternative"], data["caption"], data["wide"])


def _build_agreement_table(agreements: list[dict[str, Any]], first: str) -> doc.Table:
    rows = [{**band, **agreement} for agreement in agreements for band in agreement["bands"]]
    cells = {
        "Subject": lambda row: row["subject"],
        "Band [Hz]": lambda row: f"{format_plain(row['low_Hz'])} to {format_plain(row['high_Hz'])}",
        f"RMS of {first} [N]": lambda row: format_value(row["first_N"]),
        "RMS of the subject [N]": lambda row: format_value(row["other_N"]),
        "RMS of the difference [N]": lambda row: format_value(row["difference_N"]),
        "Correlation of the whole force": lambda row: format_value(row["correlation"], 3),
    }
    return doc.make_grid("Agreement of the forces at the same positions", rows, cells)


def _build_quantity_table(quantities: list[dict[str, Any]], names: list[str]) -> doc.Table:
    columns = (doc.Column("Quantity", share=1), *(doc.Column(name, number=True) for name in names))
    rows = tuple(
        (_name_quantity(item["name"]), *(format_compared(item, i) for i in range(len(names)))) for item in quantities
    )
    return doc.Table(columns, rows, "Quantities", layout="grid")


def _name_quantity(name: str) -> str:
    unit = quantity_unit(name)
    return f"{quantity_label(name)} [{unit}]" if unit else quantity_label(name)


def format_compared(quantity: dict[str, Any], index: int) -> str:
    """Value of a subject with its uncertainty and its difference from the first subject.

    Parameters
    ----------
    quantity : dict
        Entry of `quantities` in comparison.json.
    index : int
        Place of the subject in the list of subjects.

    Returns
    -------
    str
        Text such as `28.12 ± 0.4 (+1.2 *)`; for several numbers their count and the largest difference.
    """
    value, width = quantity["values"][index], quantity["uncertainty"][index]
    if value is None:
        return "–"
    if isinstance(value, list):
        text = f"{len(value)} values"
    else:
        text = format_value(value) + (f" ± {format_value(width, 2)}" if isinstance(width, float) and width else "")
    difference = quantity["difference"][index]
    if index == 0 or difference is None:
        return text
    mark = " *" if quantity["beyond_uncertainty"][index] else ""
    return f"{text} ({replace_minus(f'{difference:+.3g}')}{mark})"
