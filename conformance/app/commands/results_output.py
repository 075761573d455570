"""Output of `pantocheck run` and `assess`: tables of criteria and values, lines of the cases, and verdict."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.case_line import list_case_remarks, write_case_line
from pantocheck.conformance.app.commands.command_output import STANDING_REMARKS, CommandOutput
from pantocheck.conformance.app.commands.console import (
    FittedTable,
    build_table,
    escape_text,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.app.commands.output_settings import Detail
from pantocheck.conformance.app.commands.quantities_table import (
    build_quantities_table,
    format_width,
    list_names,
    select_main,
)
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages.condition_sections import BAND_MARK, describe_condition
from pantocheck.conformance.pages.criteria_table import describe_close
from pantocheck.conformance.pages.document_facts import list_administration
from pantocheck.conformance.pages.record_check_table import CHECK_HEADINGS, describe_row
from pantocheck.conformance.pages.scope_page import describe_changes
from pantocheck.conformance.pages.two_verdicts import describe_comparison
from pantocheck.conformance.pages.verdict_marks import mark_case, mark_results
from pantocheck.conformance.pages.verdict_reasons import build_headline, describe_record, state_decision
from pantocheck.conformance.pages.words import clean_text
from pantocheck.conformance.quantities.limit_text import format_criterion_margin, format_graded, name_value
from pantocheck.conformance.results.incomplete_uncertainty import explain_missing, list_unknown
from pantocheck.conformance.results.results_format import CaseResult, Results, name_case

LEGEND = (
    "+-: uncertainty of the value; margin: relative distance to the nearer limit, 1 in the middle between two "
    "limits, 0 on a limit, negative outside; with one limit, the distance divided by it, and the distance itself with "
    "its unit if this limit is 0"
)


@dataclass(frozen=True)
class GradedOutput(CommandOutput):
    """Output of graded cases: remarks or, on request, tables first, then the verdict at the end."""

    lines: Sequence[Text] = ()
    """One line for each case."""

    def list_parts(self, detail: Detail) -> list[RenderableType]:
        """The conclusion alone, or behind the lines of the cases with their remarks, or behind the tables."""
        above = {"quiet": (), "normal": self.details, "verbose": (*self.further, *self.lines)}
        return [*above[detail], self.conclusion]


def build_results_output(
    results: Results, files: Sequence[Path], exit_code: int, remarks: Sequence[str] = ()
) -> GradedOutput:
    """Lines of the cases and verdict; the tables of the cases are further parts."""
    system = f"{results.system.name} {results.system.version}".strip()
    headline = f"{build_headline(results)} System: {system}"
    tables: list[RenderableType] = [escape_text(f"{results.statement}. {state_decision(results)}")]
    stated = list_administration(results.administration) if results.administration is not None else ()
    issued = [escape_text("; ".join(f"{label}: {clean_text(text)}" for label, text in stated))] if stated else []
    tables += issued
    footnotes = list_footnotes(results.cases)
    for case in results.cases:
        tables += [Text(), *_describe_case(case, footnotes)]
    tables.append(Text())
    rows = [row for case in results.cases for row in case.criteria]
    rows += [row for case in results.cases if case.verification is not None for row in case.verification.criteria]
    if rows:
        tables.append(Text(LEGEND, "dim"))
    tables += [indent_text(text, f"[{number}] ") for number, text in enumerate(footnotes, 1)]
    tables += [part for case in results.cases for part in _list_all_values(case)]
    lines = [write_case_line(results, case) for case in results.cases]
    below = [list_case_remarks(results, case, footnotes) for case in results.cases]
    statement = escape_text(f"{results.statement}; limits count from trust '{results.trust}' up")
    return GradedOutput(
        conclusion=style_verdict(mark_results(results)) + escape_text(f" {headline}"),
        data=results,
        details=[
            *(part for pair in zip(lines, below, strict=True) for part in (pair[0], *pair[1])),
            statement,
            *issued,
        ],
        further=tables,
        files=files,
        exit_code=exit_code,
        remarks=remarks,
        lines=lines,
    )


def _describe_case(case: CaseResult, footnotes: Sequence[str]) -> Iterator[RenderableType]:
    """Verdict, remarks, criteria and values of a case."""
    marks = mark_footnotes(case, footnotes)
    title = f" {name_case(case.id, case.library)}  {case.title}{f' {marks}' if marks else ''}"
    yield style_verdict(mark_case(case)) + escape_text(title)
    record = None if case.record is None or case.reason else describe_record(case)
    changes = [describe_changes(case)]
    changes += [f"limits file: {'; '.join(case.limit_changes)}"] if case.limit_changes else []
    warnings = (f"warning: {warning}" for warning in case.warnings if warning not in footnotes)
    condition = describe_condition(case).removeprefix(f"{BAND_MARK} ").replace("\N{MINUS SIGN}", "-")
    for line in filter(None, [case.reason, record, *changes, *warnings, condition]):
        yield indent_text(line)
    criteria = [item for item in case.criteria if case.baseline is None or not item.is_drift]
    missing = list_unknown(case.uncertainty_basis)
    yield from _list_criteria(criteria, missing)
    if not criteria:
        table = build_quantities_table(case.quantities, case.uncertainty, select_main(case.quantities), missing)
        yield from [table] if table.row_count else []
    if missing and case.uncertainty:
        yield indent_text(explain_missing(missing))
    if case.verification is not None:
        yield Text("  Verification up to 50 Hz: ") + style_verdict(case.verification.verdict)
        if case.verification.reason and not case.reason:
            yield indent_text(case.verification.reason)
        yield from _list_criteria(case.verification.criteria)
    if case.baseline is not None:
        yield Text("  Drift from the baseline: ") + style_verdict(case.baseline.verdict)
        yield indent_text(describe_comparison(case.baseline))
        yield from _list_criteria([item for item in case.criteria if item.is_drift])


def _list_all_values(case: CaseResult) -> Iterator[RenderableType]:
    """All quantities of a case that are single numbers, and the consistency checks of its record."""
    missing = list_unknown(case.uncertainty_basis)
    table = build_quantities_table(case.quantities, case.uncertainty, list_names(case.quantities), missing)
    if table.row_count:
        yield Text()
        yield Text(f"All values of {case.id}", "bold")
        yield table
    if case.record is not None and case.record.checks:
        rows = [
            tuple(text.translate({ord("–"): "-", ord("−"): "-"}) for text in describe_row(row))
            for row in case.record.checks
        ]
        yield Text()
        yield Text(f"Consistency checks of {case.id}", "bold")
        yield build_table(*map(str.lower, CHECK_HEADINGS), unbroken=("check", "value", "outcome"), rows=rows)


def _list_criteria(criteria: Sequence[Criterion], missing: Sequence[str] = ()) -> Iterator[RenderableType]:
    """Criteria as a table, and their remarks."""
    if criteria:
        yield _build_criterion_table(criteria, missing)
        trusts = {item.trust for item in criteria if item.trust not in (None, "computed")}
        yield from [indent_text(f"Trust of the limits: {trust}.") for trust in trusts if len(trusts) == 1]
    yield from map(indent_text, describe_close(criteria, _name))
    for item in criteria:
        for remark in filter(None, (item.reason, *item.readings)):
            yield indent_text(f"{_name(item)}: {remark}")


def _build_criterion_table(criteria: Sequence[Criterion], missing: Sequence[str]) -> FittedTable:
    """Table of criteria, without a trust that all share."""
    numbers = ("value", "+-", "limits", "margin")
    origin = ("trust",) if len({item.trust for item in criteria if item.trust}) > 1 else ()
    headings = ("criterion", *numbers, "verdict", *origin)
    table = build_table(*headings, unbroken=headings[1:], right=numbers)
    for item in criteria:
        error = item.discretisation_error if item.uncertainty is None else item.uncertainty
        texts = format_graded(item.value, item.lower, item.upper)
        cells: dict[str, str | Text] = {
            "criterion": escape_text(_name(item)),
            "value": texts.value,
            "+-": format_width(error, () if item.uncertainty is None else missing, item.quantity),
            "limits": texts.bounds,
            "margin": format_criterion_margin(item.margin, item.lower, item.upper, item.unit),
            "verdict": style_verdict(item.verdict),
            "trust": item.trust or "-",
        }
        table.add_row(*(cells[heading] for heading in headings))
    return table


def _name(item: Criterion) -> str:
    pantograph = f", pantograph {item.pantograph}" if item.pantograph > 1 else ""
    return name_value(item.quantity, item.item) + pantograph


def list_footnotes(cases: Sequence[CaseResult]) -> list[str]:
    """Remarks that are printed once, in their order: standing ones, and those that several cases have in common."""
    counts = Counter(warning for case in cases for warning in dict.fromkeys(case.warnings))
    return [text for text, count in counts.items() if count > 1 or text.startswith(STANDING_REMARKS)]


def mark_footnotes(case: CaseResult, footnotes: Sequence[str]) -> str:
    """Marks of the footnotes that apply to a case, such as `[1] [2]`; empty without one."""
    return " ".join(f"[{number}]" for number, text in enumerate(footnotes, 1) if text in case.warnings)
