"""Preparation of measured records: cuts, resampling and filter detection, against signals in closed form."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.record_keys import record_keys
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import Value, evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.records.force_checks import find_outliers
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_preparation import PreparedRecord, prepare_record
from pantocheck.conformance.records.record_reading import read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.records.samples import RecordSamples, build_record

SPEED, SPAN, MEAN, SIGMA = 250 / 3.6, 60.0, 120.0, 24.0


def force_at(position: RealArray) -> RealArray:
    """One sine per span: sigma is known over whole spans. A little at 12 Hz and 35 Hz, as a real force has."""
    time = position / SPEED
    rest = 6.0 * np.sin(2 * np.pi * 12 * time) + 3.0 * np.sin(2 * np.pi * 35 * time)
    return MEAN + np.sqrt(2) * SIGMA * np.sin(2 * np.pi * position / SPAN) + rest


def sidecar(**keys: Any) -> RecordSidecar:
    return RecordSidecar.model_validate(record_keys(**{"speed_km_h": 250.0, "pantographs": 1} | keys))


def ready(samples: RecordSamples, tolerance: float = 5.0, **keys: Any) -> PreparedRecord:
    return prepare_record(samples, sidecar(**keys), Filter(), tolerance)


def by_time(seconds: float = 30.0, rate: float = 500.0) -> RecordSamples:
    time = np.arange(int(seconds * rate)) / rate
    return RecordSamples(force=force_at(SPEED * time)[None], time=time, position=SPEED * time[None])


def values(found: PreparedRecord) -> dict[str, Value]:
    return evaluate_signals(found.pantographs, LineSignals(found.section)).values[1]


def test_simulated_record_is_unchanged_and_pantographs_share_their_track() -> None:
    """Even samples, a run-in and a run-out: the quantities are those of the record itself, to the last bit."""
    samples = by_time()
    keys = {"evaluated_m": [300.0, 1500.0]}
    expected = evaluate_record(build_record(samples, sidecar(**keys)), Filter()).values[1]
    assert values(ready(samples, **keys)) == expected
    # After 100 m the second pantograph has just reached the start of the first: the section has no length.
    time = np.arange(129) / 64
    force = np.full((2, 129), 120.0)
    with pytest.raises(RecordInvalid, match="no part of the track is common to all"):
        ready(RecordSamples(force=force, time=time), speed_km_h=180.0, pantographs=2, spacing_m=[100.0])


def test_record_in_other_units_is_prepared_in_si(converted_record: Path, two_pantograph_record: Record) -> None:
    """The first pantograph crosses 150 m to 270 m, so that it covers the analysis section."""
    samples, described, _ = read_samples(converted_record)
    prepared = prepare_record(samples, described.model_copy(update={"evaluated_m": (160.0, 240.0)}), Filter(), 5.0)
    assert prepared.pantographs[1].section == (160.0, 240.0)
    assert_allclose(prepared.pantographs[1].force.delivered, two_pantograph_record.force[0], rtol=1e-12)


@pytest.mark.parametrize(("run_in", "warned"), [(6.8, True), (7.1, False)])
def test_filter_transients_inside_the_section_are_reported(run_in: float, warned: bool) -> None:
    """Two periods of the cut-off at 250 km/h are 0.1 s or 6.94 m."""
    for section in ([run_in, 2000.0], [10.0, SPEED * 29.998 - run_in]):
        warnings = ready(by_time(), evaluated_m=section).warnings
        assert any("begins or ends less than 6.9 m outside" in text for text in warnings) == warned


@pytest.mark.parametrize("step", [0.1, 0.25])
def test_sampling_by_distance_gives_the_statistics_of_time(step: float) -> None:
    position = np.arange(0, 2000, step)
    found = ready(RecordSamples(force=force_at(position)[None], position=position[None]), evaluated_m=[60.0, 1860.0])
    assert found.rate == pytest.approx(SPEED / step, rel=1e-5)
    reference = values(ready(by_time(), evaluated_m=[60.0, 1860.0]))
    got = values(found)
    # Interpolation by cubics takes at most (pi f / rate)^4 of an amplitude: 0.02 % at 20 Hz and 278 samples per second.
    for name in ("mean_force_N", "std_force_N", "rms_0_5_N", "rms_5_20_N"):
        assert_allclose(got[name], reference[name], rtol=2e-3)
    assert any("sampled by distance" in note for note in found.notes)


def test_time_follows_from_a_steady_speed_channel() -> None:
    """At a speed that rises by 4 %, 12 Hz stays 12 Hz only if time is integrated with that speed."""
    position = np.arange(0, 3000, 0.1)
    speed = SPEED * (1 + 0.04 * position / 3000)
    time = 3000 / (0.04 * SPEED) * np.log1p(0.04 * position / 3000)
    force = MEAN + 10 * np.sin(2 * np.pi * 12 * time)
    part = ready(RecordSamples(force=force[None], position=position[None], speed=speed)).pantographs[1]
    spectrum = np.abs(np.fft.rfft(part.delivered - part.delivered.mean()))
    assert np.fft.rfftfreq(part.delivered.size, 1 / part.force.rate)[spectrum.argmax()] == pytest.approx(12, abs=0.03)
    # One of them shows a train that is 10 % slower from 1042 m on.
    samples = by_time()
    slow = np.where(samples.time < 15, SPEED, 0.9 * SPEED)
    position = np.concatenate([[0.0], np.cumsum(slow)[:-1] * 0.002])
    steady = np.full(samples.time.size, SPEED)
    for changed in ({"speed": slow}, {"speed": steady, "position": position[None]}):
        assert skip_reason(ready(replace(samples, **changed), evaluated_m=[10.0, 1500.0])) is not None
    # The channel shows 1 % more than the nominal speed; the last second, at half of it, is cut: 3.3 % of 30 s.
    samples = by_time()
    speed = np.where(samples.time < 29, 1.01 * SPEED, 0.5 * SPEED)
    found = ready(replace(samples, speed=speed), evaluated_m=[100.0, 964.0])
    assert found.speed == pytest.approx(1.01 * SPEED, rel=1e-9)
    assert found.warnings == (
        f"3.3 % of the record was cut, first at {SPEED * 29:.1f} m: the speed differs by more than 5 % from 250 km/h",
    )


def skip_reason(found: PreparedRecord, pantograph: int = 1) -> str | None:
    """Reason why the standard deviation of a pantograph is not available; None if it is."""
    return evaluate_signals(found.pantographs, LineSignals(found.section)).skipped[pantograph].get("std_force_N")


def test_section_with_a_gap_has_no_values() -> None:
    """A second is missing at 694 m: the longer section holds the gap, the shorter one ends before it."""
    samples = by_time()
    holed = samples.select((samples.time < 10) | (samples.time > 11))
    found = ready(holed, evaluated_m=[10.0, 2000.0])
    assert "the analysis section extends from 10 m to 2000 m" in (skip_reason(found) or "")
    assert found.seconds == 0
    assert any("2 usable parts between gaps; that from 764.0 m to 2083.2 m" in text for text in found.warnings)
    before = ready(holed, evaluated_m=[60.0, 660.0])
    assert values(before)["mean_force_N"] == values(ready(samples, evaluated_m=[60.0, 660.0]))["mean_force_N"]


def test_gap_of_a_hundredth_of_a_second_is_bridged_and_a_longer_one_is_not() -> None:
    samples = by_time()
    force = samples.force.copy()
    force[0, 5000:5003] = np.nan  # 6 ms
    bridged = ready(RecordSamples(force=force, time=samples.time, position=samples.position), evaluated_m=[10, 2000])
    assert skip_reason(bridged) is None
    assert any("of pantograph 1 is missing, first at 694.4 m" in text for text in bridged.warnings)
    force[0, 5000:5010] = np.nan  # 20 ms
    cut = ready(RecordSamples(force=force, time=samples.time, position=samples.position), evaluated_m=[10, 2000])
    assert skip_reason(cut) is not None


@pytest.mark.parametrize(("missing", "covered"), [(1, True), (4, True), (6, False), (12, False), (24, False)])
@pytest.mark.parametrize("lost", [False, True])
def test_gap_of_the_rear_pantograph_is_bridged_up_to_ten_milliseconds(missing: int, covered: bool, lost: bool) -> None:
    """At 500 Hz a gap of k samples lasts 2 k ms; 12 ms or more could hide a peak below 20 Hz."""
    # Where the force of the rear alone is missing, the front has no gap. Where the samples are lost, both have one.
    samples = by_time(20.0)
    force = np.vstack([samples.force, force_at(samples.position - 200.0)])
    gap = slice(5000, 5000 + missing)
    if lost:
        kept = np.delete(np.arange(samples.time.size), gap)
        two = RecordSamples(force[:, kept], samples.time[kept], position=samples.position[:, kept])
    else:
        force[1, gap] = np.nan
        two = RecordSamples(force, samples.time, position=samples.position)
    found = ready(two, pantographs=2, spacing_m=[200.0], evaluated_m=[10.0, 1100.0])
    reasons = [skip_reason(found, number) for number in (1, 2)]
    assert [reason is None for reason in reasons] == [covered or not lost, covered]
    assert any("the record of pantograph 2 has 2 usable parts" in text for text in found.warnings) is not covered


def test_section_with_a_change_of_speed_has_no_values() -> None:
    """The second half of the record, from 2083 m, runs 10 % too slow."""
    time = np.arange(0, 60, 0.002)
    position = np.where(time < 30, SPEED * time, SPEED * 30 + 0.9 * SPEED * (time - 30))
    samples = RecordSamples(force=force_at(position)[None], time=time, position=position[None])
    found = ready(samples, evaluated_m=[10.0, 3000.0])
    assert skip_reason(found) is not None
    assert any("50 % of the record was cut" in text and "from 250 km/h" in text for text in found.warnings)
    assert skip_reason(ready(samples, evaluated_m=[10.0, 2000.0])) is None
    with pytest.raises(RecordInvalid, match="at the nominal speed"):
        ready(samples, speed_km_h=300.0)


@pytest.mark.parametrize("stated", [True, False])
def test_measuring_chain_filtered_at_20_Hz_has_no_values_above(stated: bool) -> None:
    samples = by_time()
    filtered = RecordSamples(Filter(order=8)(samples.force[0], 500.0)[None], samples.time, position=samples.position)
    found = ready(filtered, filter_applied_Hz=20.0) if stated else ready(filtered)
    got = evaluate_signals(found.pantographs, LineSignals(found.section))
    for name in ("rms_20_50_N", "std_force_50_N", "cov_50", "contact_loss_pct"):
        assert name not in got.values[1]
        assert "filtered at 20 Hz" in got.skipped[1][name]
    assert got.values[1]["std_force_N"] > SIGMA
    assert any("by the measuring chain" in text for text in found.warnings) == (not stated)


def test_outliers_are_reported_and_graded_and_noise_has_none() -> None:
    samples = by_time()
    force = samples.force.copy()
    force[0, 6000] = 900.0
    found = ready(RecordSamples(force=force, time=samples.time, position=samples.position))
    assert any("1 outlier, which are graded: 900 N at 833.3 m" in text for text in found.warnings)
    assert values(found)["max_force_N"] > values(ready(samples))["max_force_N"] + 10
    assert find_outliers(samples.force[0]).size == 0
    assert list(find_outliers(force[0])) == [6000]
    assert find_outliers(np.random.default_rng(1).normal(120, 25, 1_000_000)).size == 0


@pytest.mark.parametrize("row", [0, 1])
def test_outlier_is_reported_for_its_pantograph(row: int) -> None:
    """One sample of 900 N at 12 s: 833.3 m for the front, 633.3 m for the rear 200 m behind it."""
    samples = by_time(20.0)
    force = np.vstack([samples.force, force_at(samples.position - 200.0)])
    force[row, 6000] = 900.0
    two = RecordSamples(force, samples.time, position=samples.position)
    found = ready(two, pantographs=2, spacing_m=[200.0])
    outliers = [text for text in found.warnings if "outlier" in text]
    place = ("833.3 m", "633.3 m")[row]
    start = f"the force of pantograph {row + 1} has 1 outlier, which are graded: 900 N at {place}"
    assert [text.startswith(start) for text in outliers] == [True]


NOT_GREATER = "the value of sample 2 is not greater than that of sample 1"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: RecordSamples(s.force, s.time[::-1], position=s.position), f"time: {NOT_GREATER}"),
        (lambda s: RecordSamples(s.force, s.time, position=s.position[:, ::-1]), f"position: {NOT_GREATER}"),
        (lambda s: RecordSamples(s.force, np.full(s.time.size, np.nan)), "fewer than two samples"),
        (
            lambda s: RecordSamples(s.force, speed=np.zeros(s.time.size), position=s.position),
            "fewer than two samples have a positive speed",
        ),
        (
            lambda s: RecordSamples(s.force, np.r_[s.time[:-1], 1e8], position=s.position),
            r"1e\+08 s at 500 Hz give more than",
        ),
    ],
)
def test_impossible_axes_are_rejected(change: Callable[[RecordSamples], RecordSamples], message: str) -> None:
    with pytest.raises(RecordInvalid, match=message):
        ready(change(by_time()))


def test_odometer_that_moves_in_steps_is_smoothed() -> None:
    """A counter of 0.5 m steps, sampled every 0.14 m: the position grows evenly in between, the statistics stay."""
    samples = by_time()
    stepped = np.floor(samples.position * 2) / 2
    section = {"evaluated_m": [10.0, 2000.0]}
    found = ready(RecordSamples(samples.force, samples.time, position=stepped), **section)
    assert np.all(np.diff(found.pantographs[1].position) > 0)
    assert_allclose(values(found)["std_force_N"], values(ready(samples, **section))["std_force_N"], rtol=1e-3)


@pytest.mark.parametrize(
    ("section", "covered"), [((0.0, 2083.2), True), ((0.0, 2083.5), False), ((-0.3, 2000.0), False), ((0, 4000), False)]
)
def test_whole_section_must_be_covered(section: tuple[float, float], covered: bool) -> None:
    """The record ends at 2083.2 m, a sample is 0.14 m. 99.9 % of a section are as little as half of it."""
    assert (skip_reason(ready(by_time(), evaluated_m=section)) is None) == covered


def test_support_with_missing_uplift_is_not_evaluated() -> None:
    samples = by_time()
    uplift = np.zeros((2, samples.time.size))
    uplift[0, 150] = 0.05
    uplift[1, 150] = np.nan  # may have been the largest
    lines = RecordSamples(samples.force, samples.time, None, samples.position, None, uplift, np.array([300.0, 360.0]))
    found = ready(lines, support_position_m=[300.0, 360.0]).line
    assert (found.uplift.shape[0], found.uplift.max()) == (1, 0.05)
    assert any("of the uplift is missing" in text for text in ready(lines, support_position_m=[300.0, 360.0]).warnings)


@pytest.mark.parametrize(("section", "part"), [((900.0, 1800.0), "1041.7 m"), ((300.0, 1100.0), "0.0 m")])
def test_part_with_the_longest_share_of_the_section_is_evaluated(section: tuple[float, float], part: str) -> None:
    """The gap lies at 14.5 s to 15 s, or 1007 m to 1042 m: the section lies mostly behind it, or before it."""
    samples = by_time()
    found = ready(samples.select((samples.time < 14.5) | (samples.time >= 15)), evaluated_m=list(section))
    (text,) = (text for text in found.warnings if "usable parts" in text)
    assert text.startswith(f"the record of pantograph 1 has 2 usable parts between gaps; that from {part} to ")


@pytest.mark.parametrize(("count", "shown"), [(2, 2), (5, 5), (7, 5)])
def test_first_five_outliers_are_listed(count: int, shown: int) -> None:
    """Outliers of 900 N every second from 10 s on: 694.4 m and every further 69.4 m."""
    samples = by_time()
    force = samples.force.copy()
    force[0, 5000 : 5000 + 500 * count : 500] = 900.0
    found = ready(RecordSamples(force=force, time=samples.time, position=samples.position))
    places = ", ".join(f"900 N at {SPEED * (10 + i):.1f} m" for i in range(shown))
    (text,) = (text for text in found.warnings if "outlier" in text)
    assert f"has {count} outliers, which are graded: {places}{', ...' if count > shown else ''}; write nan" in text


def test_notes_state_the_evaluated_length_of_a_covered_section() -> None:
    """864 m at 69.44 m/s are 12.44 s; the nominal speed times the duration is the length."""
    found = ready(by_time(), evaluated_m=[100.0, 964.0])
    assert found.seconds == pytest.approx(864 / SPEED, abs=0.002)  # one sample
    assert found.notes == ("Evaluated: 12.44 s, about 0.864 km of line.",)
    assert found.warnings == ()
    assert (found.rate, found.section) == (500.0, (100.0, 964.0))
    assert found.speed == pytest.approx(SPEED, rel=1e-9)
    found = ready(by_time(), evaluated_m=[100.0, 9000.0])
    assert (found.seconds, found.notes) == (0.0, ())
    # The whole record is evaluated; the missing statement is reported instead.
    assert not any("outside the analysis section" in text for text in ready(by_time()).warnings)


@pytest.mark.parametrize(("share", "noted"), [(0.015, False), (0.025, True)])
def test_record_with_steps_that_differ_by_two_percent_is_called_uneven(share: float, noted: bool) -> None:
    samples = by_time()
    time = samples.time.copy()
    time[2::4] += share / 500  # the steps before and after these samples; the median step stays
    found = ready(RecordSamples(samples.force, time, position=SPEED * time[None]))
    assert any("was not evenly sampled; it was resampled to 500" in note for note in found.notes) == noted


@pytest.mark.parametrize(("factor", "steady"), [(0.949, False), (0.951, True), (1.049, True), (1.051, False)])
def test_speed_differs_by_at_most_the_tolerance_of_the_profile(factor: float, steady: bool) -> None:
    """Five percent of 250 km/h; the position states the speed."""
    samples = by_time()
    moved = RecordSamples(samples.force, samples.time, position=factor * SPEED * samples.time[None])
    refusal = pytest.raises(RecordInvalid, match="force: pantograph 1 has no section of 1 s without gaps")
    with nullcontext() if steady else refusal:
        assert ready(moved).speed == pytest.approx(factor * SPEED, rel=1e-9)


def test_missing_force_and_uplift_are_reported_with_their_shares() -> None:
    """Three of 15 000 forces, and 1500 of 30 000 uplifts."""
    samples = by_time()
    force = samples.force.copy()
    force[0, 5000:5003] = np.nan
    uplift = np.full((2, samples.force.shape[1]), 0.03)
    uplift[1, :1500] = np.nan
    lines = RecordSamples(force, samples.time, None, samples.position, None, uplift, np.array([300.0, 360.0]))
    found = ready(lines, support_position_m=[300.0, 360.0], evaluated_m=[100.0, 964.0])
    assert found.warnings == (
        "0.02 % of the force of pantograph 1 is missing, first at 694.4 m",
        "5 % of the uplift is missing; supports with missing values that count are not evaluated",
    )
    assert list(found.line.support_position) == [300.0]


def test_rear_pantograph_has_its_own_place_and_height() -> None:
    samples = by_time(20.0)
    force = np.vstack([samples.force, force_at(samples.position - 200.0)])
    height = np.vstack([np.full(samples.time.size, 5.3), np.full(samples.time.size, 5.1)])
    two = RecordSamples(force, samples.time, None, samples.position, height)
    found = ready(two, pantographs=2, spacing_m=[200.0], evaluated_m=[10.0, 1100.0])
    assert [set(found.pantographs[number].height) for number in (1, 2)] == [{5.3}, {5.1}]
    samples = by_time()
    force = np.vstack([samples.force, force_at(samples.position - 200.0)])
    two = RecordSamples(force, samples.time, None, samples.position)
    found = ready(two, pantographs=2, spacing_m=[200.0])
    assert found.pantographs[2].position[0] == pytest.approx(-200.0)
    assert found.section == pytest.approx((0.0, SPEED * 29.998 - 200), abs=0.1)
