"""Supports of a measured line: listed ones, and those that must stand between and beside them."""

from collections.abc import Sequence

import pytest

from pantocheck.conformance.records.usable_sections import list_line_supports

SECTION = (100.0, 400.0)


@pytest.mark.parametrize(
    ("listed", "expected"),
    [
        ([120, 180, 240, 300, 360], [120, 180, 240, 300, 360]),
        ([360, 120, 360, 240], [120, 180, 240, 300, 360]),
        ([240], [120, 180, 240, 300, 360]),
        ([120], [120, 180, 240, 300, 360]),
        ([360], [120, 180, 240, 300, 360]),
        ([120, 360], [120, 180, 240, 300, 360]),
        # Shorter spans are possible: two spans of 50 m, and a listed support at 40 m from another one.
        ([120, 220, 260], [120, 170, 220, 260, 320, 380]),
        # Three spans of 61 m are longer than the longest one: there must be four.
        ([120, 303], [120, 165.75, 211.5, 257.25, 303, 363]),
    ],
)
def test_distance_longer_than_a_span_holds_further_supports(listed: Sequence[float], expected: list[float]) -> None:
    supports = list_line_supports(listed, 60.0, SECTION)
    assert supports == pytest.approx(expected, abs=1e-9)
    assert supports == tuple(sorted(supports or ()))


@pytest.mark.parametrize(("distance", "count"), [(59.0, 2), (60.4, 2), (60.6, 3), (120.4, 3), (120.6, 4), (180.6, 5)])
def test_positions_are_known_to_half_a_metre_between_supports(distance: float, count: int) -> None:
    """A distance of 60.4 m may be one span of 60 m, because the positions are surveyed to some decimetres."""
    supports = list_line_supports([150.0, 150.0 + distance], 60.0, (140.0, 160.0 + distance))
    assert len(supports or ()) == count


@pytest.mark.parametrize(("section", "count"), [((90.0, 210.0), 3), ((90.4, 209.6), 3), ((90.6, 209.4), 1)])
def test_support_at_the_end_of_the_section_belongs_to_it(section: tuple[float, float], count: int) -> None:
    assert len(list_line_supports([150.0], 60.0, section) or ()) == count


def test_support_outside_the_section_is_left_out() -> None:
    assert list_line_supports([90.0, 130.0, 410.0], 300.0, SECTION) == (130.0,)
    assert list_line_supports([90.0, 410.0], 60.0, SECTION) == ()


def test_supports_are_unknown_without_the_length_of_a_span() -> None:
    assert list_line_supports([120.0, 180.0], None, SECTION) is None
