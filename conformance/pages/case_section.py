"""Section of one case: verdict, criteria, figures, then tables, notes, inputs and facts of the run."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import TextTable
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.units import UNIT_FAMILIES, key_suffix
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_case_figures
from pantocheck.conformance.pages.condition_sections import build_condition_section, condition_blocks, mark_values
from pantocheck.conformance.pages.criteria_table import (
    criteria_blocks,
    list_limit_sources,
    list_value_remarks,
    reference_note,
)
from pantocheck.conformance.pages.document_facts import list_case_facts
from pantocheck.conformance.pages.first_page import FirstPage
from pantocheck.conformance.pages.frequency_section import build_frequency_section
from pantocheck.conformance.pages.line_figure import find_earlier_drawing, line_figures, scheme_figures
from pantocheck.conformance.pages.quantity_tables import build_quantity_table, list_skipped, list_uncertainty_basis
from pantocheck.conformance.pages.record_check_table import build_check_section
from pantocheck.conformance.pages.run_comparison_page import comparison_blocks
from pantocheck.conformance.pages.scope_page import describe_changes
from pantocheck.conformance.pages.source_section import build_source_section
from pantocheck.conformance.pages.two_verdicts import baseline_blocks, verification_blocks
from pantocheck.conformance.pages.verdict_marks import list_criteria, mark_case
from pantocheck.conformance.pages.verdict_reasons import describe_record, summarise_case
from pantocheck.conformance.pages.words import format_plain, format_value, name_pantograph, replace_minus
from pantocheck.conformance.results.case_facts_format import ContactLossFacts, EventFacts, StoredRange, StoredValue
from pantocheck.conformance.results.results_format import CaseResult, InputGroup

AUTHOR = "The notes and the title are the words of the author of this case and are not translated."


@dataclass(frozen=True)
class ShownCase:
    """Case with a section of its own."""

    case: CaseResult
    number: int
    """Index of the case in the results."""
    anchor: str
    """Anchor of its section."""
    earlier: tuple[CaseResult, ...]
    """Cases whose sections stand before it."""
    first_page: FirstPage
    """Content of page 1, which its section does not repeat."""


def list_shown_cases(cases: Sequence[CaseResult], first_page: FirstPage) -> list[ShownCase]:
    """Cases with a section of their own: all but those that were skipped without any value."""
    shown: list[ShownCase] = []
    for number, case in enumerate(cases):
        parts = (case.criteria, case.quantities, case.traces, case.charts, case.tables, case.uplift)
        if case.verdict != "skip" or any(parts):
            earlier = tuple(other.case for other in shown)
            shown.append(ShownCase(case, number, f"case-{number + 1}", earlier, first_page))
    return shown


def build_case_section(shown: ShownCase) -> doc.Section:
    """Section of a case."""
    case, anchor = shown.case, shown.anchor
    blocks: list[doc.Block] = [
        doc.Paragraph((doc.VerdictMark(mark_case(case)), "\N{EN SPACE}", doc.Code(case.id))),
        doc.Paragraph(" ".join(filter(None, (summarise_case(case), describe_record(case))))),
    ]
    changes = [f"{text}."] if (text := describe_changes(case)) else []
    warnings = (
        *changes,
        *(f"Limits file: {change}." for change in case.limit_changes),
        *(text for text in case.warnings if text not in shown.first_page.warnings),
    )
    blocks += doc.warn(warnings)
    blocks += condition_blocks(case)
    blocks += reference_note(case)
    if criteria := list_criteria(case, "criteria"):
        table = _list_criteria_blocks(shown, criteria)
        blocks += [doc.Section("Criteria", table)] if table else []
    if figures := tuple(draw_case_figures(case, shown.number, anchor)):
        blocks.append(doc.Section("Figures", (doc.Figures(figures),)))
    blocks += verification_blocks(case, anchor)
    blocks += baseline_blocks(case, anchor)
    blocks += comparison_blocks(case, shown.number, anchor)
    blocks += build_source_section(case.sources)
    blocks += (*_build_place_section(case.events or []), *_build_loss_section(case.contact_losses or {}))
    blocks += [doc.Section(table.caption, (_study_table(case, table),)) for table in _select_tables(case)]
    blocks += _list_details(shown)
    return doc.Section(case.title, mark_values(case, blocks), anchor=anchor, ruled=True)


PLACE_OF_VALUES = "The values, their limits and margins stand in the table of page 1."


def _list_criteria_blocks(shown: ShownCase, criteria: Sequence[Criterion]) -> tuple[doc.Block, ...]:
    """Table of the criteria of a case; remarks and sources alone of those whose table stands on page 1."""
    case, anchor, source_anchor = shown.case, shown.anchor, f"{shown.anchor}-source"
    if case.id not in shown.first_page.graded:
        return criteria_blocks(criteria, anchor, source_anchor, case)
    sources = () if shown.first_page.source else list_limit_sources(criteria, source_anchor)
    return (doc.SmallPrint(PLACE_OF_VALUES), *list_value_remarks(case, criteria, anchor), *sources)


def _list_details(shown: ShownCase) -> Iterator[doc.Section]:
    """Sections on all values and facts, folded on a screen."""
    case = shown.case
    quantities, basis = build_quantity_table(case), list_uncertainty_basis(case)
    parts = (*((doc.BulletList(basis),) if basis else ()), *((quantities,) if quantities.rows else ()))
    if parts:
        yield doc.Section("All quantities, with uncertainty by component", parts, folded=True)
    yield from build_check_section(case)
    yield from build_condition_section(case)
    yield from build_frequency_section(case.supported)
    if skipped := list_skipped(case):
        yield doc.Section("Skipped", (doc.BulletList(skipped),), folded=True)
    if notes := _list_notes(shown):
        yield doc.Section("Notes", (doc.BulletList(notes),), folded=True)
    figures = (*line_figures(case, shown.earlier), *scheme_figures(case, shown.earlier))
    drawings = (*((doc.Figures(figures),) if figures else ()), *find_earlier_drawing(case, shown.earlier))
    inputs = input_blocks(case, shown.earlier, f"{shown.anchor}-input-source")
    if drawings or inputs:
        yield doc.Section("Inputs", (*drawings, *inputs), folded=True)
    if derived := derived_blocks(case):
        yield doc.Section("Derived values", derived, folded=True)
    yield doc.Section("Run", (list_case_facts(case),), folded=True)


def _list_notes(shown: ShownCase) -> tuple[str, ...]:
    """Notes of a case; those that an earlier case has as well are counted."""
    repeated = [
        (note, next((other.id for other in shown.earlier if note in other.notes), None)) for note in shown.case.notes
    ]
    counted = {source: sum(other == source for _, other in repeated) for _, source in repeated if source is not None}
    references = [f"{count_noun(n, 'note')} as in {source}." for source, n in counted.items()]
    author = [AUTHOR] if repeated and shown.case.library in ("own", "modified") else []
    return (*(note for note, source in repeated if source is None), *references, *author)


def _select_tables(case: CaseResult) -> list[TextTable]:
    """Tables of a study, without the list of findings that the section on all findings contains."""
    graded = any(row.finding for row in case.criteria)
    return [table for table in case.tables if not (graded and table.columns[:1] == ["Finding"])]


def _study_table(case: CaseResult, table: TextTable) -> doc.Table:
    names = table.columns
    rows: Iterable[list[str]] = table.rows
    if names[-1:] == ["Source"]:
        rows = _join_sources(rows, {row.finding.tolerance for row in case.criteria if row.finding})
    shares = (2.0, 0.0, 3.0) if len(names) <= 3 else (2.0, *(1.0 for _ in names[1:]))
    columns = tuple(doc.Column(name, share) for name, share in zip(names, shares, strict=False))
    return doc.Table(columns, tuple(map(tuple, rows)))


def _join_sources(rows: Iterable[list[str]], tolerances: set[str]) -> Iterator[list[str]]:
    """Origins, one row per source; other tables have those of the inputs, and the tolerances of the findings."""
    kept = [row for row in rows if not row[0].startswith("input ") and row[-1] not in tolerances]
    others = sorted(kept, key=lambda row: row[1:])
    for rest, members in groupby(others, key=lambda row: row[1:]):
        yield [", ".join(row[0] for row in members), *rest]


# Sections of a case on the events of its record: places of the line, and contact losses.
LISTED_LOSSES = 40
"""Largest number of contact losses in the table of a page; results.json lists more."""


def _build_loss_section(losses: Mapping[str, Sequence[ContactLossFacts]]) -> tuple[doc.Block, ...]:
    """Table of the longest contact losses."""
    rows = [(name_pantograph(key), loss) for key, found in losses.items() for loss in found]
    if not rows:
        return ()
    longest = sorted(rows, key=lambda row: -row[1].duration_s)[:LISTED_LOSSES]
    text = (
        f"{len(rows)} contact losses in the unfiltered force, the longest first; a duration is a multiple of a sample. "
        "Times count from the start of the analysis section."
    )
    table = doc.make_table(
        longest,
        {
            doc.Column("Pantograph", share=1): lambda row: row[0],
            doc.Column("Place [m]", number=True): lambda row: f"{row[1].position_m:.1f}",
            doc.Column("Time [s]", number=True): lambda row: f"{row[1].time_s:.3f}",
            doc.Column("Duration [ms]", number=True): lambda row: f"{1000 * row[1].duration_s:.4g}",
            doc.Column("Lowest force [N]", number=True): lambda row: replace_minus(f"{row[1].lowest_force_N:.3g}"),
        },
    )
    blocks: list[doc.Block] = [doc.Paragraph(text), table]
    if len(rows) > len(longest):
        blocks.append(doc.Paragraph("results.json lists up to 200 losses of each pantograph."))
    return (doc.Section("Contact losses", tuple(blocks)),)


def _build_place_section(events: Sequence[EventFacts]) -> tuple[doc.Block, ...]:
    """Table of the places of the line."""
    if not events:
        return ()
    table = doc.make_table(
        events,
        {
            doc.Column("Place", share=1): lambda event: f"{event.kind.replace('_', ' ')} {event.name or ''}".strip(),
            doc.Column("From [m]", number=True): lambda event: f"{event.start_m:.1f}",
            doc.Column("To [m]", number=True): lambda event: f"{event.end_m:.1f}",
            doc.Column("Evaluation", share=2): lambda event: (
                f"left out: {event.remark}" if event.excluded else event.remark or "evaluated"
            ),
        },
    )
    return (doc.Section("Events of the line", (table,)),)


# Table of the values that the suite derives from the inputs of a case.
SHOWN_DIGITS = 5
"""Significant digits of a derived value: an uplift force to 0.01 N."""


def derived_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Table of derived values that are not quantities of the line, and by whom they were computed."""
    quantities = case.quantities.get("0", {}).values()
    if not (derived := [fact for fact in case.derived if fact.value not in quantities]):
        return ()
    table = doc.make_table(
        derived,
        {
            doc.Column("Value", share=3): lambda fact: fact.name,
            doc.Column("Result", number=True): lambda fact: format_value(fact.value, SHOWN_DIGITS),
            doc.Column("Unit"): lambda fact: fact.unit or "–",
            doc.Column("Follows from", share=4): lambda fact: fact.basis,
        },
    )
    text = "Computed by the suite from the inputs of the case. A tuned uplift force is a result of the run."
    return table, doc.SmallPrint(text)


