"""Record and samples: impossible arrays are refused by name, and missing channels follow from the speed."""

import math
from contextlib import nullcontext
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.record_keys import record_keys
from pantocheck.conformance.records import record as record_module
from pantocheck.conformance.records.record import LARGEST_NUMBER, Record, RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, analysis_section, build_record, complete_samples


def change(record: Record, **changes: Any) -> Record:
    """Record with other values."""
    return Record(**({item.name: getattr(record, item.name) for item in fields(record) if item.init} | changes))


def put(values: Any, index: Any, value: float) -> Any:
    """Copy of an array with one other value."""
    array = np.array(values)
    array[index] = value
    return array


UNPAIRED = "uplift and positions of the supports are needed together"


@pytest.mark.parametrize(
    ("channel", "changes", "found"),
    [
        ("force", lambda r: {"force": r.force[0]}, r"has the shape \(400,\), expected \(pantographs, 400\)"),
        ("force", lambda r: {"force": r.force[:, 1:]}, r"has the shape \(2, 399\), expected \(pantographs, 400\)"),
        ("position", lambda r: {"position": r.position[:1]}, r"\(1, 400\), expected \(2, 400\) as for the force"),
        ("contact_height", lambda r: {"contact_height": r.contact_height[:, 1:]}, r"\(2, 399\), expected \(2, 400\)"),
        ("support_uplift", lambda r: {"support_position": None}, UNPAIRED),
        ("support_uplift", lambda r: {"support_uplift": None}, UNPAIRED),
        ("support_uplift", lambda r: {"support_uplift": r.support_uplift[1:]}, r"\(2, 400\), expected \(3, 400\)"),
        ("support_uplift", lambda r: {"support_uplift": r.support_uplift[:, 1:]}, r"\(3, 399\), expected \(3, 400\)"),
        (
            "support_uplift",
            lambda r: {"support_position": r.support_position[None]},
            r"\(3, 400\), expected \(3, 400\)",
        ),
        ("position", lambda r: {"position": put(r.position, (1, 7), r.position[1, 6])}, "does not increase from each"),
        ("position", lambda r: {"position": put(r.position, (1, 7), 0.0)}, "does not increase from each sample"),
        ("speed", lambda r: {"speed": 0.0}, "found 0 m/s, expected a positive speed"),
        ("speed", lambda r: {"speed": -60.0}, "found -60 m/s, expected a positive speed"),
        ("speed", lambda r: {"speed": math.inf}, "found inf m/s, expected a positive speed"),
        ("evaluated", lambda r: {"evaluated": (160.0, 160.0)}, "from 160 m to 160 m is empty"),
        ("evaluated", lambda r: {"evaluated": (165.0, 160.0)}, "from 165 m to 160 m is empty"),
        ("evaluated", lambda r: {"evaluated": (-math.inf, 160.0)}, "from -inf m to 160 m is empty"),
        ("filter_applied_Hz", lambda r: {"filter_applied_Hz": 0.0}, "found 0 Hz, expected a positive cut-off"),
        ("filter_applied_Hz", lambda r: {"filter_applied_Hz": math.inf}, "found inf Hz, expected a positive cut-off"),
        ("time", lambda r: {"time": r.time[:1]}, "fewer than two samples"),
        ("time", lambda r: {"time": r.time[None]}, "fewer than two samples"),
        ("time", lambda r: {"time": r.time[::-1]}, "not evenly spaced in time"),
        ("time", lambda r: {"time": 0 * r.time}, "not evenly spaced in time"),
        ("time", lambda r: {"time": r.time**2}, "not evenly spaced in time"),
        (
            "force",
            lambda r: {"force": put(r.force, (1, [7, 9]), math.nan)},
            "2 values are not finite, the first at sample 8",
        ),
        ("force", lambda r: {"force": put(r.force, (1, 7), 2e9)}, r"sample 8 has the impossible value 2e\+09"),
        ("force", lambda r: {"force": put(r.force, (1, 7), -1.01e9)}, r"sample 8 has the impossible value -1\.01e\+09"),
    ],
)
def test_impossible_array_is_refused(channel: str, changes: Any, found: str, two_pantograph_record: Record) -> None:
    with pytest.raises(RecordInvalid, match=found) as caught:
        change(two_pantograph_record, **changes(two_pantograph_record))
    assert caught.value.channel == channel


