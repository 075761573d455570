"""Time and position of measured samples: discarded samples, pulse counters, axes that do not increase."""

from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples
from pantocheck.conformance.records.usable_sections import PlacedSamples, place_samples

N = 200
TIME = np.arange(N) / 100
POSITION = 300 + 50 * TIME
FORCE = np.array([np.arange(N), 1000 + np.arange(N)], dtype=float)
"""The force is the number of its sample, so that a test sees the samples that remain."""


def place(**channels: Any) -> PlacedSamples:
    """Two pantographs 100 m apart at 180 km/h, 50 m/s."""
    keys = {"schema": "pantocheck.record/1", "file": "a.csv", "speed_km_h": 180.0, "pantographs": 2}
    sidecar = RecordSidecar.model_validate({**keys, "filter_applied_Hz": "none", "spacing_m": [100.0]})
    return place_samples(RecordSamples(channels.pop("force", FORCE), **channels), sidecar)


def change(values: Any, index: Any, value: float) -> Any:
    """Copy of an array with other values at an index."""
    array = np.array(values, dtype=float)
    array[..., index] = value
    return array


@pytest.mark.parametrize("channel", ["time", "speed", "position"])
def test_samples_without_an_axis_are_discarded(channel: str) -> None:
    """Four of 200 samples are 2 %."""
    channels = {"time": TIME, "speed": np.full(N, 50.0), "position": POSITION[None]}
    missing = np.array([0, 7, 8, 120])
    placed = place(**(channels | {channel: change(channels[channel], missing, np.nan)}))
    kept = np.delete(np.arange(N), missing)
    assert_array_equal(placed.samples.force, FORCE[:, kept])
    assert_array_equal(placed.time, TIME[kept])
    assert_allclose(placed.position, [POSITION[kept], POSITION[kept] - 100], rtol=1e-12)
    assert placed.warnings == ("2 % of the samples were discarded: they have no time or no position",)


def test_position_missing_for_one_pantograph_discards_the_sample() -> None:
    position = np.array([POSITION, POSITION - 80])
    position[1, 50] = np.nan
    placed = place(time=TIME, position=position)
    assert placed.samples.force.shape == (2, N - 1)
    assert_allclose(placed.position[1], np.delete(POSITION, 50) - 80, rtol=1e-12)


def test_samples_of_a_standing_train_are_discarded_where_time_follows_from_speed() -> None:
    """The first 20 of 200 samples, 10 %; with a time channel they remain, and the position may stand still."""
    position = np.maximum(POSITION, POSITION[19])
    speed = np.where(np.arange(N) < 20, 0.0, 50.0)
    placed = place(speed=speed, position=position[None])
    assert_array_equal(placed.samples.force, FORCE[:, 20:])
    assert_allclose(placed.time, TIME[20:] - TIME[20], atol=1e-9)
    assert placed.warnings == ("10 % of the samples were discarded: the train stands still",)
    assert place(time=TIME, speed=speed, position=POSITION[None]).samples.force.shape == (2, N)
    assert place(speed=np.full(N, 50.0), position=POSITION[None]).warnings == ()


@pytest.mark.parametrize("moving", [0, 1])
def test_train_that_stands_still_has_no_record(moving: int) -> None:
    """One sample has a place, but no duration."""
    speed = np.where(np.arange(N) < N - moving, 0.0, 50.0)
    with pytest.raises(RecordInvalid, match="speed: fewer than two samples have a positive speed"):
        place(speed=speed, position=POSITION[None])


def test_two_moving_samples_are_a_record() -> None:
    speed = np.where(np.arange(N) < N - 2, 0.0, 50.0)
    assert_allclose(place(speed=speed, position=POSITION[None]).time, [0.0, 0.01], atol=1e-12)


@pytest.mark.parametrize(("known", "refused"), [(1, True), (2, False)])
def test_two_samples_with_time_and_position_are_needed(known: int, refused: bool) -> None:
    time = change(TIME, np.arange(N) >= known, np.nan)
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
    assert last < N - 1
    assert_array_equal(placed.time, TIME[: last + 1])
    assert_array_equal(placed.samples.force, FORCE[:, : last + 1])
    assert_allclose(placed.position, [POSITION[: last + 1], POSITION[: last + 1] - 100], atol=1e-9)


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        (
            {"time": change(TIME, 70, TIME[69]), "position": POSITION[None]},
            "time: the value of sample 71 is not greater than that of sample 70",
        ),
        (
            {"time": TIME, "position": change(POSITION[None], 70, 0.0)},
            "position: the value of sample 71 is not greater than that of sample 70",
        ),
        (
            {"position": change(POSITION[None], 70, POSITION[69])},
            "the value of sample 71 is not greater than that of sample 70",
        ),
        # The counter stands still: one step at the beginning only.
        (
            {"time": TIME, "position": np.full((1, N), 300.0)},
            "position: the value of sample 2 is not greater than that of sample 1",
        ),
        # The second pantograph alone goes back.
        (
            {"time": TIME, "position": np.array([POSITION, change(POSITION, 90, 0.0)])},
            "position: the value of sample 91 is not greater than that of sample 90",
        ),
        # Both have a fault: that of the earlier sample is named.
        (
            {"time": TIME, "position": np.array([change(POSITION, 120, 0.0), change(POSITION, 90, 0.0)])},
            "position: the value of sample 91 is not greater than that of sample 90",
        ),
    ],
)
def test_axis_that_does_not_increase_is_refused(channels: dict[str, Any], message: str) -> None:
    with pytest.raises(RecordInvalid, match=message):
        place(**channels)
