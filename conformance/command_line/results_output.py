"""What `pantocheck run` prints: progress while it runs, then the verdict, the criteria, and where the files are."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from pantocheck.conformance.command_line.console import console, escape_text, format_number, style_verdict
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.results.results_format import CaseResult, Criterion, Results
from pantocheck.conformance.runner import Progress as Report

EXIT_CODES: dict[Verdict, int] = {"pass": 0, "info": 0, "fail": 1, "skip": 1, "error": 2}
"""A limit that was not graded is a limit that was not met: `skip` must not open a gate."""


@contextmanager
def report_progress(cases: int) -> Iterator[Report]:
    """A progress bar on standard error, on a terminal only; gives the callback of the runner."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    errors = Console(stderr=True)
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as bar:
        task = bar.add_task("running cases", total=cases)
        yield lambda result: bar.advance(task)


def print_results(results: Results, files: Sequence[Path]) -> None:
    """Verdict first, then a table of criteria for each case, then the files."""
    output = console()
    criteria = [criterion for case in results.cases for criterion in case.criteria]
    counted = [criterion for criterion in criteria if criterion.verdict != "info"]
    passed = sum(criterion.verdict == "pass" for criterion in counted)
    system = f"{results.system.name} {results.system.version}".strip()
    output.print(
        style_verdict(results.verdict),
        escape_text(
            f" {passed} of {len(counted)} graded criteria within limits, {len(results.cases)} case(s), system {system}"
        ),
    )
    output.print(escape_text(f"{results.statement}; limits count from trust '{results.trust}' up"))
    for case in results.cases:
        output.print()
        output.print(style_verdict(case.verdict), escape_text(f" {case.id}  {case.title}"))
        for line in filter(None, [case.reason, *(f"warning: {warning}" for warning in case.warnings)]):
            output.print(escape_text(f"  {line}"))
        if case.criteria:
            output.print(_criteria_table(case))
    output.print()
    for name in files:
        output.print(escape_text(str(name)), soft_wrap=True)


def _criteria_table(case: CaseResult) -> Table:
    table = Table(box=None, pad_edge=True, header_style="dim")
    numbers = ("value", "+-", "+- stretch", "lower", "upper", "margin")
    for heading in ("criterion", *numbers, "verdict", "trust", "reason"):
        table.add_column(heading, justify="right" if heading in numbers else "left")
    for item in case.criteria:
        error = item.discretisation_error if item.uncertainty is None else item.uncertainty
        table.add_row(
            escape_text(_name(item)),
            format_number(item.value),
            "-" if error is None else f"{error:.2g}",
            "-" if item.spread is None else f"{item.spread:.2g}",
            format_number(item.lower),
            format_number(item.upper),
            "-" if item.margin is None else f"{item.margin:+.2f}",
            style_verdict(item.verdict),
            Text(item.trust),
            escape_text(item.reason or ""),
        )
    return table


def _name(item: Criterion) -> str:
    of = f", pantograph {item.pantograph}" if item.pantograph > 1 else ""
    return f"{item.quantity}{f'[{item.item}]' if item.item else ''}{of}"