def test_largest_and_smallest_record(two_pantograph_record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    force = put(two_pantograph_record.force, (1, 7), LARGEST_NUMBER)
    assert change(two_pantograph_record, force=force, filter_applied_Hz=20.0).force.max() == 1e9
    two = Record(np.array([0.0, 0.5]), 1.0, np.array([[0.0, 0.5]]), np.ones((1, 2)), (0.0, 0.5))
    assert (two.rate, two.pantographs) == (2.0, 1)
    # The uplift of three supports is the largest array: 1200 numbers.
    monkeypatch.setattr(record_module, "MAX_SAMPLES", 1200)
    assert change(two_pantograph_record).support_uplift is not None
    monkeypatch.setattr(record_module, "MAX_SAMPLES", 1199)
    with pytest.raises(RecordInvalid, match="support_uplift: has 1200 values, at most 1199 are accepted"):
        change(two_pantograph_record)


def test_arrays_are_copied_and_read_only(two_pantograph_record: Record) -> None:
    force = np.array(two_pantograph_record.force)
    record = change(two_pantograph_record, force=force)
    force[0, 0] = 0.0
    assert record.force[0, 0] == two_pantograph_record.force[0, 0] != 0.0
    with pytest.raises(ValueError, match="read-only"):
        record.force[0, 0] = 0.0


@pytest.mark.parametrize(("share", "even"), [(0.009, True), (0.011, False), (0.5, False)])
@pytest.mark.parametrize("sign", [-1, 1])
def test_time_is_even_to_a_hundredth(share: float, even: bool, sign: int, two_pantograph_record: Record) -> None:
    """Printed times are rounded by less; a gap is a whole step, as after a lost line of a file."""
    record = two_pantograph_record
    for sample in (1, 200, 398):
        time = put(record.time, sample, record.time[sample] + sign * share / 200)
        with nullcontext() if even else pytest.raises(RecordInvalid, match="not evenly spaced"):
            assert change(record, time=time).rate == pytest.approx(200.0)
        kept = np.delete(np.arange(400), sample)
        channels = {name: getattr(record, name)[:, kept] for name in ("position", "force", "support_uplift")}
        with pytest.raises(RecordInvalid, match="not evenly spaced"):
            change(record, time=record.time[kept], contact_height=None, **channels)


def sidecar(**keys: Any) -> RecordSidecar:
    """Sidecar of two pantographs 100 m apart at 180 km/h, 50 m/s."""
    base = {"speed_km_h": 180.0, "pantographs": 2, "spacing_m": [100.0]}
    return RecordSidecar.model_validate(record_keys(**base | keys))


FORCE = np.full((2, 401), 120.0)
TIME = np.arange(401) / 100


def test_time_and_position_of_a_changing_speed_are_integrated() -> None:
    """A speed of 50 m/s + 2 m/s2 t gives x = 50 t + t^2; trapezoids are exact for it, up to rounding."""
    speed = 50 + 2 * TIME
    time, position = complete_samples(RecordSamples(FORCE, TIME, speed), sidecar(start_m=300.0))
    assert_allclose(time, TIME, rtol=0)
    assert_allclose(position[0], 300 + 50 * TIME + TIME**2, rtol=1e-12)
    assert_allclose(position[1], position[0] - 100, rtol=1e-12)
    # With 1/v linear in the position, 1/v = (2 + x / 400) / 100, trapezoids are exact: t = (2 x + x^2 / 800) / 100.
    x = np.arange(401.0)
    time, position = complete_samples(
        RecordSamples(FORCE, speed=100 / (2 + x / 400), position=(x + 50)[None]), sidecar()
    )
    assert_allclose(time, (2 * x + x**2 / 800) / 100, rtol=1e-12)
    assert_allclose(position, [x + 50, x - 50], rtol=1e-12)


@pytest.mark.parametrize(
    ("samples", "keys", "message"),
    [
        ({}, {}, "time: time and position are both missing"),
        ({"time": TIME}, {"spacing_m": None}, "position: missing, and the sidecar does not state spacing_m"),
        ({"time": TIME}, {"case": "a"}, "position: missing, and the sidecar does not state start_m"),
        ({"time": TIME}, {"evaluated_m": [0.0, 50.0]}, "position: missing, and the sidecar does not state start_m"),
        ({"time": TIME}, {"support_position_m": [0.0]}, "position: missing, and the sidecar does not state start_m"),
        ({"position": TIME[None], "speed": 0 * TIME}, {}, "speed: the value of sample 1 is not positive"),
        ({"position": TIME[None], "speed": np.where(TIME < 2, 50, -1)}, {}, "the value of sample 201 is not positive"),
    ],
)
def test_train_without_a_place_is_refused(samples: dict[str, Any], keys: dict[str, Any], message: str) -> None:
    described = sidecar(**keys) if keys.get("spacing_m", 1) else sidecar().model_copy(update={"spacing_m": None})
    with pytest.raises(RecordInvalid, match=message):
        complete_samples(RecordSamples(FORCE, **samples), described)


def test_train_of_no_case_starts_at_zero_and_shares_a_section() -> None:
    """Without case, section and supports, the origin of the track is of no importance."""
    _, position = complete_samples(RecordSamples(FORCE, TIME), sidecar())
    assert_allclose(position[:, 0], [0.0, -100.0], rtol=0)
    single = sidecar(pantographs=1, spacing_m=None)
    assert complete_samples(RecordSamples(FORCE[:1], TIME), single)[1].shape == (1, 401)
    # The last pantograph begins at -100 m and ends at 100 m, the first begins at 0 m.
    _, position = complete_samples(RecordSamples(FORCE, TIME), sidecar())
    assert analysis_section(sidecar(), position) == pytest.approx((0.0, 100.0), abs=1e-9)  # rounding of the integral
    assert analysis_section(sidecar(evaluated_m=[20.0, 30.0]), position) == (20.0, 30.0)


@pytest.mark.parametrize(("factor", "agrees"), [(0.994, False), (0.996, True), (1.004, True), (1.006, False)])
def test_speed_channel_agrees_to_half_a_percent(factor: float, agrees: bool) -> None:
    """Half a percent is a tenth of the width of a resonance."""
    samples = RecordSamples(FORCE, TIME, np.full(401, 50 * factor), 50 * TIME[None])
    message = f"speed: ranges from {180 * factor:.4g} to .* km/h, but the sidecar states 180 km"
    with nullcontext() if agrees else pytest.raises(RecordInvalid, match=message):
        assert build_record(samples, sidecar()).speed == pytest.approx(50.0, rel=1e-12)


@pytest.mark.parametrize(("section", "agrees"), [([0.0, 60.0], True), ([80.0, 140.0], False), ([900.0, 950.0], False)])
def test_speed_channel_is_compared_inside_the_section_of_any_pantograph(section: list[float], agrees: bool) -> None:
    """The train brakes after 3.5 s, where the first pantograph is at 175 m and the last at 75 m."""
    # No pantograph reaches 900 m: then the whole channel is compared.
    speed = np.where(TIME < 3.5, 50.0, 25.0)
    samples = RecordSamples(FORCE, TIME, speed, 50 * TIME[None])
    described = sidecar(evaluated_m=section)
    with nullcontext() if agrees else pytest.raises(RecordInvalid, match="but the sidecar states 180 km/h"):
        assert build_record(samples, described).evaluated == tuple(section)


@pytest.mark.parametrize("name", ["time", "speed", "position", "contact_height"])
def test_missing_value_is_named_by_its_first_sample(name: str) -> None:
    """The first sample in time counts, in whichever row."""
    channels = {
        "time": TIME,
        "speed": np.full(401, 50.0),
        "position": 50 * TIME - np.array([[0.0], [100.0]]),
        "contact_height": np.zeros((2, 401)),
    }
    values = np.array(channels[name])
    values[..., 30] = math.nan
    values[(0, 90) if values.ndim == 2 else 90] = math.nan
    count = 3 if values.ndim == 2 else 2
    samples = RecordSamples(FORCE, **(channels | {name: values}))
    with pytest.raises(RecordInvalid, match=f"{name}: {count} values are not finite, the first at sample 31"):
        build_record(samples, sidecar())
