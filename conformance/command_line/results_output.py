"""Output of `pantocheck run` and `assess`: progress, verdict, criteria and paths of the files."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from pantocheck.conformance.command_line.console import build_table, console, escape_text, format_number, style_verdict
from pantocheck.conformance.command_line.file_list import print_files
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.quantities.limit_text import format_graded, format_margin, name_value
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.reports.certificate.document_facts import list_administration
from pantocheck.conformance.reports.certificate.scope_page import describe_changes
from pantocheck.conformance.reports.certificate.verdict_reasons import build_headline, describe_record
from pantocheck.conformance.reports.page_text import clean_text
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.results_format import CaseResult, Results, name_case
from pantocheck.conformance.runner import Progress as ResultCallback

EXIT_CODES: dict[Verdict, int] = {"pass": 0, "unverified": 1, "info": 1, "skip": 1, "fail": 1, "error": 2}
"""Exit code by verdict: 0 only for `pass`."""

SHOWN_VALUES = (
    *("mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N"),
    *("max_force_N", "min_force_N", "contact_loss_pct", "max_uplift_at_support_mm"),
)
"""Values of a case without limits; all values are in the files."""

LEGEND = "+-: uncertainty of the value; shift: its change when the analysis section is shifted span by span"


@contextmanager
def report_progress(cases: int, task: str = "running cases") -> Iterator[ResultCallback]:
    """Show a progress bar of a task on standard error if it is a terminal; yields the callback of the runner."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    errors = Console(stderr=True)
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as bar:
        number = bar.add_task(task, total=cases)
        yield lambda result: bar.advance(number)


def print_results(results: Results, files: Sequence[Path], formats: Sequence[str] | None = None) -> None:
    """Print the verdict, the criteria of each case, and the paths of the files.

    Parameters
    ----------
    results : Results
        Results of a run.
    files : sequence of Path
        The written files.
    formats : sequence of str or None
        Formats that the user states; None: the default formats.
    """
    output = console()
    system = f"{results.system.name} {results.system.version}".strip()
    output.print(style_verdict(results.verdict), escape_text(f" {build_headline(results.to_dict())} System: {system}"))
    output.print(escape_text(f"{results.statement}; limits count from trust '{results.trust}' up"))
    if results.administration is not None:
        stated = list_administration(results.model_dump(include={"administration"}))
        output.print(escape_text("; ".join(f"{label}: {clean_text(text)}" for label, text in stated)))
    for case in results.cases:
        output.print()
        output.print(style_verdict(case.verdict), escape_text(f" {name_case(case.id, case.library)}  {case.title}"))
        record = None if case.record is None or case.reason else describe_record(case.model_dump())
        changes = [describe_changes(case.model_dump(include={"changes", "library"}))]
        changes += [f"limits file: {'; '.join(case.limit_changes)}"] if case.limit_changes else []
        for line in filter(
            None, [case.reason, record, *changes, *(f"warning: {warning}" for warning in case.warnings)]
        ):
            output.print(escape_text(f"  {line}"))
        _print_criteria(output, case.criteria)
        if not case.criteria and (table := _build_value_table(case)).row_count:
            output.print(table)
        if case.verification is not None:
            output.print(escape_text("  Verification up to 50 Hz:"), style_verdict(case.verification.verdict))
            if case.verification.reason and not case.reason:
                output.print(escape_text(f"  {case.verification.reason}"))
            _print_criteria(output, case.verification.criteria)
    output.print()
    if any(case.criteria for case in results.cases):
        output.print(Text(LEGEND, "dim"))
    print_files(files, formats)


def _print_criteria(output: Console, criteria: Sequence[Criterion]) -> None:
    """Print criteria as a table, and their remarks."""
    if criteria:
        output.print(_build_criterion_table(criteria))
    for item in criteria:
        for remark in filter(None, (item.reason, *item.close)):
            output.print(escape_text(f"  {_name(item)}: {remark}"))


def _build_criterion_table(criteria: Sequence[Criterion]) -> Table:
    """Table of the criteria, which fits into 80 columns."""
    numbers = ("value", "+-", "shift", "limits", "margin")
    table = build_table(
        "criterion", *numbers, "verdict", "trust", unbroken=(*numbers, "verdict", "trust"), right=numbers
    )
    table.padding = (0, 1, 0, 0)
    for item in criteria:
        error = item.discretisation_error if item.uncertainty is None else item.uncertainty
        texts = format_graded(item.value, item.lower, item.upper)
        table.add_row(
            escape_text(_name(item)),
            texts.value,
            format_number(error, 2),
            format_number(item.spread, 2),
            texts.bounds,
            "-" if item.margin is None else format_margin(item.margin),
            style_verdict(item.verdict),
            Text(item.trust),
        )
    return table


def _build_value_table(case: CaseResult) -> Table:
    """Table of the main values of a case without limits."""
    numbers = ("value", "+-")
    table = build_table("quantity", *numbers, "unit", unbroken=(*numbers, "unit"), right=numbers)
    table.padding = (0, 1, 0, 0)
    for owner, quantities in sorted(case.quantities.items(), key=lambda item: item[0] == "0"):  # the line comes last
        for name in SHOWN_VALUES:
            value, width = quantities.get(name), case.uncertainty.get(owner, {}).get(name)
            if isinstance(value, float):
                error = width if isinstance(width, float) else None
                text = name + (f", pantograph {owner}" if int(owner) > 1 else "")
                table.add_row(text, format_number(value), format_number(error, 2), QUANTITIES[name].unit)
    return table


def _name(item: Criterion) -> str:
    pantograph = f", pantograph {item.pantograph}" if item.pantograph > 1 else ""
    return name_value(item.quantity, item.item) + pantograph
