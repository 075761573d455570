"""CSV records: a head line, the time first, in either decimal dialect (`1.5,2` or `1,5;2`)."""

import io
from pathlib import Path

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

CSV_TIME_NAMES = ("time", "time_s", "t", "t_s", "zeit", "temps")


def read_csv_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """The one run of a CSV file; errors as in `read_records`."""
    del sidecar  # a CSV file is read the same way with and without
    source = path.name
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(source, f"byte {error.start + 1} is not UTF-8 text", "Save the file as UTF-8.") from None
    lines = text.splitlines()
    first = next((i for i, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if first is None:
        raise InputError(source, "holds no data", "Export the record again.")
    delimiter, decimal = _dialect(lines[first : first + 3])
    head = [cell.strip().strip('"') for cell in lines[first].split(delimiter)]
    has_head = not all(_is_number(cell, decimal) for cell in head)
    body = [line for line in lines[first + has_head :] if line.strip()]
    _check_widths(body, delimiter, len(head), first + has_head, source)
    values = _numbers(body, delimiter, decimal, first + has_head, source)
    has_time = has_head and head[0].lower() in CSV_TIME_NAMES
    names = head if has_head else [None] * len(head)
    columns = tuple(DropColumn(name) for name in names[has_time:])
    if not columns:
        raise InputError(source, "has no column beside the time", "A record has at least one channel.")
    return [DropColumns(values[:, int(has_time) :], columns, time=values[:, 0] if has_time else None)]


def _dialect(lines: list[str]) -> tuple[str, str]:
    """Delimiter and decimal mark."""
    for delimiter in (";", "\t"):
        if all(delimiter in line for line in lines):
            return delimiter, "," if any("," in line for line in lines[1:]) else "."
    return ",", "."


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return True


def _check_widths(body: list[str], delimiter: str, width: int, before: int, source: str) -> None:
    if not body:
        raise InputError(source, "holds a head line but no samples", "Export the record again.")
    for i, line in enumerate(body):
        found = line.count(delimiter) + 1
        if found != width:
            what = "is cut short" if i == len(body) - 1 else "does not fit"
            raise InputError(
                f"{source}, line {before + i + 1}",
                f"{what}: {found} values, expected {width}",
                "Every line has one value per column; the file may be truncated.",
            )


def _numbers(body: list[str], delimiter: str, decimal: str, before: int, source: str) -> np.ndarray:
    text = "\n".join(body)
    if decimal != ".":
        text = text.replace(decimal, ".")
    try:
        return np.loadtxt(io.StringIO(text), delimiter=delimiter, ndmin=2, comments=None)
    except ValueError:
        for i, line in enumerate(body):
            for cell in line.split(delimiter):
                if not _is_number(cell.strip(), decimal):
                    raise InputError(
                        f"{source}, line {before + i + 1}",
                        f"{cell.strip()[:40]!r} is not a number",
                        "Numbers are written 1.5 with commas between them, or 1,5 with semicolons between them.",
                    ) from None
        raise InputError(source, "cannot be read as numbers", "Export the record again.") from None
