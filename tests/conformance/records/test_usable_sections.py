"""Usable parts of a measured record: local speed, gaps, shortest part, resampling."""

from collections.abc import Sequence
from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from helpers.record_keys import record_keys
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pages.translation import translate
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples
from pantocheck.conformance.records.usable_sections import (
    PlacedSamples,
    UsableSection,
    find_usable_sections,
    list_line_supports,
    local_speed,
    place_samples,
    resample_section,
)


@pytest.mark.parametrize(("size", "rate"), [(1001, 101.0), (301, 51.0)])
def test_speed_is_averaged_over_a_second(size: int, rate: float) -> None:
    """Both rates are odd: the second is centred with one sample less. At the ends it is the first or last one."""
    time = np.arange(size) / rate
    position = 50 * time + np.random.default_rng(3).uniform(0, 0.3, size)
    half = round(rate / 2)
    expected = (position[2 * half :] - position[: -2 * half]) / (2 * half / rate)
    found = local_speed(time, position)
    assert_allclose(found[half:-half], expected, rtol=1e-9)
    assert_allclose(found[[0, -1]], expected[[0, -1]], rtol=1e-9)


@pytest.mark.parametrize(
    ("step", "gap", "parts"),
    [
        (0.002, 0.0119, 1),  # a step and 10 ms
        (0.002, 0.0121, 2),
        (0.05, 0.074, 1),  # one and a half steps
        (0.05, 0.076, 2),
    ],
)
def test_gap_is_longer_than_ten_milliseconds_and_half_a_step(step: float, gap: float, parts: int) -> None:
    time = np.concatenate([np.arange(0, 2, step), 2 - step + gap + np.arange(0, 3, step)])
    found = find_usable_sections(time, np.full(time.size, True))
    assert len(found) == parts
    assert_array_equal(np.concatenate(found), np.arange(time.size))


def test_unusable_samples_are_a_gap_and_short_records_have_a_speed() -> None:
    time = np.arange(1000) / 100
    usable = np.full(1000, True)
    usable[300:310] = False
    first, second = find_usable_sections(time, usable)
    assert (first[0], first[-1], second[0], second[-1]) == (0, 299, 310, 999)
    assert find_usable_sections(time, np.full(1000, False)) == []
    # Five samples in half a second, and samples every 2.5 s: the slope of a straight line.
    for time in (np.arange(5) / 10, np.arange(4) * 2.5):
        assert_allclose(local_speed(time, 50 * time), 50.0, rtol=1e-12)
    coarse = np.arange(4) * 2.5  # x = t^2: means over the two intervals around a sample, or at the end
    assert_allclose(local_speed(coarse, coarse**2), [5.0, 5.0, 10.0, 10.0], rtol=1e-12)


@pytest.mark.parametrize(("samples", "found"), [(100, 0), (102, 1)])
def test_part_lasts_at_least_a_second(samples: int, found: int) -> None:
    """At 100 Hz, 100 samples last 0.99 s and 102 samples 1.01 s."""
    assert len(find_usable_sections(np.arange(samples) / 100, np.full(samples, True))) == found


def section(time: RealArray, height: bool = True) -> UsableSection:
    return UsableSection(50 * time, 120 + 3 * time, 0.01 * time if height else None)


def test_even_samples_are_kept() -> None:
    """300 samples, of which one is 0.3 %. The times are rounded by up to 1 % of a step, the rate by 0.1 %."""
    time = np.arange(300) / 100
    channels = section(time)
    rounding = 0.9e-4 * (-1.0) ** np.arange(300)
    rounding[[0, -1]] = 0.0
    for rounded, rate in ((time, 100.0), (time + rounding, 100.0), (time, 100.08), (time, 99.92)):
        kept = resample_section(rounded, channels, rate)
        assert kept.force is channels.force
        assert kept.position is channels.position
        assert kept.height is channels.height


@pytest.mark.parametrize(
    ("time", "rate", "size"),
    [
        (np.arange(300) / 100, 100.2, 300),  # even at another rate
        (np.arange(300) / 100, 99.8, 299),
        (np.arange(300) / 100 + 1.5e-4 * np.sin(np.pi * (np.arange(300) % 3) / 2), 100.0, 300),  # 1.5 % of a step
        (7 + np.linspace(0, 1, 300) ** 1.1 * 2.99, 100.0, 300),  # uneven
    ],
)
@pytest.mark.parametrize("height", [True, False])
def test_uneven_samples_are_interpolated(time: RealArray, rate: float, size: int, height: bool) -> None:
    """Channels that are linear in time remain so: interpolation by cubics is exact for them, up to rounding."""
    resampled = resample_section(time, section(time, height), rate)
    even = time[0] + np.arange(size) / rate
    assert_allclose(resampled.position, 50 * even, rtol=1e-11)
    assert_allclose(resampled.force, 120 + 3 * even, rtol=1e-11)
    if height:
        assert resampled.height is not None
        assert_allclose(resampled.height, 0.01 * even, rtol=1e-11)
    else:
        assert resampled.height is None


