"""Table of the criteria of a case."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from pantocheck.conformance.core.criterion import ComponentName, Criterion
from pantocheck.conformance.core.near_limit import REMEDIES, find_largest_component
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.margin_bar import draw_margin_bar
from pantocheck.conformance.pages.verdict_marks import mark_rows
from pantocheck.conformance.pages.words import (
    format_beside_limits,
    format_plain,
    format_value,
    name_owner,
    quantity_label,
    read_words,
    replace_minus,
)
from pantocheck.conformance.quantities.limit_text import format_criterion_margin
from pantocheck.conformance.quantities.uncertainty import DRAWS, UNKNOWN_BASIS
from pantocheck.conformance.results.incomplete_uncertainty import EXACT_WIDTH, describe_half_width, list_missing
from pantocheck.conformance.results.results_format import CaseResult

MARGIN_KEY = (
    "Margin: distance to the nearer limit, divided by half the distance between the limits. It is 1 in the middle, "
    "0 on a limit and negative outside. With one limit, the distance is divided by this limit; if it is 0, the margin "
    "is the distance itself with its unit. A dash: the limit is a single value, and the value lies on it. Bars: the "
    "grey band shows the range between the limits. A disc is a value inside, a cross a value outside, an open ring a "
    "value that does not count, an arrow a value beyond the drawing. The whisker is the uncertainty of the value, "
    "or its discretisation error where no uncertainty is known. The strip below is the joint sample of all components "
    "of the uncertainty: the darker, the likelier."
)
"""Meaning of the margins and bars of all tables of criteria."""
DECIDES = "decides the verdict"
"""Role of a verdict or of a step."""
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
    """Texts of a criterion of results.json."""
    value, lower, upper = criterion.value, criterion.lower, criterion.upper
    error, margin = criterion.error, criterion.margin
    missing = list_missing(basis, criterion.uncertainty, criterion.trust)
    unit = "" if value is None else criterion.unit
    shown, limits = format_beside_limits(value, lower, upper)
    if lower is not None and upper and lower == -upper:
        limits = f"± {limits.rpartition(' ')[2]}"
    ascii_margin = format_criterion_margin(margin, lower, upper, criterion.unit)
    readings = criterion.readings if criterion.depends_on_reading else []
    remarks = (criterion.reason, *readings, _remark_limit(criterion))
    return CriterionTexts(
        label=criterion_title(criterion),
        pantograph=name_owner(criterion).removeprefix("pantograph "),
        value=f"{shown} {unit}".rstrip(),
        error="–" if error is None else _format_error(criterion, error, missing),
        limits=limits,
        margin="–" if ascii_margin == "-" else replace_minus(ascii_margin),
        trust="" if lower is None and upper is None else criterion.trust or "",
        remarks=tuple(filter(None, remarks)),
    )


def _format_error(criterion: Criterion, error: float, missing: Sequence[str]) -> str:
    text = describe_half_width(error, format_value(error, 2), missing, criterion.quantity)
    if text in (EXACT_WIDTH, UNKNOWN_BASIS):
        return text
    if (by_line := criterion.components.get("line")) is None:
        return f"± {text}"
    numerics = math.hypot(*(width for name, width in criterion.components.items() if name != "line"))
    return f"± {format_value(numerics, 2)} (numerics) ± {format_value(by_line, 2)} (line as measured)"


VALUE_HEADINGS = ("Value", "Limits")
DEVIATION_HEADINGS = ("Deviation", "Tolerance")
"""Headings of values and their limits, and of both as distances from the middle of the limits."""


def criteria_blocks(
    criteria: Sequence[Criterion],
    anchor: str,
    source_anchor: str,
    case: CaseResult | None = None,
    headings: tuple[str, str] = VALUE_HEADINGS,
) -> tuple[doc.Block, ...]:
    """The table of criteria with the facts that hold for all of them, and the sources of their limits.

    Args:
        criteria: Criteria of one of the verdicts of a case, or of a step of a procedure.
        anchor: Anchor of the section of the case or step.
        source_anchor: Anchor of the sources, before their number.
        case: Case of the criteria; None: they belong to no case.
        headings: Headings of values and limits.
    """
    sources = list(dict.fromkeys(criterion.source for criterion in criteria if criterion.source))
    origins = {(criterion.trust, criterion.source) for criterion in criteria}
    error, (value, limits) = error_name(criteria), headings
    columns = (
        doc.Column("Quantity", share=1),
        doc.Column("Pantograph", short="Pant."),
        doc.Column(value, number=True),
        doc.Column(error, number=True),
        doc.Column(limits, number=True),
        *map(doc.Column, ("Margin", "Verdict", "Trust", "Source")),
    )
    basis = NO_BASIS if case is None else case.uncertainty_basis
    rows = tuple(
        _row(criterion, basis, sources, (source_anchor, () if case is None else _link_place(case, criterion, anchor)))
        for criterion in criteria
    )
    common: tuple[doc.Block, ...] = (doc.NumberedList("Sources of the limits", tuple(sources), source_anchor),)
    if len(origins) == 1 and sources and (trust := criteria[0].trust):
        columns, rows = columns[:-2], tuple(row[:-2] for row in rows)
        common = (doc.SmallPrint(("All limits: ", doc.TrustMark(trust), f" {sources[0]}")),)
    table = doc.Table(columns, rows, layout="cards")
    if case is not None and headings == VALUE_HEADINGS:
        table = insert_reference(case, table, criteria)
    return (*state_causes(criteria), table, *(common if sources else ()))


def list_value_remarks(case: CaseResult, criteria: Sequence[Criterion], anchor: str) -> tuple[doc.Block, ...]:
    """Causes, places and remarks of the graded values of a case that page 1 shows; `anchor` is its section."""
    items: list[doc.RichText] = []
    for row in criteria:
        texts, place = describe_criterion(row, case.uncertainty_basis), _link_place(case, row, anchor)
        if place or texts.remarks:
            remarks = f": {'; '.join(texts.remarks)}" if texts.remarks else ""
            items.append((f"{texts.label} ", doc.Code(row.quantity), f", {name_owner(row)}", *place, remarks))
    listed = (doc.BulletList(tuple(items)),) if items else ()
    return (*state_causes(criteria), *listed)


def list_limit_sources(criteria: Sequence[Criterion], anchor: str) -> tuple[doc.Block, ...]:
    """Sources of the limits of criteria, with the names of the values of each."""
    names: dict[str, list[str]] = {}
    for row in criteria:
        names.setdefault(f"{row.trust}: {row.source}" if row.source else "", []).append(criterion_title(row))
    items = tuple(f"{source} ({'; '.join(dict.fromkeys(of))})" for source, of in names.items() if source)
    return (doc.NumberedList("Sources of the limits", items, anchor),) if items else ()


def state_causes(criteria: Sequence[Criterion]) -> tuple[doc.Block, ...]:
    """Sentences on the causes of close values."""
    texts = describe_close(criteria, criterion_title)
    return (doc.SmallPrint(" ".join(texts)),) if texts else ()


def describe_close(criteria: Sequence[Criterion], name: Callable[[Criterion], str]) -> list[str]:
    """Sentences on the values closer to a limit than their uncertainty, one for each largest component.

    Args:
        criteria: Criteria of one of the verdicts of a case.
        name: Function that gives the name of the value of a criterion.
    """
    groups: dict[str, list[str]] = {}
    for row in criteria:
        if row.is_close:
            cause = find_largest_component(row.components, row.limit_uncertainty)
            chance = "" if row.conformity is None else f" ({format_probability(row.conformity)} inside the limits)"
            groups.setdefault(cause, []).append(f"{name(row)}{chance}")
    return [
        f"Closer to a limit than the uncertainty (mostly {cause}): {'; '.join(dict.fromkeys(names))}. "
        f"{REMEDIES[cause].capitalize()} could reverse the verdict."
        for cause, names in groups.items()
    ]


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
    return (
        (f"{texts.label} ", doc.Code(criterion.quantity), *place, *map(doc.Remark, texts.remarks)),
        texts.pantograph,
        texts.value,
        texts.error,
        texts.limits,
        draw_margin(criterion, texts),
        mark_criterion(criterion),
        doc.TrustMark(texts.trust),
        "–" if number is None else doc.Link(f"[{number}]", f"{source_anchor}-{number}"),
    )


def count_inside(rows: Iterable[Criterion]) -> str:
    """Sentence on the numbers of values with a limit that counts, and of those inside; empty without such a value."""
    counts = Counter(row.verdict for row in rows)
    counted = sum(counts[verdict] for verdict in ("pass", "undecided", "fail", "skip"))
    return f"{counts['pass']} of {counted} values inside." if counted else ""


def mark_criterion(row: Criterion) -> doc.VerdictMark:
    """Verdict of one criterion as a mark."""
    return doc.VerdictMark(mark_rows(row.verdict, [row]))


def draw_margin(criterion: Criterion, texts: CriterionTexts) -> doc.RichText:
    """Margin of a criterion behind its bar; without limits or a value, the text alone."""
    if texts.limits == "none" or criterion.value is None:
        return texts.margin
    return (_bar(criterion, criterion.value), f" {texts.margin}")


def _bar(criterion: Criterion, value: float) -> doc.Drawing:
    lower, upper, verdict = criterion.lower, criterion.upper, criterion.verdict
    meaning = read_words()["verdict"][verdict]["meaning"]
    text = "{}, limits {}".format(*format_beside_limits(value, lower, upper))
    chance = criterion.conformity
    inside = "" if chance is None else f", inside the limits with a probability of {format_probability(chance)}"
    drawing = draw_margin_bar(value, lower, upper, criterion.error, verdict, criterion.draws)
    return doc.Drawing(drawing, f"{meaning}: {text}{inside}")


def format_probability(probability: float) -> str:
    """Share of a joint sample; one of 0 or 1 is stated as the bound that its size allows."""
    bound = 1 / DRAWS
    if probability < bound:
        return f"below {bound:g}"
    return f"above {1 - bound:g}" if probability > 1 - bound else f"{probability:.2g}"


def error_name(criteria: Sequence[Criterion]) -> str:
    """Heading of the errors of criteria: their uncertainty, or their discretisation error."""
    uncertain = any(criterion.uncertainty is not None for criterion in criteria)
    return "Uncertainty" if uncertain else "Discretisation error"


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


def name_figure(anchor: str, owner: str) -> str:
    """Anchor of the figure with the force of a pantograph, or with the uplift for the line "0"."""
    return f"{anchor}-uplift" if owner == "0" else f"{anchor}-force-{owner}"


# Values of the reference simulator beside those of the system under test, on request; they decide no verdict.
REFERENCE_PLACE = 4
"""Place of the column in a table of criteria: behind value and error."""


def reference_note(case: CaseResult) -> tuple[doc.Block, ...]:
    """Sentence on the reference of a case; empty if none was requested."""
    reference = case.reference
    if reference is None:
        return ()
    name = f"{reference.name} {reference.version}"
    if reference.reason is not None:
        return (doc.Paragraph(f"{name}: no values for comparison, {reference.reason}."),)
    return (doc.Paragraph(f"Reference: values of the {name}, for information. They take part in no verdict."),)


def insert_reference(case: CaseResult, table: doc.Table, criteria: Sequence[Criterion]) -> doc.Table:
    """Table of criteria with a column of the values of the reference, if the case has them."""
    if not has_reference(case):
        return table
    column = doc.Column("Reference", number=True, short="Refer-\nence")
    values = [format_value(find_reference(case, item)) for item in criteria]
    return replace(
        table,
        columns=(*table.columns[:REFERENCE_PLACE], column, *table.columns[REFERENCE_PLACE:]),
        rows=tuple(
            (*row[:REFERENCE_PLACE], value, *row[REFERENCE_PLACE:])
            for row, value in zip(table.rows, values, strict=True)
        ),
    )


def has_reference(case: CaseResult) -> bool:
    """Whether a case has values of the reference."""
    return case.reference is not None and case.reference.reason is None


def find_reference(case: CaseResult, criterion: Criterion) -> float | None:
    """Value of the reference for a criterion; None if it has none."""
    quantities = {} if case.reference is None else case.reference.quantities
    return select_item(quantities.get(str(criterion.pantograph), {}).get(criterion.quantity), criterion.item)
