"""Table of the criteria of a case."""

from dataclasses import dataclass
from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.margin_bar import draw_margin_bar
from pantocheck.conformance.reports.page_text import format_beside_limits, format_limits, format_value
from pantocheck.conformance.reports.words import name_owner, quantity_label, read_words

MARGIN_KEY = (
    "Margin: distance to the nearer limit over half the distance between the limits; 1 in the middle, 0 on a limit, "
    "negative outside. In the bars, the band lies between the limits; a disc is inside, a cross is outside, an open "
    "ring does not count, an arrow lies beyond the drawing, the whisker is the "
)
SHORT_NAMES = {"Discretisation error": "Discr.\nerror", "Uncertainty (95 %)": "Uncer-\ntainty"}
"""Headings of the errors on paper."""


@dataclass(frozen=True)
class CriterionTexts:
    """Texts of one criterion."""

    quantity: str
    label: str
    pantograph: str
    value: str
    error: str
    limits: str
    margin: str
    remarks: tuple[str, ...]


def describe_criterion(criterion: dict[str, Any]) -> CriterionTexts:
    """Texts of a criterion of results.json."""
    value, lower, upper = criterion["value"], criterion["lower"], criterion["upper"]
    error = find_error(criterion)
    unit = "" if value is None else criterion.get("unit") or ""
    close = criterion["close"] if is_close(criterion) else ()
    return CriterionTexts(
        quantity=criterion["quantity"],
        label=criterion_title(criterion),
        pantograph=name_owner(criterion).removeprefix("pantograph "),
        value=f"{format_beside_limits(value, lower, upper)} {unit}".rstrip(),
        error="–" if error is None else f"± {format_value(error, 2)}",
        limits=format_limits(lower, upper),
        margin="–" if criterion.get("margin") is None else format_signed(criterion["margin"]),
        remarks=tuple(filter(None, (criterion.get("reason"), *close, remark_shift(criterion)))),
    )


def criteria_blocks(case: dict[str, Any], anchor: str) -> tuple[doc.Block, ...]:
    """The table of criteria, its key and the sources of the limits.

    Parameters
    ----------
    case : dict
        One entry of `cases` of results.json.
    anchor : str
        Anchor of the section of the case.
    """
    criteria = case["criteria"]
    sources = list(dict.fromkeys(criterion["source"] for criterion in criteria if criterion.get("source")))
    error = error_name(case)
    columns = (
        doc.Column("Quantity", share=1),
        doc.Column("Pantograph", short="Pant."),
        doc.Column("Value", number=True),
        doc.Column(error, number=True, short=SHORT_NAMES[error]),
        doc.Column("Limits", number=True),
        doc.Column("Margin"),
        doc.Column("Verdict"),
        doc.Column("Trust"),
        doc.Column("Source"),
    )
    rows = tuple(_row(criterion, sources, anchor) for criterion in criteria)
    blocks: list[doc.Block] = [
        doc.Table(columns, rows, layout="cards"),
        doc.SmallPrint(f"{MARGIN_KEY}{error.lower()}."),
    ]
    if sources:
        blocks.append(doc.NumberedList("Sources of the limits", tuple(sources), f"{anchor}-source"))
    return tuple(blocks)


def _row(criterion: dict[str, Any], sources: list[str], anchor: str) -> tuple[doc.RichText, ...]:
    texts = describe_criterion(criterion)
    limited = criterion["lower"] is not None or criterion["upper"] is not None
    source = sources.index(criterion["source"]) + 1 if criterion.get("source") else None
    return (
        (f"{texts.label} ", doc.Code(texts.quantity), *map(doc.Remark, texts.remarks)),
        texts.pantograph,
        texts.value,
        texts.error,
        texts.limits,
        (_bar(criterion, texts), f" {texts.margin}") if limited and criterion["value"] is not None else texts.margin,
        doc.VerdictMark(criterion["verdict"]),
        doc.TrustMark(criterion["trust"] if limited else ""),
        "–" if source is None else doc.Link(f"[{source}]", f"{anchor}-source-{source}"),
    )


def _bar(criterion: dict[str, Any], texts: CriterionTexts) -> doc.Drawing:
    error = find_error(criterion)
    meaning = read_words()["verdict"][criterion["verdict"]]["meaning"]
    value, lower, upper = criterion["value"], criterion["lower"], criterion["upper"]
    shown = format_beside_limits(value, lower, upper)
    drawing = draw_margin_bar(value, lower, upper, error, criterion["verdict"])
    return doc.Drawing(drawing, f"{meaning}: {shown}, limits {texts.limits}")


def error_name(case: dict[str, Any]) -> str:
    """Heading of the errors of a case: their uncertainty, or their discretisation error."""
    uncertain = any(criterion.get("uncertainty") is not None for criterion in case["criteria"])
    return "Uncertainty (95 %)" if uncertain else "Discretisation error"


def find_error(criterion: dict[str, Any]) -> float | None:
    """Error of a value: from the length of a record, or else from mesh and time step of a simulation."""
    if criterion.get("uncertainty") is not None:
        return float(criterion["uncertainty"])
    return criterion.get("discretisation_error")


def criterion_title(criterion: dict[str, Any]) -> str:
    """Label of the quantity, or of its drift from a baseline."""
    drift = "" if criterion.get("baseline") is None else ", drift from the baseline"
    return f"{quantity_label(criterion['quantity'])}{drift}"


def format_signed(margin: float) -> str:
    """A margin with its sign and two decimals, three or more where two would show no distance to the limit."""
    for decimals in range(2, 13):
        text = f"{margin:+.{decimals}f}"
        if margin == 0 or float(text) != 0:
            return "0.00" if margin == 0 else text.replace("-", "−")
    return f"{margin:+.1e}".replace("-", "−")


def is_close(criterion: dict[str, Any]) -> bool:
    """Whether a counted value is closer to a limit than one of its errors, so that its verdict could be reversed."""
    return bool(criterion.get("close")) and criterion["verdict"] in ("pass", "fail")


def remark_shift(criterion: dict[str, Any]) -> str | None:
    """A remark on the change of a value when the analysis section is shifted, where the case asks for it."""
    spread = criterion.get("spread")
    if spread is None or criterion["value"] is None:
        return None
    change = f"{format_value(spread, 2)} {criterion.get('unit') or ''}".rstrip()
    return f"changes by up to {change} when the analysis section is shifted"