# Inputs of a case: values of every group with their trust and source; groups of an earlier case are named only.
INPUT_COLUMNS = (
    doc.Column("Group", share=1.5),
    doc.Column("Values", share=5),
    doc.Column("Trust"),
    doc.Column("Source"),
)
PROVISIONAL = "○"
"""Mark of a single value that is not traced to a printed source."""

PROVISIONAL_KEY = f"{PROVISIONAL}: value not traced to a printed source."

KEY_UNITS = {
    "1_s": "1/s",
    "1_m": "1/m",
    "pct": "%",
    "C": "°C",
    "K": "K",
    "1_K": "1/K",
    "kg_m2": "kg m2",
    "N_m_rad": "N m/rad",
    "N_m_s_rad": "N m s/rad",
    "m_N_s": "m/(N s)",
    "m3": "m3",
    "deg": "°",
    "dB": "dB",
} | {key_suffix(symbol): symbol for family in UNIT_FAMILIES for symbol in family.factors}
"""Units by the end of a key."""


def input_blocks(case: CaseResult, earlier: tuple[CaseResult, ...], anchor: str) -> tuple[doc.Block, ...]:
    """Inputs of a case with their sources, whose anchors begin with `anchor`, and groups that an earlier case has."""
    single, groups = _split_single_values(case.inputs)
    repeated: dict[str, list[str]] = defaultdict(list)
    shown = []
    for group in groups:
        other = next((other.id for other in earlier if group in other.inputs), None)
        if other is None:
            shown.append(group)
        else:
            repeated[other].append(group.group)
    sources = list(dict.fromkeys(group.source for group in shown))
    rows = tuple(_row(group, single, sources, anchor) for group in shown)
    marked = PROVISIONAL_KEY if any(PROVISIONAL in str(row[1]) for row in rows) else ""
    texts = [*filter(None, [marked]), *(f"As in {name}: {', '.join(names)}." for name, names in repeated.items())]
    return (
        *((doc.Table(INPUT_COLUMNS, rows),) if rows else ()),
        *((doc.NumberedList("Sources of the inputs", tuple(sources), anchor),) if sources else ()),
        *((doc.SmallPrint(" ".join(texts)),) if texts else ()),
    )


