"""Cells of a text table: splitting of lines, numbers under a decimal mark, and thousands marks."""

import csv
import re
from collections import Counter
from dataclasses import dataclass
from functools import cached_property

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.text_settings import DecimalSign, Separator, TextSettings
from pantocheck.conformance.core.units import is_unit

_NUMBER = {
    ".": re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf)", re.IGNORECASE),
    ",": re.compile(r"[+-]?\d+(,\d+)?([eE][+-]?\d+)?|[+-]?(nan|inf)", re.IGNORECASE),
}
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+")
"""Number whose mark may separate thousands; `0,123` cannot be such a number."""


def split_cells(line: str, separator: str) -> list[str]:
    """Cells of a line without quotes and blanks around them."""
    text = line.strip("\r\n")
    if separator == " ":
        return [cell for cell in text.strip().split(" ") if cell]
    if '"' in text:
        return [cell.strip().strip('"') for cell in next(csv.reader([text], delimiter=separator))]
    return [cell.strip() for cell in text.split(separator)]


def is_number(cell: str, decimal: DecimalSign | None) -> bool:
    """Whether a cell is a number; without a decimal mark, either mark is accepted."""
    if decimal is None:
        return any(number.fullmatch(cell) for number in _NUMBER.values())
    return _NUMBER[decimal].fullmatch(cell) is not None


def number_error(place: str, column: int, cell: str) -> InputError:
    """Error of a cell that is not a number; columns count from 0."""
    return InputError(
        f"{place}, column {column + 1}",
        f"{cell[:40]!r} is not a number",
        "Write 1.5 with commas between columns, or 1,5 with semicolons; nan marks a missing value.",
    )


def is_thousands(cell: str) -> bool:
    """Whether the marks of a number may separate thousands."""
    return _THOUSANDS.fullmatch(cell) is not None


def thousands_error(where: str, cell: str) -> InputError:
    """Error of a number whose mark may separate thousands."""
    mark = "," if "," in cell else "."
    return InputError(
        where,
        f"the mark in {cell!r} may separate decimals or thousands",
        f'State decimal = "{mark}" in [table] of the sidecar if it marks decimals; thousands marks are not read.',
    )


# Reading of a text table under one separator and one decimal mark: columns, first line of numbers, names, units.
NumberedLine = tuple[int, str]
"""Line of a file with its number from 1."""

SplitLine = tuple[int, str, list[str]]
"""Line of a file with its number from 1 and its cells."""


@dataclass(frozen=True)
class TextLayout:
    """Layout of a text table."""

    separator: Separator
    """Separator of the columns; a blank stands for any number of blanks."""
    decimal: DecimalSign | None
    """Decimal mark; None: no number of the first lines has one."""
    width: int
    """Number of columns."""
    texts: frozenset[int]
    """Columns without numbers, from 0."""
    first: int
    """Number of the first line of numbers, from 1."""
    names: tuple[str, ...] | None = None
    """Names of the columns; None without a line of names."""
    units: tuple[str, ...] | None = None
    """Units of the columns; None without a line of units."""
    preface: tuple[str, ...] = ()
    """Lines above the names."""


def split_lines(lines: list[NumberedLine], separator: Separator) -> list[SplitLine]:
    """Lines with their cells under one separator."""
    return [(number, text, split_cells(text, separator)) for number, text in lines]


