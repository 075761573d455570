"""Numbers of README and documentation that come from the guide: `docs/guide-values.json` has them.

An inline number: `26.57<!-- guide: library/en50318-2002/250/1/std_force_N/value -->`. A table: a comment above it,
`<!-- guide-table: library/{case}/{of}/{quantity}; COLUMN=SUFFIX; ... -->`, in which names in braces are columns;
`{owner}` is the first pantograph, or the line for its quantities.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.quantities.registry import QUANTITIES

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs/tutorials").glob("*.md"))]
INLINE = re.compile(r"([−+-]?[\d,.]*\d)(?: ?(?:%|mm/N|[a-zA-Z/²]+))?<!-- guide: ([^ ]+) -->")
TABLE = re.compile(r"<!-- guide-table: (.+?) -->\n\n?((?:\|.*\n)+)")
OWNERS = {"line": "0", "": "0"}


def read_values() -> dict[str, float]:
    return dict(json.loads((ROOT / "docs" / "guide-values.json").read_text("utf-8"))["values"])


def agrees(printed: str, value: float) -> bool:
    """Whether a printed number is a value rounded to the printed digits."""
    text = printed.replace("−", "-").replace(",", "")
    decimals = len(text.partition(".")[2])
    return abs(float(text) - value) <= 0.5000001 * 10.0**-decimals


def list_printed(text: str) -> Iterator[tuple[str, str]]:
    """Printed number and name of every number of a page that comes from the guide."""
    for match in INLINE.finditer(text):
        yield match[1], match[2]
    for match in TABLE.finditer(text):
        yield from _list_table(match[1], match[2])


def _list_table(marker: str, table: str) -> Iterator[tuple[str, str]]:
    key, *columns = (part.strip() for part in marker.split(";"))
    heads, _, *rows = (
        [cell.strip().strip("`") for cell in line.strip("|\n ").split("|")] for line in table.splitlines()
    )
    for row in rows:
        cells = dict(zip(heads, row, strict=True))
        quantity = QUANTITIES.get(cells["quantity"])
        cells["owner"] = "1" if quantity is not None and quantity.scope == "pantograph" else "0"
        name = key.format(**{head: OWNERS.get(cell, cell) for head, cell in cells.items()})
        for column in columns:
            head, suffix = column.split("=")
            if re.match(r"[−-]?\d", cells[head]):
                yield cells[head].split()[0].rstrip("%"), f"{name}/{suffix}"


def test_numbers_from_the_guide_are_those_of_the_guide() -> None:
    values = read_values()
    found = [(page.name, *number) for page in PAGES for number in list_printed(page.read_text("utf-8"))]
    assert [row for row in found if row[2] not in values or not agrees(row[1], values[row[2]])] == []
    assert len(found) > 30


def test_every_marker_is_read() -> None:
    """A marker behind something that is no number, or above no table, would test nothing."""
    for page in PAGES:
        text = page.read_text("utf-8")
        marks = len(re.findall(r"<!-- guide: ", text)), len(re.findall(r"<!-- guide-table: ", text))
        assert marks == (len(INLINE.findall(text)), len(TABLE.findall(text))), page.name


def test_agreement_is_that_of_the_printed_digits() -> None:
    for printed, value in (("26.57", 26.5664), ("26.57", 26.5749), ("12", 11.6), ("−3.1", -3.14)):
        assert agrees(printed, value), printed
    assert not agrees("26.57", 26.576)


def test_wrong_numbers_are_found() -> None:
    text = "A 1.25 mm<!-- guide: a/b -->\n\n<!-- guide-table: c/{of}/{quantity}; value=value -->\n\n"
    text += "| of | quantity | value |\n| --: | :-- | --: |\n| line | `x` | 3.0 N |\n| 2 | y | - |\n"
    assert list(list_printed(text)) == [("1.25", "a/b"), ("3.0", "c/0/x/value")]
