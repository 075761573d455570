"""Signals: samples of the analysis section, filter transients, and supports."""

from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES
from pantocheck.conformance.quantities.line_signals import LineSignals, supports_inside
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals, edge_warnings
from pantocheck.conformance.quantities.unavailable import (
    BandNotObservable,
    ChannelMissing,
    SectionNotCovered,
    SupportsMissing,
)

RATE, SPEED = 1000.0, 50.0


def pantograph(
    section: tuple[float, float], start: float = 0.0, samples: int = 12_000, cutoff: float = 20.0, step: float = 0.05
) -> PantographSignals:
    """Pantograph from `start` at 50 m/s: 0.05 m between samples."""
    position = start + step * np.arange(samples)
    force = 119.0 + 28.0 * np.sin(2 * np.pi * position / 60)
    return PantographSignals(position, ForceChannel(force, RATE, Filter(cutoff_Hz=cutoff)), section)


@pytest.mark.parametrize(
    ("section", "first", "last"),
    [
        ((200.0, 400.0), 4000, 8000),  # the end itself is outside
        ((200.0 + 1e-10, 400.0 + 1e-10), 4000, 8000),  # positions are rounded
        ((200.0 - 1e-10, 400.0 - 1e-10), 4000, 8000),
        ((200.0 + 7e-10, 400.0 + 7e-10), 4000, 8000),
        ((200.0 + 1.5e-9, 400.0 + 1.5e-9), 4001, 8001),
        ((200.01, 400.01), 4001, 8001),
        ((199.99, 399.99), 4000, 8000),
    ],
)
def test_section_holds_its_samples(section: tuple[float, float], first: int, last: int) -> None:
    """A tolerance of a nanometre for positions in floating point: 200 m is sample 4000."""
    inside = pantograph(section).inside
    assert (inside.start, inside.stop) == (first, last)


@pytest.mark.parametrize(
    ("first", "samples", "covered"),
    [
        (0.0, 4000, True),  # one step before the end
        (1.0, 4000, True),
        (1.25, 4000, False),
        (0.0, 3999, False),
        (-100.0, 4100, True),
        (-100.0, 4099, False),
    ],
)
def test_section_is_covered_to_one_sample(first: float, samples: int, covered: bool) -> None:
    """The record begins some steps behind the start of the section; a step of a sixteenth of a metre is exact."""
    signals = pantograph((200.0, 450.0), start=200 + first / 16, samples=samples, step=1 / 16)
    refusal = pytest.raises(SectionNotCovered, match="the analysis section extends from 200 m to 450 m")
    with nullcontext() if covered else refusal:
        assert signals.delivered.size > 0


@pytest.mark.parametrize(
    ("before", "after", "warned"), [(5.0, 5.0, False), (4.9, 6.0, True), (6.0, 4.8, True), (5.1, 5.1, False)]
)
@pytest.mark.parametrize("number", [1, 2])
def test_filter_needs_room(before: float, after: float, warned: bool, number: int) -> None:
    """Two periods of 20 Hz at 50 m/s are 5 m, on either side of the section of either pantograph."""
    position = np.linspace(200 - before, 400 + after, 4201)
    channel = ForceChannel(np.full(position.size, 119.0), RATE, Filter())
    train = {n: pantograph((200.0, 400.0)) for n in (1, 2)}
    train[number] = PantographSignals(position, channel, (200.0, 400.0))
    warnings = edge_warnings(train, SPEED)
    assert len(warnings) == warned
    assert all(f"pantograph {number} begins or ends less than 5.0 m outside" in text for text in warnings)


@pytest.mark.parametrize(
    ("length", "graded", "extended"), [(10.0, True, True), (9.95, False, True), (3.95, False, False)]
)
def test_statistic_needs_four_periods_of_its_cutoff(length: float, graded: bool, extended: bool) -> None:
    """Four periods of 20 Hz are 0.2 s or 10 m; those of 50 Hz are 0.08 s or 4 m."""
    signals = pantograph((200.0, 200.0 + length))
    for name, available in (("graded", graded), ("extended", extended)):
        with nullcontext() if available else pytest.raises(BandNotObservable, match="need at least"):
            assert getattr(signals, name).size == round(length / 0.05)


def passing(end: float) -> np.ndarray:
    """Positions of the last pantograph in the three samples of `line`."""
    return np.array([170.0, 240.0, end])


def line(**changes: Any) -> LineSignals:
    """Supports every 60 m, each with an uplift."""
    position = changes.pop("support_position", np.array([180.0, 240.0, 300.0, 360.0, 420.0]))
    uplift = changes.pop("support_uplift", np.outer(np.arange(1.0, position.size + 1) / 100, [0.0, 1.0, 0.5]))
    known = {"line_supports": (180.0, 240.0, 300.0, 360.0, 420.0), "last_position": passing(500.0)}
    return LineSignals((240.0, 360.0), position, uplift, **(known | changes))


