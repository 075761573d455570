"""Lines of a graded case in a terminal: verdict, values inside and close, reasons against a pass, and its force."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from rich.console import Console, ConsoleOptions, RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.console import escape_text, indent_text, style_verdict
from pantocheck.conformance.app.commands.quantities_table import build_quantities_table, select_main
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import Traces
from pantocheck.conformance.pages.criteria_table import count_inside
from pantocheck.conformance.pages.scope_page import describe_changes
from pantocheck.conformance.pages.verdict_marks import list_criteria, mark_case, select_criteria
from pantocheck.conformance.pages.verdict_reasons import describe_record
from pantocheck.conformance.quantities.limit_text import format_graded, name_value
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown
from pantocheck.conformance.results.results_format import CaseResult, Results, name_case

BLOCKS = "\N{LOWER ONE EIGHTH BLOCK}\N{LOWER ONE QUARTER BLOCK}\N{LOWER THREE EIGHTHS BLOCK}\N{LOWER HALF BLOCK}" + (
    "\N{LOWER FIVE EIGHTHS BLOCK}\N{LOWER THREE QUARTERS BLOCK}\N{LOWER SEVEN EIGHTHS BLOCK}\N{FULL BLOCK}"
)
"""Blocks of eight heights."""

MOST_FAILURES = 3
"""Largest number of failed values below the line of a case; the tables have all."""


class ForceLine:
    """Contact force up to 20 Hz over the analysis section as a line of blocks, on a terminal that has them."""

    def __init__(self, name: str, force: Sequence[float]) -> None:
        self._name, self._force = name, force

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """The line for the width of a terminal; nothing in a file, a pipe or another encoding."""
        if console.is_terminal and options.encoding.startswith("utf"):
            low, high = min(self._force), max(self._force)
            ends = f" {low:.0f} to {high:.0f} N"
            yield Text(
                f"  {self._name} {draw_blocks(self._force, options.max_width - len(self._name) - len(ends) - 4)}{ends}"
            )


def draw_blocks(values: Sequence[float], width: int) -> str:
    """Blocks whose heights follow the values; the mean of each part, between the smallest and the largest value.

    Args:
        values: Values at equal distances.
        width: Largest number of blocks; at least one is drawn.
    """
    low, high, count = min(values), max(values), max(min(width, len(values)), 1)
    edges = [round(len(values) * i / count) for i in range(count + 1)]
    means = [sum(values[a:b]) / (b - a) for a, b in pairwise(edges)]
    return "".join(BLOCKS[min(int(8 * (mean - low) / (high - low)), 7) if high > low else 0] for mean in means)


def write_case_line(results: Results, case: CaseResult) -> Text:
    """Verdict of a case with the numbers of its values inside and close to a limit, in one line."""
    rows = list_criteria(case, "criteria")
    close = sum(row.verdict == "pass" and row.is_close for row in select_criteria(results, case))
    parts = [count_inside(rows).removesuffix("."), f"{close} close" if close else ""]
    if case.verification is not None:
        parts.append(f"up to 50 Hz {style_verdict(case.verification.verdict).plain}")
    text = ", ".join(filter(None, parts)) or ("no limit that counts" if rows else case.title)
    return style_verdict(mark_case(case)) + escape_text(f" {name_case(case.id, case.library)}  {text}")


def list_case_remarks(results: Results, case: CaseResult, footnotes: Sequence[str]) -> Iterator[RenderableType]:
    """Reasons against a pass, warnings, values of a case without limits, and its force.

    Args:
        results: Results with the case.
        case: The case.
        footnotes: Remarks that the tables print once.
    """
    record = case.record
    state = describe_record(case) if record is not None and record.state != "consistent" and not case.reason else None
    changes = [describe_changes(case), *(f"limits file: {text}" for text in case.limit_changes)]
    known = {*footnotes, None if state is None or record is None else record.reason}
    warnings = (f"warning: {warning}" for warning in case.warnings if warning not in known)
    failed = [row for row in select_criteria(results, case) if row.verdict not in ("pass", "info")]
    more = f"{len(failed) - MOST_FAILURES} more with -v" if len(failed) > MOST_FAILURES else None
    reasons = [_describe_failure(row) for row in failed[:MOST_FAILURES]]
    yield from map(indent_text, filter(None, [case.reason, state, *changes, *warnings, *reasons, more]))
    if not list_criteria(case, "criteria"):
        missing = list_unknown(case.uncertainty_basis)
        table = build_quantities_table(case.quantities, case.uncertainty, select_main(case.quantities), missing)
        yield from [table] if table.row_count else []
    yield from draw_forces(case.traces)


def draw_forces(traces: Mapping[str, Traces]) -> Iterator[ForceLine]:
    """Line of blocks for the filtered force of each pantograph that has one."""
    return (ForceLine(f"force of pantograph {n}", trace.force_20_N) for n, trace in traces.items() if trace.force_20_N)


def _describe_failure(row: Criterion) -> str:
    texts = format_graded(row.value, row.lower, row.upper)
    name = name_value(row.quantity, row.item) + (f", pantograph {row.pantograph}" if row.pantograph > 1 else "")
    value = "no value" if row.value is None else f"{texts.value} {row.unit}".rstrip()
    return f"{style_verdict(row.verdict).plain} {name}: {value}, {row.reason or f'limits {texts.bounds}'}"
