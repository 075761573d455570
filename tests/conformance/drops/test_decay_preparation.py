"""Preparation of records: lateral channels, clipping, filters, and the linear part of a decay."""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from helpers.synthetic_drops import SyntheticDrop, drop
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import prepare_again, prepare_decay
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.release import find_release

RATE = 50.0
BAND = FrequencyBand.up_to(4.0, RATE)
POLES = 2 * np.pi * np.array([0.9, 1.7, 2.6]) * (-0.004 + 1j)


def simulate_drop(seed: int, duration: float = 45.0, nonlinear: float = 0.0) -> SyntheticDrop:
    """Three modes at two sensors."""
    random = np.random.default_rng(seed)
    return drop(random, POLES, 2, duration, RATE, noise=0.002, nonlinear=nonlinear, weak=0.0)


def build_record(synthetic: SyntheticDrop, lateral: RealArray | None = None) -> DropRecord:
    channels, signals = [DropChannel("S1_z", 1, "z"), DropChannel("S2_z", 2, "z")], synthetic.samples
    if lateral is not None:
        channels.append(DropChannel("S1_y", 1, "y"))
        signals = np.column_stack([signals, lateral])
    return DropRecord(
        "record", "record", synthetic.rate, signals.copy(), tuple(channels), drop=DropDescription(trigger_nominal=5.0)
    )


def test_lateral_channel_has_the_samples_of_the_vertical_ones() -> None:
    """A lateral channel with the signal of the first vertical one is prepared to the same samples, to rounding."""
    synthetic = simulate_drop(1)
    prepared = prepare_decay(build_record(synthetic, synthetic.samples[:, 0]), BAND)
    assert prepared.lateral.shape == (prepared.linear.samples.shape[0], 1)
    assert prepared.lateral[:, 0] == pytest.approx(prepared.linear.samples[:, 0], abs=1e-10)
    assert prepare_decay(build_record(synthetic), BAND).lateral.shape == (prepared.linear.samples.shape[0], 0)


def test_corrected_record_keeps_its_part_unless_that_ended_early() -> None:
    """The part is that of the search to its end, also if the corrected record would be refused; else it is searched."""
    record = build_record(simulate_drop(1))
    decay = prepare_decay(record, BAND)
    again = prepare_again(decay, record, BAND)
    assert (again.linear.start, again.linear.first) == (decay.linear.start, decay.linear.first)
    assert again.linear.samples == pytest.approx(decay.linear.samples, abs=1e-12)
    noise = replace(record, signals=np.random.default_rng(2).standard_normal(record.signals.shape))
    assert prepare_again(decay, noise, BAND).linear.start == decay.linear.start
    early = replace(decay, linear=replace(decay.linear, start=decay.linear.start + 3.0, end=30.0))
    assert prepare_again(early, record, BAND).linear.start == decay.linear.start


def test_linear_decay_has_the_times_of_the_record_and_no_aliases() -> None:
    """The filter delays by half its length: a sample of the decay is the smooth signal at its time."""
    synthetic = simulate_drop(2)
    linear = prepare_decay(build_record(synthetic), BAND).linear
    half = (linear.taps.size - 1) / 2 / RATE
    assert linear.first == pytest.approx(linear.start + half)
    n = linear.samples.shape[0]
    assert linear.duration == pytest.approx(n * linear.dt)
    assert linear.end == pytest.approx(linear.start + n * linear.dt + 2 * half)
    smooth = scipy.signal.filtfilt(*scipy.signal.butter(4, 5.5, fs=RATE), synthetic.samples, axis=0)
    t = np.arange(synthetic.samples.shape[0]) / RATE
    expected = np.column_stack([np.interp(linear.first + np.arange(n) * linear.dt, t, column) for column in smooth.T])
    assert np.std(linear.samples - expected) < 0.02 * np.std(expected)
    # The stop band of the low-pass, from 8 Hz on, is 80 dB down (the estimate of the length allows 2 dB).
    linear = prepare_decay(build_record(simulate_drop(3)), BAND).linear
    frequency, response = scipy.signal.freqz(linear.taps, fs=RATE, worN=4096)
    assert 10 ** (-86 / 20) < np.abs(response[frequency >= BAND.stop]).max() < 10 ** (-78 / 20)
    assert np.abs(np.abs(response[frequency <= BAND.fitted]) - 1).max() < 10 ** (-78 / 20)
    assert 1 / linear.dt > 2 * BAND.stop


def clip_channel(synthetic: SyntheticDrop, *times: float) -> SyntheticDrop:
    """Flat tops of five samples in the first channel at some times after the release [s]."""
    samples = synthetic.samples.copy()
    top = 1.5 * np.abs(samples[:, 0]).max()
    for time in times:
        begin = round((synthetic.release + time) * RATE)
        samples[begin : begin + 5, 0] = top
    return replace(synthetic, samples=samples)


@pytest.mark.parametrize(("times", "kept"), [((0.5, 5.0), 2), ((0.5, 7.0), 1), ((7.0, 0.5), 1)])
def test_channel_clipped_after_15_percent_of_the_decay_is_left_out(times: tuple[float, ...], kept: int) -> None:
    """The decay lasts 40 s: 15 % are 6 s. The last clipped sample counts, also if there are earlier ones."""
    synthetic = clip_channel(simulate_drop(4), *times)
    prepared = prepare_decay(build_record(synthetic), BAND)
    assert len(prepared.columns) == kept
    left_out = any(
        "channel 'S1_z' is left out, because it is clipped in a large part" in text for text in prepared.warnings
    )
    assert left_out == (kept == 1)
    if kept == 2:
        assert prepared.linear.start >= synthetic.release + max(times)


