"""Terminal output: width, tables, verdicts and numbers."""

from collections.abc import Collection

from rich.console import Console
from rich.text import Text

from pantocheck.conformance.command_line.fitted_table import FittedTable
from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.command_line.hanging_text import HangingText
from pantocheck.conformance.command_line.output_settings import current_settings
from pantocheck.conformance.grading.verdicts import Verdict

_STYLES: dict[Verdict, str] = {
    "pass": "bold green",
    "fail": "bold red",
    "error": "bold red",
    "skip": "yellow",
    "info": "cyan",
    "unverified": "yellow",
}


def console() -> Console:
    """Standard output, as wide as the terminal or the variable COLUMNS."""
    return _open_console(stderr=False)


def error_console() -> Console:
    """Standard error, for progress and messages."""
    return _open_console(stderr=True)


def _open_console(stderr: bool) -> Console:
    if current_settings().colour == "none":
        return Console(stderr=stderr, highlight=False, color_system=None)  # `no_color` of rich keeps bold text
    return Console(stderr=stderr, highlight=False)


def build_table(
    *headings: str, title: str | None = None, unbroken: Collection[str] = (), right: Collection[str] = ()
) -> FittedTable:
    """Table that fits the width of the output; parameters as in `FittedTable`."""
    return FittedTable(headings, title, unbroken, right)


def style_verdict(verdict: Verdict) -> Text:
    """Verdict in capitals and in its colour."""
    return Text(verdict.upper(), _STYLES[verdict])


def escape_text(text: str) -> Text:
    """Text of a file without markup and control characters."""
    return Text(strip_control_characters(text))


def indent_text(text: str, mark: str = "  ") -> HangingText:
    """Paragraph of a file below a heading, without markup and control characters."""
    return HangingText(mark, escape_text(text))


def format_number(value: float | None, digits: int = 4) -> str:
    """Number with some significant digits; a dash for None."""
    return "-" if value is None else f"{value:.{digits}g}"
