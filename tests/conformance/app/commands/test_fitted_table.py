"""Tables for any width: three layouts, none of which breaks a name or a number."""

import io

import pytest
from rich.console import Console

from pantocheck.conformance.app.commands.console import FittedTable, build_table

NAME = "elasticity_non_uniformity_pct"


def shown(table: FittedTable, width: int) -> list[str]:
    output = io.StringIO()
    Console(file=output, width=width).print(table)
    return [line.rstrip() for line in output.getvalue().splitlines()]


@pytest.fixture
def table() -> FittedTable:
    table = build_table("criterion", "value", "limits", unbroken=("criterion", "value", "limits"), right=("value",))
    table.add_row(NAME, "41.52", "40.28 to 42.83")
    table.add_row("std_force_N", "26.6", "")
    return table


@pytest.mark.parametrize(
    ("width", "lines"),
    [
        # Columns: 29 + 5 + 14 and two spaces.
        (50, [f"{'criterion':29} value limits", f"{NAME} 41.52 40.28 to 42.83", f"{'std_force_N':29}  26.6"]),
        # Names above their numbers.
        (49, ["criterion", "  value limits", NAME, "  41.52 40.28 to 42.83", "std_force_N", "   26.6"]),
        # Paragraphs without empty cells.
        (
            21,
            [
                *("elasticity_non_unifor", "mity_pct", "  value 41.52, limits", "  40.28 to 42.83"),
                *("std_force_N", "  value 26.6"),
            ],
        ),
    ],
)
def test_layout_follows_the_width(table: FittedTable, width: int, lines: list[str]) -> None:
    assert shown(table, width) == lines


def test_sentences_wrap_beside_whole_names_and_a_row_without_cells_takes_one_line() -> None:
    table = build_table("case", "title", unbroken=("case",))
    table.add_row("en50318-2002/250", "EN 50318:2002 reference model, 250 km/h")
    assert shown(table, 45) == [
        "case             title",
        "en50318-2002/250 EN 50318:2002 reference",
        "                 model, 250 km/h",
    ]
    # Sentences have 24 columns at least: with 16 for the name and a space, 41 in all.
    assert [len(shown(table, width)) for width in (41, 40)] == [3, 5]
    table = build_table("input", "value", unbroken=("input", "value"))
    table.add_row("line.damping", "")
    table.add_row("  tension_N", "20000.0")
    assert shown(table, 15) == ["input", "  value", "line.damping", "  tension_N", "  20000.0"]
