"""Layout of a text table: separator, decimal mark, head lines. A layout with two valid readings is refused."""

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.text_reading import (
    NumberedLine,
    TextLayout,
    TextReading,
    is_thousands,
    split_lines,
    thousands_error,
)
from pantocheck.conformance.core.text_settings import DecimalSign, Separator, TextSettings

SEPARATORS: tuple[Separator, ...] = (";", "\t", ",", "|", " ")
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
        InputError: The lines are no table, or several layouts are valid; the error names the key that decides.
    """
    separators = SEPARATORS if settings.separator is None else (settings.separator,)
    decimals: tuple[DecimalSign, ...] = (".", ",") if settings.decimal is None else (settings.decimal,)
    readings = [
        reading
        for separator, split in ((separator, split_lines(lines, separator)) for separator in separators)
        for decimal in decimals
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
        "is no table of numbers under any separator and decimal mark",
        "Export columns of numbers, or state separator, decimal and header_lines in [table] of the sidecar.",
    )
