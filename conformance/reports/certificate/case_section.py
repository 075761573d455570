"""Section of one case: verdict, criteria, figures, then tables, notes, inputs and facts of the run."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.case_facts import list_case_facts
from pantocheck.conformance.reports.certificate.case_figures import draw_case_figures
from pantocheck.conformance.reports.certificate.comparison_section import comparison_blocks
from pantocheck.conformance.reports.certificate.criteria_table import criteria_blocks
from pantocheck.conformance.reports.certificate.derived_table import derived_blocks
from pantocheck.conformance.reports.certificate.event_section import event_blocks
from pantocheck.conformance.reports.certificate.input_section import input_blocks
from pantocheck.conformance.reports.certificate.line_view import line_figures, line_reference
from pantocheck.conformance.reports.certificate.pantograph_scheme import scheme_figures
from pantocheck.conformance.reports.certificate.quantity_tables import (
    build_band_table,
    build_quantity_table,
    list_skipped,
)
from pantocheck.conformance.reports.certificate.reference_values import reference_note
from pantocheck.conformance.reports.certificate.scope_page import describe_changes
from pantocheck.conformance.reports.certificate.two_verdicts import baseline_blocks, list_criteria, verification_blocks
from pantocheck.conformance.reports.certificate.uncertainty_table import uncertainty_blocks
from pantocheck.conformance.reports.certificate.verdict_reasons import describe_record, summarise_case
from pantocheck.conformance.results.figure_data import TextTable
from pantocheck.conformance.results.results_format import CaseResult


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


def list_shown_cases(cases: Sequence[CaseResult]) -> list[ShownCase]:
    """Cases with a section of their own: all but those that were skipped without any value."""
    shown: list[ShownCase] = []
    for number, case in enumerate(cases):
        if case.verdict != "skip" or any(_list_shown_parts(case)):
            earlier = tuple(other.case for other in shown)
            shown.append(ShownCase(case, number, f"case-{number + 1}", earlier))
    return shown


def _list_shown_parts(case: CaseResult) -> tuple[object, ...]:
    """Parts of a case that its section shows."""
    return (case.criteria, case.quantities, case.traces, case.charts, case.tables, case.uplift)


def build_case_section(shown: ShownCase) -> doc.Section:
    """Section of a case."""
    case, anchor = shown.case, shown.anchor
    blocks: list[doc.Block] = [
        doc.Paragraph((doc.VerdictMark(case.verdict), "\N{EN SPACE}", doc.Code(case.id))),
        doc.Paragraph(" ".join(filter(None, (summarise_case(case), describe_record(case))))),
    ]
    changes = [f"{text}."] if (text := describe_changes(case)) else []
    warnings = (*changes, *(f"Limits file: {change}." for change in case.limit_changes), *case.warnings)
    if warnings:
        blocks.append(doc.WarningBox(warnings))
    blocks += reference_note(case)
    if criteria := list_criteria(case, "criteria"):
        table = criteria_blocks(criteria, anchor, f"{anchor}-source", case)
        blocks.append(doc.Section("Criteria", table))
    if figures := tuple(draw_case_figures(case, shown.number, anchor)):
        blocks.append(doc.Section("Figures", (doc.Figures(figures),)))
    blocks += verification_blocks(case, anchor)
    blocks += baseline_blocks(case, anchor)
    blocks += comparison_blocks(case, shown.number, anchor)
    blocks += event_blocks(case)
    blocks += [doc.Section(table.caption, (_study_table(case, table),)) for table in _select_tables(case)]
    blocks += _list_details(shown)
    return doc.Section(case.title, tuple(blocks), anchor=anchor, ruled=True)


def _list_details(shown: ShownCase) -> Iterator[doc.Section]:
    """Sections on all values and facts, folded on a screen."""
    case = shown.case
    bands, quantities = build_band_table(case), build_quantity_table(case)
    if bands.rows:
        yield doc.Section("Extended band, up to 50 Hz", (bands,))
    if quantities.rows:
        yield doc.Section("All quantities", (quantities,), folded=True)
    if case.uncertainty_basis:
        yield doc.Section("Uncertainty by component", uncertainty_blocks(case), folded=True)
    if skipped := list_skipped(case):
        yield doc.Section("Skipped", (doc.BulletList(skipped),), folded=True)
    if notes := _list_notes(shown):
        yield doc.Section("Notes", (doc.BulletList(notes),), folded=True)
    figures = (*line_figures(case, shown.earlier), *scheme_figures(case, shown.earlier))
    drawings = (*((doc.Figures(figures),) if figures else ()), *line_reference(case, shown.earlier))
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
    return (*(note for note, source in repeated if source is None), *references)


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
