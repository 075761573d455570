"""Identification of synthetic records: accuracy against the Cramer-Rao bound, stated uncertainty, refused records."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from helpers.synthetic_drops import SyntheticDrop, drop, span_modes
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import find_linear_decay, prepare_decay
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_csv
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identification_plan import read_poles
from pantocheck.conformance.drops.identify import (
    NO_PLAN,
    _begin_search,
    _find_longest,
    _require_certain,
    identify_modes,
)
from pantocheck.conformance.drops.line_fit import group_into_blocks
from pantocheck.conformance.drops.mode_groups import number_groups
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.projection import whiten
from pantocheck.conformance.drops.release import find_release
from pantocheck.conformance.results.identified_modes import MeasuredLine, Mode

SPANS = (60.0,) * 6


def build_record(synthetic: SyntheticDrop, name: str = "synthetic", lateral: RealArray | None = None) -> DropRecord:
    count = synthetic.samples.shape[1]
    channels = tuple(DropChannel(f"S{i}_z", i, "z", "CW", 20.0 * i) for i in range(1, count + 1))
    signals = synthetic.samples
    if lateral is not None:
        channels += (DropChannel("S1_y", 1, "y", "CW", 20.0),)
        signals = np.column_stack([signals, lateral])
    facts, line = DropDescription(20, "CW", 100, 5.0), MeasuredLine(spans_m=SPANS)
    return DropRecord(name, name, synthetic.rate, signals.copy(), channels, drop=facts, line=line)


def simulate(
    seed: int, modes: int = 6, duration: float = 60.0, rate: float = 50.0, weak: float = 0.0, **options: float
) -> tuple[np.random.Generator, ComplexArray, SyntheticDrop]:
    """Random numbers, poles, and the drop that they make."""
    random = np.random.default_rng(seed)
    true = span_modes(random, modes)
    return random, true, drop(random, true, duration=duration, rate=rate, weak=weak, **options)


def complex_poles(modes: tuple[Mode, ...]) -> ComplexArray:
    frequency, ratio = np.array([(m.frequency_Hz, m.damping_ratio) for m in modes]).T
    return np.asarray(2 * np.pi * frequency * (-ratio + 1j * np.sqrt(1 - ratio**2)))


@pytest.mark.parametrize("seed", [5, 11])
def test_blind_identification_reaches_the_bound(seed: int) -> None:
    """Modes whose bound is below 0.5 %: all within 2 mHz and 5 %, nine in ten within three bounds (expected: 1.64)."""
    random = np.random.default_rng(seed)
    true = span_modes(random, 24, pairs=2)
    synthetic = drop(random, true, duration=100.0, rate=50.0, noise=0.002)
    (identification,) = identify_modes((build_record(synthetic),), highest=4.6)
    true = true[true.imag < 2 * np.pi * 4.5]
    white = whiten(
        [block.data for block in identification.fit.blocks], [block.noise for block in identification.fit.blocks]
    )
    bound = np.sqrt(np.diag(refine_poles(true, white, iterations=0).covariance))[: true.size] / -true.real
    poles = complex_poles(identification.modes)
    rows, columns = linear_sum_assignment(np.minimum(np.abs(true[:, None] - poles[None, :]), 1.0))
    ratios = []
    for i, j in zip(rows, columns, strict=True):
        if bound[i] > 0.005:
            continue
        assert abs(identification.modes[j].frequency_Hz - abs(true[i]) / (2 * np.pi)) < 0.002
        relative = identification.modes[j].damping_ratio / (-true[i].real / abs(true[i])) - 1
        assert abs(relative) < 0.05
        ratios.append(abs(relative) / bound[i])
    assert len(ratios) > 10
    assert np.percentile(ratios, 90) < 3
    assert identification.fit.misfit == pytest.approx(1, abs=0.15)


def test_weak_mode_is_uncertain_or_not_identified() -> None:
    """A mode thirty times below the others in strong noise: it never has a certain damping ratio."""
    *_, synthetic = simulate(8, noise=0.02)
    t = np.arange(synthetic.samples.shape[0]) / synthetic.rate - synthetic.release
    weak = 2 * np.pi * 1.9 * (-0.003 + 1j)
    synthetic.samples[t > 0] += 0.012 * np.exp(weak * t[t > 0]).real[:, None]
    (identification,) = identify_modes((build_record(synthetic),), highest=4.0)
    for mode in identification.modes:
        if abs(mode.frequency_Hz - 1.9) < 0.1:
            assert not mode.certain
            assert any("weakly excited" in text for text in mode.warnings)
            assert abs(mode.damping_ratio - 0.003) < 4 * mode.damping_ratio_std


def test_linear_decay_lies_between_slack_droppers_and_a_disturbance() -> None:
    random, _, synthetic = simulate(21, 12, duration=120.0, noise=0.002, nonlinear=1.5)
    wind = np.arange(synthetic.samples.shape[0]) / synthetic.rate > 80.0
    synthetic.samples[wind] += 0.02 * random.standard_normal((int(wind.sum()), 4))
    (identification,) = identify_modes((build_record(synthetic),), highest=4.0)
    linear = identification.fit.records[0].decay.linear
    assert 60 < linear.end < 81.5  # the windows have four seconds: a little of the wind may enter
    assert linear.start > synthetic.release + 1.3
    assert any("used up to" in text and "the residual reaches" in text for text in identification.warnings)


def test_lateral_channel_identifies_lateral_modes() -> None:
    random, _, synthetic = simulate(30, duration=80.0, noise=0.002)
    t = np.arange(synthetic.samples.shape[0]) / synthetic.rate - synthetic.release
    sideways = np.where(t > 0, 2.0 * np.exp(2 * np.pi * 1.45 * (-0.003 + 1j) * np.maximum(t, 0)).real, 0.0)
    synthetic.samples[:, 0] += 0.008 * sideways
    lateral = sideways + 0.002 * random.standard_normal(t.size)
    (identification,) = identify_modes((build_record(synthetic, lateral=lateral),), highest=4.0)
    (mode,) = [m for m in identification.modes if abs(m.frequency_Hz - 1.45) < 0.02]
    assert mode.lateral
    assert mode.group is None


def test_repeats_of_different_length_are_used_together_with_a_warning() -> None:
    random = np.random.default_rng(40)
    true = span_modes(random, 6)
    repeats = [drop(random, true, duration=length, rate=50.0, noise=0.003, weak=0.0) for length in (60.0, 90.0)]
    (identification,) = identify_modes(
        tuple(build_record(repeat, f"run {k}") for k, repeat in enumerate(repeats)), highest=4.0
    )
    assert len(identification.fit.blocks) == 2
    assert any("differ in length" in text for text in identification.warnings)
    poles = complex_poles(identification.modes)
    for pole in true:
        assert np.abs(poles - pole).min() < 0.05 * -pole.real


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_records_of_different_rates_start_from_the_poles_of_the_longest_decay(order: slice) -> None:
    """The longest decay separates close modes best; it may be any of the records."""
    random = np.random.default_rng(44)
    true = span_modes(random, 6)
    band = FrequencyBand.up_to(4.0, 25.0)
    lengths_and_rates = [(40.0, 30.0), (80.0, 25.0)]
    drops = [drop(random, true, duration=length, rate=rate, weak=0.0) for length, rate in lengths_and_rates[order]]
    decays = [prepare_decay(build_record(synthetic), band) for synthetic in drops]
    samples, _ = group_into_blocks(decays)
    assert len({dt for _, dt in samples}) == 2
    assert _begin_search(samples, band, NO_PLAN, None) is None
    start = _find_longest(decays).poles
    assert np.array_equal(start, max(decays, key=lambda decay: decay.linear.end).linear.poles)
    assert not np.array_equal(start, min(decays, key=lambda decay: decay.linear.end).linear.poles)


@pytest.mark.parametrize("sensors", [2, 4])
def test_records_of_one_name_keep_their_sensors(sensors: int) -> None:
    """The second record shows all modes best: the first has ten times the noise and other sensors."""
    random = np.random.default_rng(41)
    true = span_modes(random, 6)
    noisy = drop(random, true, sensors=sensors, duration=60.0, rate=50.0, noise=0.03, weak=0.0)
    quiet = build_record(drop(random, true, duration=60.0, rate=50.0, noise=0.003, weak=0.0), "same name")
    away = replace(quiet, channels=tuple(replace(c, position=c.position + 200.0) for c in quiet.channels))
    (identification,) = identify_modes((build_record(noisy, "same name"), away), highest=4.0)
    rows = identification.modes
    assert len(rows) >= 6
    for row in rows:
        assert [part.position_m for part in row.sensor_shape] == [220.0, 240.0, 260.0, 280.0]


def test_amplitude_at_release_does_not_depend_on_the_start_of_the_linear_decay() -> None:
    """The quieter repeat, with a gust in its first 8 s, shows the modes best; the noisier one has the largest residues.

    The noisier one alone gives amplitudes to some parts in a thousand of the largest. Residues extrapolated from the
    wrong start would have an error of more than 10 %, the decay during the gust.
    """
    random, _, synthetic = simulate(43, duration=80.0, noise=0.002)
    noisy = build_record(
        replace(synthetic, samples=synthetic.samples + 0.02 * random.standard_normal(synthetic.samples.shape)), "noisy"
    )
    t = np.arange(synthetic.samples.shape[0]) / synthetic.rate
    gust = (t > synthetic.release) & (t < synthetic.release + 8.0)
    synthetic.samples[gust] += 0.5 * random.standard_normal((int(gust.sum()), 4))
    gusty = build_record(synthetic, "gusty")
    (alone,) = identify_modes((noisy,), highest=4.0)
    (both,) = identify_modes((noisy, gusty), highest=4.0)
    assert both.fit.records[1].decay.linear.start > both.fit.records[0].decay.linear.start + 3.0
    expected = {mode.frequency_Hz: mode.amplitude_at_release for mode in alone.modes if mode.certain}
    strong = [mode for mode in both.modes if mode.certain and mode.record == "gusty"]
    assert len(strong) >= 3
    for mode in strong:
        nearest = min(expected, key=lambda f: abs(f - mode.frequency_Hz))
        assert mode.amplitude_at_release == pytest.approx(expected[nearest], abs=0.005 * max(expected.values()))


def test_files_of_one_name_without_line_data_belong_to_two_lines(tmp_path: Path) -> None:
    random = np.random.default_rng(42)
    records = []
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        record = build_record(drop(random, span_modes(random, 6), duration=40.0, rate=50.0, weak=0.0))
        write_drop_csv(replace(record, line=MeasuredLine()), tmp_path / folder / "T1.csv")
        records += read_drop_records(tmp_path / folder / "T1.csv")
    assert [record.source for record in records] == ["T1.csv", "T1.csv"]
    assert len(identify_modes(tuple(records), highest=4.0)) == 2


@pytest.mark.parametrize(("certain", "modes", "refused"), [(1, 15, True), (0, 8, True), (3, 30, False), (1, 2, False)])
def test_record_that_determines_hardly_any_mode_is_refused(certain: int, modes: int, refused: bool) -> None:
    """Fewer than three certain modes, and fewer than half, are no identification of a line."""
    mode = Mode(frequency_Hz=1.0, damping_ratio=0.01, damping_ratio_std=1e-4, sensor_shape=())
    found = tuple(mode.model_copy(update={"certain": number < certain}) for number in range(modes))
    with pytest.raises(InputError, match=rf"determines {certain} of its {modes} modes") if refused else nullcontext():
        _require_certain("record", found)


def test_hand_placed_poles_are_refined_and_none_is_removed() -> None:
    _, true, synthetic = simulate(50, noise=0.002)
    (identification,) = identify_modes((build_record(synthetic),), highest=4.0, poles=true * (1 + 0.0005j))
    assert complex_poles(identification.modes) == pytest.approx(true, rel=1e-4)


@pytest.mark.parametrize(("duration", "message"), [(8.0, "s after the release"), (4.0, "the release is planned")])
def test_short_records_are_refused(duration: float, message: str) -> None:
    *_, synthetic = simulate(60, duration=duration, weak=0.15)
    with pytest.raises(InputError, match=message):
        identify_modes((build_record(synthetic),))


def test_records_that_cannot_be_identified_are_refused(tmp_path: Path) -> None:
    """At 1 Hz the filters pass nothing above 0.32 Hz, and the band begins at 0.3 Hz."""
    synthetic = build_record(drop(np.random.default_rng(64), span_modes(np.random.default_rng(64), 6), rate=50.0))
    for rate in (0.5, 1.0):
        with pytest.raises(InputError, match=r"sampling rate of .* is too low"):
            identify_modes((replace(synthetic, rate=rate),))
    signals = np.random.default_rng(68).standard_normal((60, 1))
    short = DropRecord("short", "short", 200.0, signals, (DropChannel("S1_z", 1, "z"),))
    with pytest.raises(InputError, match="neither a planned release nor a rest at its start"):
        identify_modes((short,))
    (tmp_path / "modes.json").write_text("[]")
    with pytest.raises(InputError, match="holds no mode"):
        read_poles(tmp_path / "modes.json")
    (tmp_path / "poles.toml").write_text("[[pole]]\nfrequency_Hz = 1.0\ndamping_ratio = 1.0\n", encoding="utf-8")
    with pytest.raises(InputError, match="must be less than"):
        read_poles(tmp_path / "poles.toml")
    *_, synthetic = simulate(67, duration=40.0, weak=0.15)
    synthetic.samples[int(synthetic.release * synthetic.rate) + 10 :, 2] = 0.0
    with pytest.raises(InputError, match=r"channel 'S3_z'.*is constant after the release"):
        identify_modes((build_record(synthetic),))
    *_, synthetic = simulate(61, duration=40.0, sensors=1, weak=0.15)
    sideways = DropRecord(
        "x", "x", 50.0, synthetic.samples, (DropChannel("S1_y", 1, "y"),), drop=DropDescription(trigger_nominal=5.0)
    )
    with pytest.raises(InputError, match="no vertical channel"):
        identify_modes((sideways,))


def test_low_highest_frequency_does_not_blame_the_sampling_rate() -> None:
    random = np.random.default_rng(65)
    synthetic = drop(random, 2 * np.pi * np.array([0.4 * (-0.004 + 1j), 0.8 * (-0.004 + 1j)]), rate=50.0, weak=0.0)
    (identification,) = identify_modes((build_record(synthetic),), highest=0.5)
    assert [mode.frequency_Hz for mode in identification.modes] == pytest.approx([0.4], abs=0.002)


def test_repeats_at_a_low_rate_are_compared() -> None:
    """At 12 Hz the usual low-pass at 6 Hz would be at half the sampling rate."""
    *_, synthetic = simulate(66, rate=12.0)
    (identification,) = identify_modes(
        (build_record(synthetic, "first"), build_record(synthetic, "second")), highest=2.0
    )
    (repeats,) = analyse_identification(identification).repeatability
    assert repeats.verdict == "repeatable"


def test_linear_decay_begins_after_the_last_clipped_sample() -> None:
    """A clean decay with a false clipping time: without it the linear decay begins at 1-2 s."""
    random = np.random.default_rng(62)
    synthetic = build_record(drop(random, span_modes(random, 6), duration=60.0, rate=50.0, weak=0.0))
    band = FrequencyBand.up_to(4.0, synthetic.rate)
    release = find_release(synthetic.signals, synthetic.rate, 5.0, "clean")
    last = release.time + 4.0
    free = find_linear_decay(synthetic, (0, 1, 2, 3), release, band, 0.0)
    late = find_linear_decay(synthetic, (0, 1, 2, 3), release, band, last)
    assert free.start < release.time + 2.1
    assert late.start >= last


def test_single_sensor_and_clipped_start_are_marked() -> None:
    *_, synthetic = simulate(63, sensors=1)
    (identification,) = identify_modes((build_record(synthetic),), highest=4.0)
    assert any("a single channel does not show" in text for text in identification.warnings)
    assert all(mode.phase_collinearity is None for mode in identification.modes)
    *_, synthetic = simulate(62)
    top = 0.6 * np.abs(synthetic.samples).max()
    synthetic.samples[:] = np.clip(synthetic.samples, -top, top)
    (identification,) = identify_modes((build_record(synthetic),), highest=4.0)
    clipped = np.flatnonzero((np.abs(synthetic.samples) >= top).any(axis=1))
    assert identification.fit.records[0].decay.linear.start * synthetic.rate > clipped[0]
    assert identification.fit.misfit < 1.3


def test_groups_hold_one_mode_per_span_where_they_touch() -> None:
    """Groups of a six-span line; from the fifth on their distance is smaller than that of the modes in a group."""
    first = np.array([0.836, 0.857, 0.897, 0.923, 0.966, 1.031])
    frequencies = np.concatenate(
        [k * np.mean(first) * (1 + (first / np.mean(first) - 1) * 1.1 / k**0.3) for k in range(1, 7)]
    )
    expected = np.repeat(np.arange(1, 7), 6)
    order = np.argsort(frequencies)
    numbers = number_groups(frequencies[order], frequencies[order], 6)
    assert np.mean(numbers == expected[order]) > 0.95
