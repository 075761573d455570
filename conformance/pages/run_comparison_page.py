"""Report on a comparison of runs, from comparison.json."""

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import clean_model
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import (
    format_plain,
    format_signed,
    format_value,
    name_pantograph,
    quantity_label,
    quantity_unit,
)
from pantocheck.conformance.results.comparison_format import (
    ComparedOwner,
    ComparedQuantity,
    ComparedSource,
    ForceAgreement,
    RunComparison,
)

RUN_COMPARISON_SCOPE = (
    "The comparison judges nothing: it has no limits and no verdict. A number in parentheses is the difference from "
    "the first subject. An asterisk marks a difference that exceeds the joint 95 % uncertainty of both values. "
    "The uncertainty of a record is that of its length; its discretisation error is not known."
)


def build_run_comparison(results: RunComparison) -> doc.Document:
    """The report on the content of comparison.json."""
    results = clean_model(results)
    names = [subject.name for subject in results.subjects]
    header = doc.PlainHeader("Comparison of runs", f"{', '.join(names[1:])} beside {names[0]}.")
    facts = {subject.name: _describe_subject(subject) for subject in results.subjects}
    suite = results.suite
    facts |= {"Suite": f"Pantocheck {suite.version}", "Digest of the suite": suite.digest}
    blocks: list[doc.Block] = [doc.Paragraph(RUN_COMPARISON_SCOPE), doc.Facts(tuple(facts.items()))]
    for case in results.cases:
        owners = [_build_owner(owner, names) for owner in case.owners if owner.quantities]
        blocks.append(doc.Section(case.id or "Records", (*doc.warn(case.notes), *owners)))
    return doc.Document(header.headline, header, tuple(blocks))


def _describe_subject(subject: ComparedSource) -> str:
    return f"{subject.source}, {subject.digest}" if subject.digest else str(subject.source)


def _build_owner(owner: ComparedOwner, names: list[str]) -> doc.Section:
    """Figures, agreement and quantities of a pantograph or of the line."""
    blocks: list[doc.Block] = []
    if owner.charts:
        figures = (
            doc.Figure(draw_chart(chart), chart.alternative, chart.caption, chart.wide) for chart in owner.charts
        )
        blocks.append(doc.Figures(tuple(figures)))
    if owner.reasons:
        blocks.append(doc.BulletList(tuple(owner.reasons)))
    if owner.agreements:
        blocks.append(_build_agreement_table(owner.agreements, names[0]))
    blocks.append(_build_quantity_table(owner.quantities, names))
    return doc.Section(name_pantograph(owner.number).capitalize(), tuple(blocks))


def _build_agreement_table(agreements: tuple[ForceAgreement, ...], first: str) -> doc.Table:
    rows = [(agreement, band) for agreement in agreements for band in agreement.bands]
    cells = {
        "Subject": lambda row: row[0].subject,
        "Band [Hz]": lambda row: f"{format_plain(row[1].low_Hz)} to {format_plain(row[1].high_Hz)}",
        f"RMS of {first} [N]": lambda row: format_value(row[1].first_N),
        "RMS of the subject [N]": lambda row: format_value(row[1].other_N),
        "RMS of the difference [N]": lambda row: format_value(row[1].difference_N),
        "Correlation of the whole force": lambda row: format_value(row[0].correlation, 3),
    }
    return doc.make_grid("Agreement of the forces at the same positions", rows, cells)


def _build_quantity_table(quantities: tuple[ComparedQuantity, ...], names: list[str]) -> doc.Table:
    columns = (doc.Column("Quantity", share=1), *(doc.Column(name, number=True) for name in names))
    rows = tuple(
        (_name_quantity(item.name), *(format_compared(item, i) for i in range(len(names)))) for item in quantities
    )
    return doc.Table(columns, rows, "Quantities", layout="grid")


def _name_quantity(name: str) -> str:
    unit = quantity_unit(name)
    return f"{quantity_label(name)} [{unit}]" if unit else quantity_label(name)


def format_compared(quantity: ComparedQuantity, index: int) -> str:
    """Value of a subject with its uncertainty and its difference from the first subject.

    Returns:
        Text such as `28.12 ± 0.4 (+1.2 *)`; for several numbers their count and the largest difference.
    """
    value, width = quantity.values[index], quantity.uncertainty[index]
    if value is None:
        return "–"
    if isinstance(value, tuple):
        text = f"{len(value)} values"
    else:
        text = format_value(value) + (f" ± {format_value(width, 2)}" if isinstance(width, float) and width else "")
    difference = quantity.difference[index]
    if index == 0 or difference is None:
        return text
    mark = " *" if quantity.beyond_uncertainty[index] else ""
    return f"{text} ({format_signed(difference)}{mark})"