def test_interpolation_creates_no_extreme() -> None:
    """A step of the force: a cubic spline would overshoot by some percent."""
    time = np.linspace(0, 1, 300) ** 1.1 * 2.99
    force = np.where(time < 1.5, 0.0, 100.0)
    resampled = resample_section(time, UsableSection(50 * time, force, None), 400.0).force
    assert (resampled.min(), resampled.max()) == (0.0, 100.0)


@pytest.mark.parametrize("rate", [100.0, 100.2])
def test_height_with_a_missing_value_is_dropped(rate: float) -> None:
    time = np.arange(300) / 100
    height = np.where(time == 1.0, np.nan, 0.01)
    assert resample_section(time, UsableSection(50 * time, 3 * time, height), rate).height is None


# Supports of a measured line: listed ones, and those that must stand between and beside them.


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


def test_supports_outside_are_left_out_and_unknown_without_a_span() -> None:
    assert list_line_supports([90.0, 130.0, 410.0], 300.0, SECTION) == (130.0,)
    assert list_line_supports([90.0, 410.0], 60.0, SECTION) == ()
    assert list_line_supports([120.0, 180.0], None, SECTION) is None


# Time and position of measured samples: discarded samples, pulse counters, axes that do not increase.


SAMPLES = 200
TIME = np.arange(SAMPLES) / 100
POSITION = 300 + 50 * TIME
FORCE = np.array([np.arange(SAMPLES), 1000 + np.arange(SAMPLES)], dtype=float)
"""The force is the number of its sample, so that a test sees the samples that remain."""


def place(**channels: Any) -> PlacedSamples:
    """Two pantographs 100 m apart at 180 km/h, 50 m/s."""
    sidecar = RecordSidecar.model_validate(record_keys(speed_km_h=180.0, pantographs=2, spacing_m=[100.0]))
    return place_samples(RecordSamples(channels.pop("force", FORCE), **channels), sidecar)


def put(values: Any, index: Any, value: float) -> Any:
    """Copy of an array with other values at an index."""
    array = np.array(values, dtype=float)
    array[..., index] = value
    return array


@pytest.mark.parametrize("channel", ["time", "speed", "position"])
def test_samples_without_an_axis_are_discarded(channel: str) -> None:
    """Four of 200 samples are 2 %."""
    channels = {"time": TIME, "speed": np.full(SAMPLES, 50.0), "position": POSITION[None]}
    missing = np.array([0, 7, 8, 120])
    placed = place(**(channels | {channel: put(channels[channel], missing, np.nan)}))
    kept = np.delete(np.arange(SAMPLES), missing)
    assert_array_equal(placed.samples.force, FORCE[:, kept])
    assert_array_equal(placed.time, TIME[kept])
    assert_allclose(placed.position, [POSITION[kept], POSITION[kept] - 100], rtol=1e-12)
    assert placed.warnings == ("2 % of the samples were discarded: they have no time or no position",)


def test_position_missing_for_one_pantograph_discards_the_sample() -> None:
    position = np.array([POSITION, POSITION - 80])
    position[1, 50] = np.nan
    placed = place(time=TIME, position=position)
    assert placed.samples.force.shape == (2, SAMPLES - 1)
    assert_allclose(placed.position[1], np.delete(POSITION, 50) - 80, rtol=1e-12)


@pytest.mark.parametrize("moving", [0, 1])
def test_train_that_stands_still_has_no_record(moving: int) -> None:
    """One sample has a place, but no duration."""
    speed = np.where(np.arange(SAMPLES) < SAMPLES - moving, 0.0, 50.0)
    with pytest.raises(RecordInvalid, match="speed: fewer than two samples have a positive speed"):
        place(speed=speed, position=POSITION[None])