class TextReading:
    """Lines of a table under one separator and one decimal mark."""

    def __init__(
        self, lines: list[SplitLine], separator: Separator, decimal: DecimalSign, header_lines: int | None
    ) -> None:
        self.lines, self.separator, self.decimal, self.header_lines = lines, separator, decimal, header_lines
        below = [line for line in self.lines if line[0] > (header_lines or 0)]
        body = below[len(below) // 2 :]
        widths = Counter(len(cells) for _, _, cells in body)
        self.width = max(widths, key=lambda width: (widths[width], width), default=0)
        self.body = [cells for _, _, cells in body if len(cells) == self.width]

    @cached_property
    def counts(self) -> list[tuple[int, int]]:
        """Number of numbers and of cells with content in the lower lines of each column."""
        columns = [[cells[c] for cells in self.body if cells[c]] for c in range(self.width)]
        matches = _NUMBER[self.decimal].fullmatch
        return [(len(list(filter(matches, cells))), len(cells)) for cells in columns]

    @cached_property
    def numeric(self) -> frozenset[int]:
        """Columns with numbers in most of the lower lines; empty cells are missing values."""
        return frozenset(c for c, (numbers, filled) in enumerate(self.counts) if filled and numbers >= filled / 2)

    @cached_property
    def empty(self) -> frozenset[int]:
        """Columns without any content."""
        return frozenset(c for c, (_, filled) in enumerate(self.counts) if not filled)

    @cached_property
    def first(self) -> int | None:
        """Index of the first line of numbers, below the stated head lines."""
        for index, (number, _, cells) in enumerate(self.lines):
            if self.header_lines is not None and number <= self.header_lines:
                continue
            if (
                len(cells) == self.width
                and all(not cells[c] or is_number(cells[c], self.decimal) for c in self.numeric)
                and any(cells[c] for c in self.numeric)
            ):
                return index
        return None

    @property
    def is_valid(self) -> bool:
        """Whether the lines are a table: at least one column of numbers, and names above columns of text."""
        return bool(self.numeric) and self.first is not None and (self.is_full or bool(self.head))

    @property
    def is_full(self) -> bool:
        """Whether every column with content has numbers."""
        return len(self.numeric | self.empty) == self.width

    @cached_property
    def above(self) -> list[SplitLine]:
        """Lines above the numbers that are not comments; below the stated head lines also comments."""
        lines = self.lines[: self.first]
        if self.header_lines is not None:
            stated = [(number, text.lstrip().lstrip("#")) for number, text, _ in lines if number > self.header_lines]
            return [(number, text, split_cells(text, self.separator)) for number, text in stated]
        begin = next((i for i, (_, text, _) in enumerate(lines) if not text.lstrip().startswith("#")), len(lines))
        return lines[begin:]

    @cached_property
    def head(self) -> list[SplitLine]:
        """Lines directly above the numbers with as many cells; a blank line ends them."""
        head: list[SplitLine] = []
        below = self.lines[self.first or 0][0]
        for number, text, cells in reversed(self.above):
            if len(cells) != self.width or (number != below - 1 and self.header_lines is None):
                break
            head.insert(0, (number, text, cells))
            below = number
        return head

    @cached_property
    def rank(self) -> tuple[bool, float, float, bool, bool]:
        """Order of preference: columns of numbers, damaged cells, names, several columns."""
        share = sum(self.counts[c][0] for c in self.numeric) / sum(self.counts[c][1] for c in self.numeric)
        named = bool(self.head)
        columns = 1.0 if self.is_full else len(self.numeric) / self.width
        return self.is_full, columns, share, named, named and self.width > 1

    @property
    def marked(self) -> list[str]:
        """Numbers of the lower lines with a decimal mark."""
        return [cells[c] for cells in self.body for c in self.numeric if self.decimal in cells[c]]

    @property
    def is_single(self) -> bool:
        return self.width == 1

    def build_layout(self, where: str) -> TextLayout:
        """Layout with the lines of names and units."""
        assert self.first is not None
        first = self.lines[self.first][0]
        names, units, top = self._find_names(where)
        return TextLayout(
            self.separator,
            self.decimal if self.marked else None,
            self.width,
            frozenset(range(self.width)) - self.numeric,
            first,
            names,
            units,
            tuple(text.strip() for number, text, _ in self.lines if number < top),
        )

    def _find_names(self, where: str) -> tuple[tuple[str, ...] | None, tuple[str, ...] | None, int]:
        """Names, units, and number of the line of the names, or of the first numbers without names."""
        head, first = self.head, self.lines[self.first or 0][0]
        if not head:
            if self.above:
                number, _, cells = self.above[-1]
                raise InputError(
                    f"{where}, line {first}",
                    f"has {self.width} values, expected {len(cells)}",
                    f"Line {number} has {len(cells)} cells. Name every column in the line above the numbers; if "
                    "columns are separated by commas, write decimals with points.",
                )
            return None, None, first
        for number, _, cells in head:
            self._check_damage(f"{where}, line {number}", cells)
        *_, (number, _, last) = head
        if self.header_lines is not None:
            if len(head) > 2 or len(head) != len(self.above):
                raise InputError(
                    f"{where}, line {self.above[0][0]}",
                    f"is stated to hold the names, but {len(self.above) - 1} lines stand between it and the numbers",
                    "Correct header_lines in [table] of the sidecar: the number of lines above the names.",
                )
            units = tuple(last) if len(head) == 2 else None
            return tuple(head[0][2]), units, head[0][0]
        if len(head) == 1:
            return tuple(last), None, number
        if all(is_unit(cell) for cell in last):
            return tuple(head[-2][2]), tuple(last), head[-2][0]
        raise InputError(
            f"{where}, lines {head[0][0]} to {number}",
            "may all hold the names of the columns",
            f"Write the number of lines above the names in the sidecar: [table] header_lines = {number - 2}, if line "
            f"{number - 1} holds the names.",
        )

    def _check_damage(self, place: str, cells: list[str]) -> None:
        """Refuse a head line that is a line of numbers with a damaged cell."""
        wrong = [c for c in sorted(self.numeric) if not is_number(cells[c], self.decimal)]
        if 2 * len(wrong) < len(self.numeric) and wrong:
            raise number_error(place, wrong[0], cells[wrong[0]])


# Layout of a text table: separator, decimal mark, head lines. A layout with two valid readings is refused.
SEPARATORS: tuple[Separator, ...] = (";", "\t", ",", "|", " ")
DECIMAL_MARKS: tuple[DecimalSign, ...] = (".", ",")
SEPARATOR_NAMES = {";": "semicolon", "\t": "tab", ",": "comma", "|": "bar", " ": "blanks"}


def find_text_layout(lines: list[NumberedLine], where: str, settings: TextSettings) -> TextLayout:
    """Find the layout of a text table.

    Args:
        lines: First lines of the file that are not blank, numbered from 1.
        where: Name of the file in messages.
        settings: Stated keys of the layout.

    Returns:
        The only layout in which the lines are a table.

    Raises:
        InputError: The lines are not a table, or several layouts are valid; the error names the key that decides.
    """
    separators = _list_separators(lines) if settings.separator is None else (settings.separator,)
    readings = [
        reading
        for separator, split in ((separator, split_lines(lines, separator)) for separator in separators)
        for decimal in (_list_decimals(lines, separator) if settings.decimal is None else (settings.decimal,))
        if separator != decimal and (reading := TextReading(split, separator, decimal, settings.header_lines)).is_valid
    ]
    best = max((reading.rank for reading in readings), default=None)
    readings = _drop_equal([reading for reading in readings if reading.rank == best])
    if not readings:
        raise _find_missing_numbers(lines, where)
    if len(readings) > 1:
        raise _build_ambiguity(readings, where)
    reading = readings[0]
    if settings.decimal is None:
        _check_thousands(reading, where)
    return reading.build_layout(where)


def _list_separators(lines: list[NumberedLine]) -> tuple[Separator, ...]:
    """Separators that give different readings: those that no line has give the same single column."""
    absent = [mark for mark in SEPARATORS[:-1] if not any(mark in text for _, text in lines)]
    return tuple(mark for mark in SEPARATORS if mark not in absent[1:])


def _list_decimals(lines: list[NumberedLine], separator: Separator) -> tuple[DecimalSign, ...]:
    """Decimal marks beside a separator; one that no line has reads a part of the numbers of the other one."""
    marks = [mark for mark in DECIMAL_MARKS if mark != separator]
    return tuple(mark for mark in marks if any(mark in text for _, text in lines)) or DECIMAL_MARKS[:1]


def _drop_equal(readings: list[TextReading]) -> list[TextReading]:
    """Readings that differ; numbers without a decimal mark are the same under both marks."""
    kept: list[TextReading] = []
    for reading in readings:
        same = (
            other
            for other in kept
            if not other.marked and not reading.marked and (other.separator == reading.separator or other.is_single)
        )
        if next(same, None) is None and not (
            reading.is_single and any(other.is_single and other.decimal == reading.decimal for other in kept)
        ):
            kept.append(reading)
    return kept


def _build_ambiguity(readings: list[TextReading], where: str) -> InputError:
    one, other = readings[:2]
    key = "separator" if one.separator != other.separator and one.width != other.width else "decimal"
    return InputError(
        where,
        f"can be read in two ways: {_describe(one)}, or {_describe(other)}",
        f"State {key} in [table] of the sidecar.",
    )


def _describe(reading: TextReading) -> str:
    columns = "one column" if reading.is_single else f"{reading.width} columns ({SEPARATOR_NAMES[reading.separator]})"
    return f"{columns} with decimal {SEPARATOR_NAMES.get(reading.decimal, 'point')}"


def _check_thousands(reading: TextReading, where: str) -> None:
    """Refuse numbers whose only marks may separate thousands; beside a comma as separator, a point marks decimals."""
    if reading.separator == "," or not reading.marked:
        return
    if all(map(is_thousands, reading.marked)):
        raise thousands_error(where, reading.marked[0])


def _find_missing_numbers(lines: list[NumberedLine], where: str) -> InputError:
    if len(lines) == 1:
        return InputError(where, "holds a head line but no samples", "Export the record again.")
    return InputError(
        where,
        "is not a table of numbers under any separator and decimal mark",
        "Export columns of numbers, or state separator, decimal and header_lines in [table] of the sidecar.",
    )
