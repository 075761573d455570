"""Terminal output: paragraphs, tables for any width, verdicts and numbers."""

from collections.abc import Collection, Iterable, Iterator, Sequence

from rich.console import Console, ConsoleOptions, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pantocheck.conformance.app.commands.guard import strip_control_characters
from pantocheck.conformance.app.commands.output_settings import current_settings


class HangingText:
    """Paragraph that wraps below its text, not below its mark, such as two spaces or a bullet."""

    def __init__(self, mark: str, text: Text) -> None:
        self.mark, self.text = mark, text

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """Lines for the width of the console."""
        width = max(options.max_width - len(self.mark), 1)
        for number, line in enumerate(self.text.wrap(console, width, overflow="fold")):
            yield Text(self.mark if number == 0 else " " * len(self.mark)) + line


# Table that keeps every name and number whole, whatever the width of the terminal.
#
# The widest of three layouts that fits is chosen: columns; the first column above the others; one paragraph per row::
#
# criterion    value  margin        criterion                    std_force_N
# std_force_N  26.65   +0.26          value  margin                value 26.65, margin +0.26
#                                   std_force_N
#                                     26.65   +0.26
LONGEST_WORD = 48
"""Longest word that is kept whole [columns]; names of quantities and cases are shorter, digests and paths longer."""

SHORTEST_LINE = 24
"""Narrowest column of sentences [columns]; with fewer, hardly more than two words stand in a line."""

GAP = 1
"""Space between columns, so that the criteria of a common case fit into 80 columns."""

INDENT = 2


class FittedTable:
    """Rows under headings, for any width; columns by their headings are never wrapped, or aligned to the right."""

    def __init__(
        self, headings: Sequence[str], title: str | None, unbroken: Collection[str], right: Collection[str]
    ) -> None:
        self.title = title
        self._headings = tuple(Text(heading, "bold") for heading in headings)
        self._unbroken = frozenset(i for i, heading in enumerate(headings) if heading in unbroken)
        self._right = frozenset(i for i, heading in enumerate(headings) if heading in right)
        self._rows: list[tuple[Text, ...]] = []

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return len(self._rows)

    def add_row(self, *cells: str | Text) -> None:
        """Add a row; missing cells at its end are empty."""
        texts = [cell if isinstance(cell, Text) else Text(cell) for cell in cells]
        self._rows.append((*texts, *(Text() for _ in range(len(self._headings) - len(texts)))))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        """Layout for the width of the console."""
        if self.title is not None:
            yield Text(self.title, "italic")
        columns = range(len(self._headings))
        if (widths := self._fit(columns, options.max_width)) is not None:
            yield self._lay_out(columns, widths, [self._headings, *self._rows])
        elif (widths := self._fit(columns[1:], options.max_width - INDENT)) is not None:
            for row in (self._headings, *self._rows):
                yield row[0]
                if any(cell.plain for cell in row[1:]):
                    yield Padding(self._lay_out(columns[1:], widths, [row]), (0, 0, 0, INDENT))
        else:
            for row in self._rows:
                yield row[0]
                yield HangingText(" " * INDENT, self._join_cells(row))

    def _fit(self, columns: Sequence[int], width: int) -> list[int] | None:
        """Widths of columns that fill at most a width; None if a name or number would be broken."""
        natural = [max(map(_widest_line, self._column(i))) for i in columns]
        least = [
            whole if i in self._unbroken else min(whole, max(SHORTEST_LINE, *map(_longest_word, self._column(i))))
            for i, whole in zip(columns, natural, strict=True)
        ]
        space = width - sum(least) - GAP * (len(columns) - 1)
        return _share_out(least, natural, space) if columns and space >= 0 else None

    def _column(self, i: int) -> Iterator[Text]:
        return (row[i] for row in (self._headings, *self._rows))

    def _lay_out(self, columns: Sequence[int], widths: list[int], rows: Sequence[tuple[Text, ...]]) -> Table:
        table = Table.grid(padding=(0, GAP, 0, 0))
        for i, width in zip(columns, widths, strict=True):
            table.add_column(width=width, justify="right" if i in self._right else "left", overflow="fold")
        for row in rows:
            table.add_row(*(row[i] for i in columns))
        return table

    def _join_cells(self, row: tuple[Text, ...]) -> Text:
        """Headings and cells of a row, without empty ones."""
        pairs = zip(self._headings[1:], row[1:], strict=True)
        return Text(", ").join(Text.assemble(heading.plain, " ", cell) for heading, cell in pairs if cell.plain)


def _share_out(least: Sequence[int], natural: Sequence[int], space: int) -> list[int]:
    """Widths between the least and the natural ones; columns that need little more get it first."""
    widths = list(least)
    for place, i in enumerate(sorted(range(len(least)), key=lambda i: natural[i] - least[i])):
        more = min(natural[i] - least[i], space // (len(least) - place))
        widths[i] += more
        space -= more
    return widths


def _widest_line(text: Text) -> int:
    return max(map(_cells, text.plain.split("\n")))


def _longest_word(text: Text) -> int:
    """Length of the longest word that must be kept whole."""
    return max((min(_cells(word), LONGEST_WORD) for word in text.plain.split()), default=0)


def _cells(text: str) -> int:
    return Text(text).cell_len


_STYLES: dict[str, str] = {
    "pass": "bold green",
    "fail": "bold red",
    "error": "bold red",
    "skip": "yellow",
    "info": "cyan",
    "unconfirmed": "yellow",
    "undecided": "yellow",
    "close": "bold yellow",
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
    *headings: str,
    title: str | None = None,
    unbroken: Collection[str] = (),
    right: Collection[str] = (),
    rows: Iterable[Sequence[str | Text]] = (),
) -> FittedTable:
    """Table that fits the width of the output; parameters as in `FittedTable`."""
    table = FittedTable(headings, title, unbroken, right)
    for row in rows:
        table.add_row(*row)
    return table


def style_verdict(verdict: str) -> Text:
    """Verdict, or the mark of a pass with close values, in capitals and in its colour."""
    return Text("PASS, CLOSE" if verdict == "close" else verdict.upper(), _STYLES[verdict])


def escape_text(text: str) -> Text:
    """Text of a file without markup and control characters."""
    return Text(strip_control_characters(text))


def indent_text(text: str, mark: str = "  ") -> HangingText:
    """Paragraph of a file below a heading, without markup and control characters."""
    return HangingText(mark, escape_text(text))


def format_number(value: float | None, digits: int = 4) -> str:
    """Number with some significant digits; a dash for None."""
    return "-" if value is None else f"{value:.{digits}g}"
