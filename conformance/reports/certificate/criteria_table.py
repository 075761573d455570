"""Table of the criteria of a case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from pantocheck.conformance.quantities.limit_text import format_criterion_margin
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.case_figures import name_figure
from pantocheck.conformance.reports.certificate.reference_values import insert_reference
from pantocheck.conformance.reports.figures.margin_bar import draw_margin_bar
from pantocheck.conformance.reports.page_text import format_beside_limits, format_plain, format_value, replace_minus
from pantocheck.conformance.reports.words import name_owner, quantity_label, read_words
from pantocheck.conformance.results.criterion_format import ComponentName, Criterion
from pantocheck.conformance.results.incomplete_uncertainty import (
    explain_mark,
    list_missing,
    list_unknown,
    mark_half_width,
)
from pantocheck.conformance.results.results_format import CaseResult

MARGIN_KEY = (
    "Margin: distance to the nearer limit, divided by half the distance between the limits. It is 1 in the middle, "
    "0 on a limit and negative outside. With one limit, the distance is divided by this limit; if it is 0, the margin "
    "is the distance itself with its unit. Bars: the grey band shows the range between the limits. A disc is a value "
    "inside, a cross a value outside, an open ring a value that does not count, an arrow a value beyond the drawing. "
    "The whisker is the uncertainty of the value, or its discretisation error where no uncertainty is known."
)
"""Meaning of the margins and bars of all tables of criteria."""
SHORT_NAMES = {"Discretisation error": "Discr.\nerror", "Uncertainty (95 %)": "Uncer-\ntainty"}
"""Headings of the errors on paper."""
Basis = Mapping[ComponentName, str]
"""How each component of an uncertainty was determined, or why it is not known: `uncertainty_basis` of a case."""

NO_BASIS: Basis = MappingProxyType({})
"""Basis of the uncertainty of criteria that belong to no case."""


@dataclass(frozen=True)
class CriterionTexts:
    """Texts of one criterion."""

    label: str
    pantograph: str
    value: str
    error: str
    limits: str
    margin: str
    trust: str
    """Trust of the limits; empty if there are none, or if they are bounds of a baseline."""
    remarks: tuple[str, ...]


def describe_criterion(criterion: Criterion, basis: Basis = NO_BASIS) -> CriterionTexts:
    """Texts of a criterion of results.json.

    Args:
        criterion: Criterion of results.json.
        basis: `uncertainty_basis` of its case.
    """
    value, lower, upper = criterion.value, criterion.lower, criterion.upper
    error, margin = criterion.error, criterion.margin
    missing = list_missing(basis, criterion.uncertainty, criterion.trust)
    unit = "" if value is None else criterion.unit
    shown, limits = format_beside_limits(value, lower, upper)
    ascii_margin = format_criterion_margin(margin, lower, upper, criterion.unit)
    close = criterion.close if criterion.is_close else ()
    return CriterionTexts(
        label=criterion_title(criterion),
        pantograph=name_owner(criterion).removeprefix("pantograph "),
        value=f"{shown} {unit}".rstrip(),
        error="–" if error is None else mark_half_width(error, format_value(error, 2), missing, "± "),
        limits=limits,
        margin="–" if margin is None else replace_minus(ascii_margin),
        trust="" if lower is None and upper is None else criterion.trust or "",
        remarks=tuple(filter(None, (criterion.reason, *close, remark_shift(criterion), _remark_limit(criterion)))),
    )


def criteria_blocks(
    criteria: Sequence[Criterion], anchor: str, source_anchor: str, case: CaseResult | None = None
) -> tuple[doc.Block, ...]:
    """The table of criteria and the sources of their limits.

    Args:
        criteria: Criteria of one of the verdicts of a case, or of a step of a procedure.
        anchor: Anchor of the section of the case or step.
        source_anchor: Anchor of the sources, before their number.
        case: Case of the criteria; None: they belong to no case.
    """
    sources = list(dict.fromkeys(criterion.source for criterion in criteria if criterion.source))
    error = error_name(criteria)
    columns = (
        doc.Column("Quantity", share=1),
        doc.Column("Pantograph", short="Pant."),
        doc.Column("Value", number=True),
        doc.Column(error, number=True, short=SHORT_NAMES[error]),
        doc.Column("Limits", number=True),
        *map(doc.Column, ("Margin", "Verdict", "Trust", "Source")),
    )
    basis = NO_BASIS if case is None else case.uncertainty_basis
    rows = tuple(
        _row(criterion, basis, sources, (source_anchor, () if case is None else _link_place(case, criterion, anchor)))
        for criterion in criteria
    )
    table = doc.Table(columns, rows, layout="cards")
    if case is not None:
        table = insert_reference(case, table, criteria)
    listed = (doc.NumberedList("Sources of the limits", tuple(sources), source_anchor),) if sources else ()
    return (table, *note_incomplete(criteria, basis), *listed)


def note_incomplete(criteria: Sequence[Criterion], basis: Basis) -> tuple[doc.Block, ...]:
    """Explanation of the mark of half-widths that lack a component; empty if none of the criteria has the mark."""
    missing = [list_missing(basis, row.uncertainty, row.trust) for row in criteria]
    return (doc.SmallPrint(explain_mark(list_unknown(basis))),) if any(missing) else ()


def _link_place(case: CaseResult, criterion: Criterion, anchor: str) -> tuple[doc.Inline, ...]:
    """Link to the figure that shows the place of an extreme; empty for a quantity without a place."""
    owner = str(criterion.pantograph)
    place = case.places.get(owner, {}).get(criterion.quantity)
    if place is None:
        return ()
    if place.time_s is not None:
        owner = "0"
    drawn = any(support.time_s for support in case.uplift) if owner == "0" else owner in case.traces
    if not drawn:
        return ()
    return (
        " ",
        doc.Link(f"at {format_plain(round(place.position_m, 1))} m", name_figure(anchor, owner)),
    )


def _row(
    criterion: Criterion, basis: Basis, sources: list[str], links: tuple[str, tuple[doc.Inline, ...]]
) -> tuple[doc.RichText, ...]:
    texts, (source_anchor, place) = describe_criterion(criterion, basis), links
    number = sources.index(criterion.source) + 1 if criterion.source else None
    bar = None if texts.limits == "none" or criterion.value is None else _bar(criterion, criterion.value)
    return (
        (f"{texts.label} ", doc.Code(criterion.quantity), *place, *map(doc.Remark, texts.remarks)),
        texts.pantograph,
        texts.value,
        texts.error,
        texts.limits,
        texts.margin if bar is None else (bar, f" {texts.margin}"),
        doc.VerdictMark(criterion.verdict),
        doc.TrustMark(texts.trust),
        "–" if number is None else doc.Link(f"[{number}]", f"{source_anchor}-{number}"),
    )


def _bar(criterion: Criterion, value: float) -> doc.Drawing:
    lower, upper, verdict = criterion.lower, criterion.upper, criterion.verdict
    meaning = read_words()["verdict"][verdict]["meaning"]
    text = "{}, limits {}".format(*format_beside_limits(value, lower, upper))
    return doc.Drawing(draw_margin_bar(value, lower, upper, criterion.error, verdict), f"{meaning}: {text}")


def error_name(criteria: Sequence[Criterion]) -> str:
    """Heading of the errors of criteria: their uncertainty, or their discretisation error."""
    uncertain = any(criterion.uncertainty is not None for criterion in criteria)
    return "Uncertainty (95 %)" if uncertain else "Discretisation error"


def criterion_title(criterion: Criterion) -> str:
    """Label of the quantity, or of its drift from a baseline."""
    drift = "" if criterion.baseline is None else ", drift from the baseline"
    return f"{quantity_label(criterion.quantity)}{drift}"


def _remark_limit(criterion: Criterion) -> str | None:
    """A remark on the uncertainty of the measurement behind a limit, if it is known."""
    if not criterion.limit_uncertainty:
        return None
    width = f"{format_value(criterion.limit_uncertainty, 2)} {criterion.unit}".rstrip()
    return f"uncertainty of the measurement ± {width}"


def remark_shift(criterion: Criterion) -> str | None:
    """A remark on the change of a value over the compared spans of its case, if it has any."""
    if criterion.spread is None or criterion.value is None:
        return None
    change = f"{format_value(criterion.spread, 2)} {criterion.unit}".rstrip()
    return f"changes by up to {change} when the analysis section is shifted span by span"