def disturb(synthetic: SyntheticDrop, size: float, *intervals: tuple[float, float]) -> None:
    """Add noise to all channels in intervals after the release [s]."""
    random = np.random.default_rng(9)
    t = np.arange(synthetic.samples.shape[0]) / RATE - synthetic.release
    inside = np.any([(t > begin) & (t < end) for begin, end in intervals], axis=0)
    synthetic.samples[inside] += size * random.standard_normal((int(inside.sum()), 2))


def test_short_free_decays_are_refused() -> None:
    """Slack droppers for 4 s, wind from 12 s after the release on: less than the ten seconds of a linear decay."""
    synthetic = simulate_drop(5, duration=24.0)
    disturb(synthetic, 0.3, (0.0, 4.0), (12.0, 30.0))
    with pytest.raises(InputError, match=r"is a free decay for only [7-9]\.\d s"):
        prepare_decay(build_record(synthetic), BAND)
    assert find_release(build_signals({19.0: 1.0}), RATE, 18.89, "record").time == pytest.approx(19.0)
    with pytest.raises(InputError, match=r"ends 0\.70 s after the release"):
        find_release(build_signals({19.3: 1.0}), RATE, 19.25, "record")
    with pytest.raises(InputError, match=r"ends after 20\.00 s, but the release is planned at 19\.70 s"):
        find_release(build_signals({19.3: 1.0}), RATE, 19.70, "record")


@pytest.mark.parametrize(("seconds", "refused"), [(11.5, True), (13.0, False)])
def test_twelve_seconds_after_the_release_are_needed(seconds: float, refused: bool) -> None:
    synthetic = simulate_drop(6)
    record = build_record(synthetic)
    short = replace(record, signals=record.signals[: round((synthetic.release + seconds) * RATE)])
    with pytest.raises(InputError, match=r"ends 11\.5 s after the release") if refused else nullcontext():
        assert prepare_decay(short, BAND).linear.duration > 8.0


# Release of the mass: the first movement that exceeds the noise at rest.


def build_signals(moves: dict[float, float], noise: float = 0.01, duration: float = 20.0) -> RealArray:
    """Two channels that alternate by the noise, with another offset each; the second one moves by steps."""
    t = np.arange(int(duration * RATE)) / RATE
    signals = np.outer(noise * (-1.0) ** np.arange(t.size), [1.0, 1.0]) + np.array([3.0, -1.0])
    for time, step in moves.items():
        signals[t >= time - 1e-9, 1] += step
    return signals


def test_release_is_the_first_movement_that_lasts() -> None:
    """The median of the magnitude is 0.01: normal noise has 1.4826 times that as std, so the threshold is 0.1186."""
    release = find_release(build_signals({6.0: 0.10, 7.5: 0.03}), RATE, 5.0, "record")
    assert release.time == pytest.approx(7.5)
    assert release.rest_end == pytest.approx(4.4)  # 0.6 s before the planned release
    assert release.warnings == ("record: the first motion is 2.5 s after the planned release",)
    release = find_release(build_signals({4.44: 1.0}), RATE, 5.0, "record")
    assert (release.time, release.rest_end, release.warnings) == (pytest.approx(4.44), pytest.approx(4.34), ())
    assert find_release(build_signals({7.0: -1.0}), RATE, 5.0, "record").time == pytest.approx(7.0)
    signals = build_signals({6.0: 1.0, 6.04: -1.0, 9.0: 1.0})
    assert find_release(signals, RATE, 5.0, "record").time == pytest.approx(9.0)
    signals = build_signals({5.2: 1e-3}, noise=0.0)
    assert find_release(signals, RATE, 5.0, "record").time == pytest.approx(5.2)


def test_release_without_a_rest_needs_its_planned_time() -> None:
    release = find_release(build_signals({0.0: 1.0}), RATE, 1.5, "record")
    assert (release.time, release.rest_end) == (1.5, 0.0)
    assert "no rest before the release; the planned time of release is used" in release.warnings[0]
    with pytest.raises(InputError, match="no channel moves"):
        find_release(build_signals({}), RATE, 1.81, "record")
    with pytest.raises(InputError, match="has neither a planned release nor a rest"):
        find_release(build_signals({0.7: 1.0, 0.9: -1.0}), RATE, None, "record")


@pytest.mark.parametrize("time", [2.9, 6.3])
def test_release_without_a_trigger_time_follows_a_quiet_start(time: float) -> None:
    """Three channels of different noise, of which one moves: the window of half a second before the jump is rest."""
    random = np.random.default_rng(1)
    t = np.arange(int(20 * RATE)) / RATE - time
    signals = random.standard_normal((t.size, 3)) * [0.01, 0.002, 0.05]
    signals[:, 1] += np.where(t > -1e-9, np.cos(5 * t), 0.0)
    release = find_release(signals, RATE, None, "record")
    assert release.time == pytest.approx(time, abs=0.5 / RATE)
    assert time - 1.0 < release.rest_end < time
