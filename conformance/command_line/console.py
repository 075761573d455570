"""Terminal output: width, tables, verdicts and numbers."""

import os
from collections.abc import Collection
from typing import Literal

from rich.console import Console
from rich.table import Table
from rich.text import Text

from pantocheck.conformance.command_line.guard import strip_control_characters
from pantocheck.conformance.grading.verdicts import Verdict

FILE_WIDTH = 140
"""Columns of output that goes to a file, where a table must not be squeezed."""

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
    output = Console(highlight=False, soft_wrap=False)
    if output.is_terminal or "COLUMNS" in os.environ:
        return output
    return Console(highlight=False, width=FILE_WIDTH)


def build_table(
    *headings: str, title: str | None = None, unbroken: Collection[str] = (), right: Collection[str] = ()
) -> Table:
    """Table without lines.

    Parameters
    ----------
    headings : str
        One per column.
    title : str or None
        Text above the table.
    unbroken : collection of str
        Headings of columns that are never wrapped.
    right : collection of str
        Headings of columns that are aligned to the right.
    """
    table = Table(
        title=None if title is None else Text(title),
        title_justify="left",
        box=None,
        pad_edge=False,
        header_style="bold",
    )
    for heading in headings:
        justify: Literal["left", "right"] = "right" if heading in right else "left"
        table.add_column(Text(heading), no_wrap=heading in unbroken, overflow="fold", justify=justify)
    return table


def style_verdict(verdict: Verdict) -> Text:
    """Verdict in capitals and in its colour."""
    return Text(verdict.upper(), _STYLES[verdict])


def escape_text(text: str) -> Text:
    """Text of a file without markup and control characters."""
    return Text(strip_control_characters(text))


def format_number(value: float | None, digits: int = 4) -> str:
    """Number with some significant digits; a dash for None."""
    return "-" if value is None else f"{value:.{digits}g}"
