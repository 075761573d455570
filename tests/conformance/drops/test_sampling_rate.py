"""Sampling rate of a mass-drop record: its sources agree to a thousandth, and no sample is missing from its time."""

from contextlib import nullcontext

import numpy as np
import pytest

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.drops.drop_record import find_sampling_rate
from pantocheck.conformance.drops.drop_sidecar import DropSidecar

RATE, N = 400.0, 1200


def build_table(time: RealArray | None = None, rate: float | None = None) -> MeasuredTable:
    size = N if time is None else time.size
    return MeasuredTable("r.csv", np.zeros((size, 1)), (TableColumn(name="S1_z"),), time, rate)


def build_sidecar(rate: float) -> DropSidecar:
    channel = {"column": 1, "name": "S1_z", "sensor": 1, "unit": "mg", "direction": "+z"}
    return DropSidecar.model_validate({"record": {"sampling_rate_hz": rate}, "channel": [channel]})


@pytest.mark.parametrize(
    ("factor", "agrees"),
    [(0.98, False), (0.9989, False), (0.9991, True), (1.0009, True), (1.0011, False), (1.02, False)],
)
@pytest.mark.parametrize("source", ["the file", "the time column"])
def test_sources_agree_to_a_thousandth(source: str, factor: float, agrees: bool) -> None:
    """Every frequency is proportional to the rate: 2 % is five times the scatter of an identified frequency."""
    other = factor * RATE
    table = build_table(rate=other) if source == "the file" else build_table(time=np.arange(N) / other)
    if agrees:
        assert find_sampling_rate(table, build_sidecar(RATE)) == RATE
        assert find_sampling_rate(table, None) == pytest.approx(other, rel=1e-9)
    else:
        expected = f"the sidecar states a sampling rate of 400 Hz, but {source} {other:g} Hz"
        with pytest.raises(InputError, match=expected):
            find_sampling_rate(table, build_sidecar(RATE))


@pytest.mark.parametrize("sample", [1, 2, 600, N - 3])
@pytest.mark.parametrize("missing", [1, 2])
def test_missing_sample_is_found_anywhere(sample: int, missing: int) -> None:
    """One sample of 1200 changes the rate by less than a thousandth: the gap itself shows it."""
    time = np.delete(np.arange(N) / RATE, slice(sample, sample + missing))
    with pytest.raises(InputError, match="the time increases by"):
        find_sampling_rate(build_table(time), None)


@pytest.mark.parametrize("digits", [3, 4, 6])
def test_printed_times_are_even(digits: int) -> None:
    """A step of 2.5 ms, printed to a millisecond, is 2 ms or 3 ms: less than half a step from the mean."""
    time = np.round(np.arange(N) / RATE, digits)
    assert find_sampling_rate(build_table(time), None) == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize(
    ("time", "message"),
    [
        (np.where(np.arange(N) == 700, np.nan, np.arange(N) / RATE), "the time of sample 701 is not finite"),
        (np.where(np.arange(N) >= 700, np.inf, np.arange(N) / RATE), "the time of sample 701 is not finite"),
        (np.zeros(N), "the time column does not increase"),
        (-np.arange(N) / RATE, "the time column does not increase"),
    ],
)
def test_time_increases_and_has_no_missing_value(time: RealArray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        find_sampling_rate(build_table(time), None)


@pytest.mark.parametrize("shift", [-0.49, 0.49, -0.51, 0.51])
def test_sample_is_displaced_by_less_than_half_a_step(shift: float) -> None:
    """A step of 2.5 ms; a sample 1.275 ms late is followed by a short step."""
    time = np.arange(N) / RATE
    time[600] += shift / RATE
    refusal = pytest.raises(InputError, match=r"s after 1\.\d+ s, but by 0\.0025 s on average")
    with nullcontext() if abs(shift) < 0.5 else refusal:
        assert find_sampling_rate(build_table(time), None) == pytest.approx(RATE, rel=1e-12)


@pytest.mark.parametrize("start", [0.0, 10.0, -3.0])
def test_time_may_begin_anywhere(start: float) -> None:
    assert find_sampling_rate(build_table(start + np.arange(N) / RATE), None) == pytest.approx(RATE, rel=1e-9)


@pytest.mark.parametrize(("rate", "possible"), [(0.1, True), (0.099, False), (1e6, True), (1.01e6, False)])
def test_rate_lies_between_a_tenth_and_a_million_hertz(rate: float, possible: bool) -> None:
    with nullcontext() if possible else pytest.raises(InputError, match=r"Give a rate from 0\.1 to 1e\+06 Hz"):
        assert find_sampling_rate(build_table(rate=rate), None) == rate


def test_every_source_is_checked() -> None:
    """The second and the third source of the rate, where the first is right."""
    with pytest.raises(InputError, match="the file states a sampling rate of 0 Hz"):
        find_sampling_rate(build_table(rate=0.0), build_sidecar(RATE))
    time = np.arange(N) / (1.01 * RATE)
    with pytest.raises(InputError, match="the sidecar states a sampling rate of 400 Hz, but the time column 404 Hz"):
        find_sampling_rate(build_table(time, RATE), build_sidecar(RATE))
    with pytest.raises(InputError, match="states no sampling rate"):
        find_sampling_rate(build_table(), None)
    assert find_sampling_rate(build_table(np.arange(N) / RATE, 1.0005 * RATE), None) == 1.0005 * RATE