def test_standing_train_has_samples_only_where_it_moves() -> None:
    speed = np.where(np.arange(SAMPLES) < SAMPLES - 2, 0.0, 50.0)
    assert_allclose(place(speed=speed, position=POSITION[None]).time, [0.0, 0.01], atol=1e-12)
    # The first 20 of 200 samples, 10 %; with a time channel they remain, and the position may stand still.
    position = np.maximum(POSITION, POSITION[19])
    speed = np.where(np.arange(SAMPLES) < 20, 0.0, 50.0)
    placed = place(speed=speed, position=position[None])
    assert_array_equal(placed.samples.force, FORCE[:, 20:])
    assert_allclose(placed.time, TIME[20:] - TIME[20], atol=1e-9)
    assert placed.warnings == ("10 % of the samples were discarded: the train stands still",)
    assert place(time=TIME, speed=speed, position=POSITION[None]).samples.force.shape == (2, SAMPLES)
    assert place(speed=np.full(SAMPLES, 50.0), position=POSITION[None]).warnings == ()


@pytest.mark.parametrize("jitter_m", [0.0, 0.2])
def test_kilometres_with_four_decimals_keep_the_ends_of_a_record(jitter_m: float) -> None:
    """At 1 kHz and 70 m/s the positions stand still or step by 0.1 m, and noise moves them back and forth."""
    time = np.arange(5000) / 1000
    noise = jitter_m * np.random.default_rng(3).uniform(-0.5, 0.5, time.size)
    position = np.round(70.0 * time + noise, 1)[None]
    placed = place(force=np.ones((2, time.size)), time=time, position=position)
    assert np.all(np.diff(placed.position) > 0)
    # Half of the noise beside half of a step, and the smoothing adds no more.
    assert np.abs(placed.position[0] - 70.0 * placed.time).max() < 0.1 + jitter_m
    # A step and twice half of the noise over 70 m.
    assert np.abs(local_speed(placed.time, placed.position[0]) / 70 - 1).max() < (0.1 + jitter_m) / 60
    assert [text.startswith("the position runs back by up to 0.") for text in placed.warnings] == [True] * bool(
        jitter_m
    )
    assert [translate(text, "de").missing for text in placed.warnings] == [()] * len(placed.warnings)


@pytest.mark.parametrize(("fall", "refused"), [(0.49, False), (0.51, True)])
def test_train_that_runs_back_further_than_a_support_is_known_is_refused(fall: float, refused: bool) -> None:
    position = put(POSITION[None], 70, POSITION[69] - fall)
    refusal = pytest.raises(RecordInvalid, match=r"noise of 0\.5 m is smoothed")
    with refusal if refused else nullcontext():
        (warning,) = place(time=TIME, position=position).warnings
        assert warning == "the position runs back by up to 0.49 m; it was smoothed"


@pytest.mark.parametrize(("known", "refused"), [(1, True), (2, False)])
def test_two_samples_with_time_and_position_are_needed(known: int, refused: bool) -> None:
    time = put(TIME, np.arange(SAMPLES) >= known, np.nan)
    refusal = pytest.raises(RecordInvalid, match="time: fewer than two samples have a time or position")
    with refusal if refused else nullcontext():
        assert place(time=time).time.size == 2


def test_pulse_counter_is_interpolated_between_its_steps() -> None:
    """A pulse every 2 m, four samples: straight lines from step to step give the position again, up to rounding."""
    # The samples behind the last step are left out, because their position is unknown.
    counted = 2 * np.floor(POSITION / 2)
    steps = np.flatnonzero(np.diff(counted)) + 1
    placed = place(time=TIME, position=counted[None])
    last = steps[-1]
    assert last < SAMPLES - 1
    assert_array_equal(placed.time, TIME[: last + 1])
    assert_array_equal(placed.samples.force, FORCE[:, : last + 1])
    assert_allclose(placed.position, [POSITION[: last + 1], POSITION[: last + 1] - 100], atol=1e-9)


@pytest.mark.parametrize(
    ("channels", "channel", "sample"),
    [
        ({"time": put(TIME, 70, TIME[69]), "position": POSITION[None]}, "time", 71),
        ({"time": TIME, "position": put(POSITION[None], 70, 0.0)}, "position", 71),
        ({"position": put(POSITION[None], 70, POSITION[69])}, "", 71),
        # The counter stands still: one step at the beginning only.
        ({"time": TIME, "position": np.full((1, SAMPLES), 300.0)}, "position", 2),
        # The second pantograph alone goes back.
        ({"time": TIME, "position": np.array([POSITION, put(POSITION, 90, 0.0)])}, "position", 91),
        # Both have a fault: that of the earlier sample is named.
        ({"time": TIME, "position": np.array([put(POSITION, 120, 0.0), put(POSITION, 90, 0.0)])}, "position", 91),
    ],
)
def test_axis_that_does_not_increase_is_refused(channels: dict[str, Any], channel: str, sample: int) -> None:
    message = f"{channel}: the value of sample {sample} is not greater than that of sample {sample - 1}"
    with pytest.raises(RecordInvalid, match=message if channel else message[2:]):
        place(**channels)
