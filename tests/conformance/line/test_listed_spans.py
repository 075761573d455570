"""Spans listed one by one: positions, dropper schedules, and errors with the key and the next step."""

import tomllib
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.changed_lines import refuse_line
from helpers.listed_spans import list_spans
from helpers.toml_edit import change_keys
from pantocheck.conformance.line.elements.dropper import DropperSchedule
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile

LINES = sorted(path.relative_to(library_folder()).parent.as_posix() for path in library_folder().rglob("line.toml"))
UNEQUAL = {
    "span_list": [
        {"length_m": 60.0},
        {"length_m": 50.0, "droppers": "short"},
        {"length_m": 45.5, "droppers": {"x_m": [9.0]}},
    ],
    "schedule": {"short": {"x_m": [5.0, 45.0], "presag_m": [0.0, 0.01]}},
}
COMMON_SCHEDULE = {"length_m": 50.0}


def read_tables(name: str) -> dict[str, Any]:
    return tomllib.loads((library_folder() / name / "line.toml").read_text("utf-8"))


def unequal_line(changes: dict[str, Any] | None = None) -> dict[str, Any]:
    """The line of EN 50318:2002 with spans of 60 m, 50 m and 45.5 m."""
    tables = read_tables("en50318-2002")
    geometry = {key: value for key, value in tables["geometry"].items() if key not in {"span_m", "spans"}}
    tables["geometry"] = geometry | deepcopy(UNEQUAL)
    change_keys(tables, changes or {})
    return tables


@pytest.mark.parametrize("name", [name for name in LINES if "spans" in read_tables(name)["geometry"]])
def test_listed_equal_spans_have_the_positions_and_schedules_of_the_short_form(name: str) -> None:
    tables = read_tables(name)
    short, listed = (LineFile.model_validate(content) for content in (tables, list_spans(tables)))
    assert listed.geometry.span_limits == short.geometry.span_limits
    assert listed.geometry.span_lengths == short.geometry.span_lengths
    assert listed.dropper_schedules == short.dropper_schedules
    assert listed.geometry.shorten(3).span_limits == short.geometry.shorten(3).span_limits


@pytest.mark.parametrize("length", [64.9, 49.99, 33.3])
def test_sums_of_equal_lengths_are_rounded_once(length: float) -> None:
    """Sums in floating point would differ from the product by up to 1e-12 m, and with them the mesh."""
    tables = read_tables("en50318-2002")
    change_keys(
        tables, {"geometry.span_m": length, "geometry.spans": 300, "droppers.x_m": [9.0], "droppers.presag_m": None}
    )
    listed = LineFile.model_validate(list_spans(tables))
    assert listed.geometry.span_limits == tuple(length * i for i in range(301))
    assert listed.geometry.span_limits != (0.0, *np.cumsum(np.full(300, length)))


def test_every_span_has_its_length_and_its_droppers() -> None:
    line = LineFile.model_validate(unequal_line())
    geometry = line.geometry
    assert geometry.span_limits == (0.0, 60.0, 110.0, 155.5)
    assert (geometry.spans, geometry.longest_span, geometry.shortest_span) == (3, 60.0, 45.5)
    assert (geometry.middle_span, geometry.mid_span(2), geometry.section(2, 3)) == (2, 85.0, (60.0, 155.5))
    common, named, own = line.dropper_schedules
    assert common == line.droppers.schedule
    assert named == DropperSchedule(x_m=(5.0, 45.0), presag_m=(0.0, 0.01))
    assert own == DropperSchedule(x_m=(9.0,))
    assert geometry.shorten(2).span_limits == (0.0, 60.0, 110.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"span_list.1.droppers": "shrot"}, "span_list[2].droppers: there is no dropper schedule 'shrot'"),
        ({"span_list.1": COMMON_SCHEDULE}, "droppers.x_m[9]: 55 m is not inside the span of 50 m"),
        ({"schedule.short.x_m": [5.0, 50.0]}, "schedule.short.x_m[2]: 50 m is not inside the span of 50 m"),
        ({"span_list.2.droppers.x_m": [46.0]}, "span_list[3].droppers.x_m[1]: 46 m is not inside the span of 45.5 m"),
        ({"span_list.2.droppers.x_m": [9.0, 8.0]}, "span_list[3].droppers.x_m[2]: 8 m is not greater than"),
        ({"schedule.short.presag_m": [0.0]}, "schedule.short.presag_m: 1 values for 2 droppers"),
        ({"span_list.0.length_m": 150.0}, "span_list[1].length_m: 150 must be at most 120"),
        ({"span_m": 60.0}, "span_m: unknown key"),
    ],
)
def test_errors_name_the_span_and_its_key(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    tables = unequal_line({f"geometry.{key}": value for key, value in changes.items()})
    assert message in refuse_line(tmp_path, tables)