def _split_single_values(inputs: Sequence[InputGroup]) -> tuple[set[str], list[InputGroup]]:
    """Dotted names of single provisional values whose group shows them, and all other groups."""
    stated = {f"{group.group}.{key}".split("[")[0] for group in inputs for key in group.values}
    tops = {name for name in (group.group for group in inputs if not group.values) if _is_stated(name, stated)}
    return tops, [group for group in inputs if group.group not in tops]


def _is_stated(name: str, stated: set[str]) -> bool:
    return any(key == name or key.startswith(f"{name}.") for key in stated)


def _row(group: InputGroup, single: set[str], sources: list[str], anchor: str) -> tuple[doc.RichText, ...]:
    number = sources.index(group.source) + 1
    values = [
        f"{_describe_value(key, value)}{f' {PROVISIONAL}' if _is_single(group.group, key, single) else ''}"
        for key, value in group.values.items()
    ]
    source = doc.Link(f"[{number}]", f"{anchor}-{number}")
    return doc.Code(group.group), "; ".join(values) or "–", doc.TrustMark(group.trust), source


def _is_single(group: str, key: str, single: set[str]) -> bool:
    parts = key.split(".")
    return any(".".join((group, *parts[:n])) in single for n in range(1, len(parts) + 1))


def _describe_value(key: str, value: StoredValue) -> str:
    """Name, value and unit of an input: `tension 20000 N`."""
    suffix = max((unit for unit in KEY_UNITS if key.endswith(f"_{unit}")), key=len, default=None)
    name = key.removesuffix(f"_{suffix}").replace("_", " ").replace(".", ", ")
    return f"{name} {_format_input(value)} {KEY_UNITS[suffix] if suffix else ''}".rstrip()


def _format_input(value: StoredValue) -> str:
    if isinstance(value, StoredRange):
        lowest, highest = format_plain(value.lowest), format_plain(value.highest)
        return f"{value.count} values, {lowest} to {highest}"
    if isinstance(value, list):
        return ", ".join(map(_format_input, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return format_plain(value) if isinstance(value, int | float) else str(value).replace("_", " ")
