"""Geometry of a line: positions of spans, supports and sections."""

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.geometry import EqualSpans


@pytest.fixture
def geometry() -> EqualSpans:
    return EqualSpans(span_m=60.0, spans=5, encumbrance_m=1.2, trust="secondary", source="test")


def test_spans_follow_each_other_from_zero_to_the_length_of_the_line(geometry: EqualSpans) -> None:
    spans = [geometry.span(number) for number in range(1, geometry.spans + 1)]
    assert spans[0][0] == 0.0
    assert spans[-1][1] == geometry.length == 300.0
    assert [end for _, end in spans[:-1]] == [start for start, _ in spans[1:]] == list(geometry.supports)
    assert geometry.span_lengths == tuple(end - start for start, end in spans)
    assert geometry.longest_span == geometry.shortest_span == 60.0


def test_section_covers_its_first_and_its_last_span(geometry: EqualSpans) -> None:
    assert geometry.section(2, 4) == (geometry.span(2)[0], geometry.span(4)[1])


def test_middle_span_lies_half_way_along_the_line(geometry: EqualSpans) -> None:
    assert geometry.mid_span(geometry.middle_span) == geometry.length / 2


def test_shorten_keeps_the_first_spans_and_never_adds_any(geometry: EqualSpans) -> None:
    assert geometry.shorten(2).span_limits == geometry.span_limits[:3]
    assert geometry.shorten(9) == geometry


def test_run_ends_at_most_half_a_span_before_the_end_of_the_line() -> None:
    """The first of two pantographs 200 m apart would otherwise run off the line."""
    for case in select_cases(["*"]):
        if not case.is_static and case.file.run_out_m is None:
            geometry, front = case.line.geometry, case.end + case.offsets[-1]
            assert front <= geometry.mid_span(geometry.spans) or case.end == case.recorded_section[1]
