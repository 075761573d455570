"""Tension sections of a line file: places, rises, stored form, and errors with the key and the next step."""

from pathlib import Path
from typing import Any

import pytest

from helpers.changed_lines import refuse_line
from helpers.section_lines import section_line, section_tables
from helpers.toml_edit import change_keys
from pantocheck.conformance.line.elements.tension_section import OverlapTable, SectionPlace
from pantocheck.conformance.line.line_file import LineFile


def test_sections_begin_with_the_overlap_at_the_end_of_the_one_before() -> None:
    """Sections of 22, 20 and 22 spans of 60 m with overlaps of three spans: anchors at spans 19, 22, 36 and 39."""
    line = section_line(spans=(22, 20, 22))
    assert line.geometry.spans == 58
    assert line.section_places == (SectionPlace(1, 0, 22), SectionPlace(2, 19, 39), SectionPlace(3, 36, 58))
    assert line.overlaps == ((1140.0, 1320.0), (2160.0, 2340.0))


def test_line_without_sections_is_one_section_without_overlap() -> None:
    tables = section_tables()
    plain = LineFile.model_validate({key: tables[key] for key in tables if key not in {"section", "overlap"}})
    assert plain.section_places == (SectionPlace(1, 0, 9),)
    assert plain.overlaps == ()
    assert not {"section", "overlap"} & set(plain.model_dump(mode="json"))  # the digest of a case stays


def test_middle_span_lies_outside_of_the_overlap() -> None:
    """Of six spans the last three belong to the overlap; without sections it is that of the line."""
    line = section_line()
    assert line.middle_span == 2
    assert line.shorten(9).middle_span == line.geometry.middle_span == 5


def test_shortened_line_has_one_section() -> None:
    line = section_line().shorten(4)
    assert (line.geometry.spans, line.section, line.overlap) == (4, None, None)


@pytest.mark.parametrize(
    ("spans", "expected"),
    [(1, [0.36, 0.0]), (2, [0.36, 0.0]), (3, [0.36, 0.09]), (4, [0.36, 0.09]), (5, [0.36, 0.16])],
)
def test_parabola_ends_behind_the_middle_of_the_overlap(spans: int, expected: list[float]) -> None:
    """Spans of 60 m: the parabola reaches over one, one, two, two and three spans."""
    overlap = OverlapTable(spans=spans, anchor_rise_m=0.36)
    supports = [60.0 * number for number in range(spans + 1)]
    assert [overlap.rise(x, supports) for x in (0.0, 60.0)] == pytest.approx(expected, abs=1e-15)
    assert overlap.rise(60.0 * ((spans + 1) // 2), supports) == 0.0
    assert overlap.rise(1000.0, supports) == 0.0


def test_given_rises_are_joined_by_straight_lines() -> None:
    overlap = OverlapTable(spans=3, support_rises_m=(0.5, 0.1))
    supports = [0.0, 50.0, 110.0, 160.0]
    assert [overlap.rise(x, supports) for x in (0.0, 25.0, 50.0, 80.0, 110.0, 300.0)] == pytest.approx(
        [0.5, 0.3, 0.1, 0.05, 0.0, 0.0], abs=1e-15
    )


def test_lowest_rise_is_that_of_the_wire_under_the_head() -> None:
    """Overlap of two spans, 240 m to 360 m, rises 0.5 m and 0.1 m: both wires are 0.1 m up at the middle support."""
    line = section_line(overlap={"spans": 2, "support_rises_m": [0.5, 0.1]})
    assert line.overlaps == ((240.0, 360.0),)
    rises = [line.lowest_rise(x) for x in (100.0, 240.0, 270.0, 300.0, 330.0, 360.0, 500.0)]
    assert rises == pytest.approx([0.0, 0.0, 0.05, 0.1, 0.05, 0.0, 0.0], abs=1e-15)
    assert line.shorten(8).lowest_rise(300.0) == 0.0


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"overlap": None}, ["overlap: missing, although section is given"]),
        ({"section": None}, ["section: missing, although overlap is given"]),
        ({"section": [{"spans": 6}]}, ["section"]),
        ({"overlap.spans": 6}, ["overlap.spans: 6 must be"]),
        ({"overlap.anchor_rise_m": None}, ["overlap.anchor_rise_m: the rise of the wires is missing"]),
        (
            {"overlap.support_rises_m": [0.5]},
            ["overlap.anchor_rise_m: the rise of the wires is given twice"],
        ),
        (
            {"overlap": {"spans": 2, "support_rises_m": [0.1, 0.2, 0.3]}},
            [
                "overlap.support_rises_m: 3 rises for an overlap of 2 spans",
                "overlap.support_rises_m: the rises do not decrease",
                "section: the sections end at span 10, but the line has 9 spans",
            ],
        ),
        ({"overlap.support_rises_m": [0.2, 0.2], "overlap.anchor_rise_m": None}, ["the rises do not decrease"]),
        (
            {"section": [{"spans": 3}, {"spans": 6}, {"spans": 6}]},
            [
                "section[1].spans: 3 spans, of which 3 belong to overlaps",
                "section[2].spans: 6 spans, of which 6 belong to overlaps",
            ],
        ),
        (
            {"section": [{"spans": 6, "midpoint_anchor": 6}, {"spans": 6, "midpoint_anchor": 4, "start": "anchor"}]},
            [
                "section[1].midpoint_anchor: support 6 is not inside the section",
                "messenger_wire.axial_stiffness_EA_N: section 2 holds the messenger wire along the track at 2 points",
            ],
        ),
        (
            {"section": [{"spans": 6, "contact_wire": {"tension_N": 0.0, "number": 2}}, {"spans": 6}]},
            ["section[1].contact_wire.tension_N: 0", "section[1].contact_wire.number: unknown key"],
        ),
        ({"section": [{"spans": 6, "end": "spring"}, {"spans": 6}]}, ["section[1].end: found 'spring'"]),
        ({"geometry.spans": 12}, ["section: the sections end at span 9, but the line has 12 spans"]),
    ],
)
def test_errors_name_the_key_and_come_all_at_once(tmp_path: Path, changes: dict[str, Any], messages: list[str]) -> None:
    tables = section_tables()
    change_keys(tables, changes)
    found = refuse_line(tmp_path, tables)
    assert [message for message in messages if message not in found] == []