def test_supports_and_uplift_of_the_section_or_the_reason_without_them() -> None:
    assert_allclose(line().supports, [240.0, 300.0, 360.0])
    assert_allclose(line().uplift.max(axis=1), [0.02, 0.03, 0.04])
    line().check_supports()
    (uplift,) = LINE_QUANTITIES  # in millimetres
    assert uplift.support_values(line()).max() == uplift.compute(line()) == pytest.approx(40.0)
    supports = np.array([199.4, 199.5, 200.0, 300.0, 400.5, 400.6])
    assert supports_inside(supports, (200.0, 400.0)).tolist() == [False, True, True, True, True, False]
    with pytest.raises(SupportsMissing, match="does not state span_m"):
        line(line_supports=None).check_supports()
    with pytest.raises(ChannelMissing, match="the record has no uplift at supports"):
        _ = LineSignals((240.0, 360.0)).supports
    with pytest.raises(ChannelMissing, match="the record has no uplift at a support between 500 m and 600 m"):
        _ = LineSignals((500.0, 600.0), np.array([300.0]), np.array([[0.0, 0.05]])).uplift


@pytest.mark.parametrize("support", [0, 1, 2])
def test_sensor_that_never_moves_is_no_uplift(support: int) -> None:
    """A dead channel at any value: the other supports remain, and the quantity is missing."""
    uplift = np.outer(np.arange(1.0, 6.0) / 100, [0.0, 1.0, 0.5])
    uplift[1 + support] = 0.01
    signals = line(support_uplift=uplift)
    assert signals.supports.size == 2
    with pytest.raises(
        SupportsMissing, match=f"no uplift at 1 of 3 supports of the analysis section: {240 + 60 * support} m"
    ):
        signals.check_supports()


@pytest.mark.parametrize(("shift", "found"), [(0.5, True), (-0.5, True), (0.6, False), (-0.6, False)])
def test_support_is_recognised_within_half_a_metre(shift: float, found: bool) -> None:
    signals = line(support_position=np.array([180.0, 240.0, 300.0 + shift, 360.0, 420.0]))
    refusal = pytest.raises(SupportsMissing, match=r"no uplift at 1 of 3 supports of the analysis section: 300 m$")
    with nullcontext() if found else refusal:
        signals.check_supports()


@pytest.mark.parametrize(
    ("missing", "places"), [(5, "0 m, 60 m, 120 m, 180 m, 240 m"), (6, "0 m, 60 m, 120 m, 180 m, 240 m, ...")]
)
def test_first_five_missing_supports_are_named(missing: int, places: str) -> None:
    """Uplift at the last support only; a missing sample at all others."""
    supports = tuple(60.0 * n for n in range(missing + 1))
    signals = LineSignals((0.0, supports[-1]), np.array([supports[-1]]), np.array([[0.0, 0.05]]), supports)
    with pytest.raises(SupportsMissing) as caught:
        signals.check_supports()
    assert str(caught.value) == (
        f"the record has no uplift at {missing} of {missing + 1} supports of the analysis section: {places}"
    )
    uplift = np.tile([0.0, np.nan, 0.05], (missing + 1, 1))
    uplift[-1, 1] = 0.0
    signals = LineSignals((0.0, supports[-1]), np.array(supports), uplift, supports, last_position=np.zeros(3))
    with pytest.raises(SupportsMissing, match=f"incomplete at {missing} of {missing + 1} .*: {places}; it must"):
        _ = signals.supports


@pytest.mark.parametrize(("end", "complete"), [(365.0, True), (364.9, False), (np.nan, False)])
def test_uplift_is_complete_five_metres_behind_the_last_support(end: float, complete: bool) -> None:
    """One time for all supports, and an own one for each."""
    own = np.tile(passing(500.0), (5, 1))
    own[3] = passing(end)
    for positions in (passing(end), own):
        refusal = pytest.raises(SupportsMissing, match="uplift of the support at 360 m it must extend to 365 m")
        with nullcontext() if complete else refusal:
            line(last_position=positions).check_supports()


@pytest.mark.parametrize(("reached", "largest"), [(420.0, 0.09), (420.1, 0.04)])
def test_uplift_counts_until_the_last_pantograph_is_60_m_past_the_support(reached: float, largest: float) -> None:
    """A larger uplift of 0.09 m in the last sample, at the support at 360 m."""
    uplift = np.outer(np.arange(1.0, 6.0) / 100, [0.0, 1.0, 0.5])
    uplift[3, 2] = 0.09
    assert line(support_uplift=uplift, last_position=passing(reached)).largest_uplift == largest


@pytest.mark.parametrize("support", [0, 1, 2])
def test_missing_uplift_counts_as_missing_up_to_that_distance(support: int) -> None:
    uplift = np.outer(np.arange(1.0, 6.0) / 100, [0.0, 1.0, 0.5])
    uplift[1 + support, 2] = np.nan
    place = 240.0 + 60.0 * support
    complete = line(support_uplift=uplift, last_position=passing(place + 60.1))
    assert complete.largest_uplift == 0.04
    with pytest.raises(
        SupportsMissing, match=f"incomplete at 1 of 3 supports of the analysis section: {place:g} m; it"
    ):
        _ = line(support_uplift=uplift, last_position=passing(place + 60.0)).largest_uplift
    uplift[1 + support] = np.nan
    with pytest.raises(SupportsMissing, match=f"no uplift at 1 of 3 supports of the analysis section: {place:g} m"):
        line(support_uplift=uplift).check_supports()
