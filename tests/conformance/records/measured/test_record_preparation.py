"""Preparation of measured records: cuts, resampling and filter detection, against signals in closed form."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import Value, evaluate_signals
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.signals import LineSignals
from pantocheck.conformance.records.measured.force_checks import find_outliers
from pantocheck.conformance.records.measured.record_preparation import PreparedRecord, prepare_record
from pantocheck.conformance.records.record import Record, RecordInvalid
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
    base = {"schema": "pantocheck.record/1", "file": "a.csv", "speed_km_h": 250.0, "pantographs": 1}
    return RecordSidecar.model_validate({**base, "filter_applied_Hz": "none", **keys})


def ready(samples: RecordSamples, tolerance: float = 5.0, **keys: Any) -> PreparedRecord:
    return prepare_record(samples, sidecar(**keys), LowPass(), tolerance)


def by_time(seconds: float = 30.0, rate: float = 500.0) -> RecordSamples:
    time = np.arange(int(seconds * rate)) / rate
    return RecordSamples(force=force_at(SPEED * time)[None], time=time, position=SPEED * time[None])


def values(found: PreparedRecord) -> dict[str, Value]:
    return evaluate_signals(found.pantographs, LineSignals(found.section)).values[1]


def test_simulated_record_is_unchanged() -> None:
    """Even samples, a run-in and a run-out: the quantities are those of the record itself, to the last bit."""
    samples = by_time()
    keys = {"evaluated_m": [300.0, 1500.0]}
    expected = evaluate_record(build_record(samples, sidecar(**keys)), LowPass()).values[1]
    assert values(ready(samples, **keys)) == expected


def test_record_in_other_units_is_prepared_in_si(converted_record: Path, two_pantograph_record: Record) -> None:
    """The first pantograph crosses 150 m to 270 m, so that it covers the analysis section."""
    samples, described, _ = read_samples(converted_record)
    prepared = prepare_record(samples, described.model_copy(update={"evaluated_m": (160.0, 240.0)}), LowPass(), 5.0)
    (part,) = prepared.pantographs[1].parts
    assert part.section == pytest.approx((160.0, 240.0))
    assert_allclose(part.force.delivered, two_pantograph_record.force[0], rtol=1e-12)


def test_pantographs_that_share_no_track_leave_nothing_to_evaluate() -> None:
    """After 100 m the second pantograph has just reached the start of the first: the section has no length."""
    time = np.arange(129) / 64
    force = np.full((2, 129), 120.0)
    prepared = ready(RecordSamples(force=force, time=time), speed_km_h=180.0, pantographs=2, spacing_m=[100.0])
    assert prepared.section == (0.0, 0.0)
    assert not prepared.pantographs[1].parts


def test_whole_record_is_evaluated_away_from_its_ends() -> None:
    """Two periods of the cut-off, 0.1 s or 6.94 m, are cut at each end."""
    part = ready(by_time()).pantographs[1].parts[0]
    assert part.section == pytest.approx((6.94, SPEED * 30 - 6.94), abs=0.2)


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


def test_speed_channel_makes_time_from_distance() -> None:
    """At a speed that rises by 4 %, 12 Hz stays 12 Hz only if time is integrated with that speed."""
    position = np.arange(0, 3000, 0.1)
    speed = SPEED * (1 + 0.04 * position / 3000)
    time = 3000 / (0.04 * SPEED) * np.log1p(0.04 * position / 3000)
    force = MEAN + 10 * np.sin(2 * np.pi * 12 * time)
    part = ready(RecordSamples(force=force[None], position=position[None], speed=speed)).pantographs[1].parts[0]
    spectrum = np.abs(np.fft.rfft(part.delivered - part.delivered.mean()))
    assert np.fft.rfftfreq(part.delivered.size, 1 / part.force.rate)[spectrum.argmax()] == pytest.approx(12, abs=0.03)


def test_gap_in_time_is_cut_and_both_sides_are_pooled() -> None:
    samples = by_time()
    kept = (samples.time < 10) | (samples.time > 11)
    found = ready(samples.select(kept))
    assert len(found.pantographs[1].parts) == 2
    assert_allclose(values(found)["std_force_N"], values(ready(samples))["std_force_N"], rtol=0.02)
    assert found.seconds == pytest.approx(29 - 4 * 0.1, abs=0.02)
    assert any("2 sections between gaps" in text for text in found.warnings)


def test_missing_values_are_a_gap_and_two_of_them_are_bridged() -> None:
    samples = by_time()
    force = samples.force.copy()
    force[0, 5000:5003] = np.nan  # 6 ms
    bridged = ready(RecordSamples(force=force, time=samples.time, position=samples.position))
    assert len(bridged.pantographs[1].parts) == 1
    assert any("of pantograph 1 is missing, first at 694.4 m" in text for text in bridged.warnings)
    force[0, 5000:5400] = np.nan
    cut = ready(RecordSamples(force=force, time=samples.time, position=samples.position))
    assert len(cut.pantographs[1].parts) == 2
    assert np.isfinite(values(cut)["std_force_N"])


@pytest.mark.parametrize(("missing", "sections"), [(1, 1), (4, 1), (6, 2), (12, 2), (24, 2)])
@pytest.mark.parametrize("lost", [False, True])
def test_gap_of_the_rear_pantograph_is_bridged_up_to_ten_milliseconds(missing: int, sections: int, lost: bool) -> None:
    """At 500 Hz a gap of k samples lasts 2 k ms; 12 ms or more could hide a peak below 20 Hz.

    Where the force of the rear alone is missing, the front has no gap. Where the samples are lost, both have one.
    """
    samples = by_time(20.0)
    force = np.vstack([samples.force, force_at(samples.position - 200.0)])
    gap = slice(5000, 5000 + missing)
    if lost:
        kept = np.delete(np.arange(samples.time.size), gap)
        two = RecordSamples(force[:, kept], samples.time[kept], position=samples.position[:, kept])
    else:
        force[1, gap] = np.nan
        two = RecordSamples(force, samples.time, position=samples.position)
    found = ready(two, pantographs=2, spacing_m=[200.0])
    parts = [len(found.pantographs[number].parts) for number in (1, 2)]
    assert parts == [sections if lost else 1, sections]
    assert any("pantograph 2 is evaluated over 2 sections" in text for text in found.warnings) is (sections == 2)


def test_change_of_speed_is_cut() -> None:
    """Half of the record runs 10 % too slow: it is cut, with a warning."""
    time = np.arange(0, 60, 0.002)
    position = np.where(time < 30, SPEED * time, SPEED * 30 + 0.9 * SPEED * (time - 30))
    samples = RecordSamples(force=force_at(position)[None], time=time, position=position[None])
    found = ready(samples)
    assert found.seconds == pytest.approx(29.8, abs=0.3)
    assert any("50 % of the record was cut" in text and "from 250 km/h" in text for text in found.warnings)
    nothing = ready(samples, speed_km_h=300.0)
    assert nothing.pantographs[1].parts == ()
    skipped = evaluate_signals(nothing.pantographs, LineSignals(nothing.section)).skipped[1]
    assert "at the nominal speed" in skipped["std_force_N"]


@pytest.mark.parametrize("stated", [True, False])
def test_measuring_chain_filtered_at_20_Hz_has_no_values_above(stated: bool) -> None:
    samples = by_time()
    filtered = RecordSamples(LowPass(order=8)(samples.force[0], 500.0)[None], samples.time, position=samples.position)
    found = ready(filtered, filter_applied_Hz=20.0) if stated else ready(filtered)
    got = evaluate_signals(found.pantographs, LineSignals(found.section))
    for name in ("rms_20_50_N", "std_force_50_N", "cov_50", "contact_loss_pct"):
        assert name not in got.values[1]
        assert "filtered at 20 Hz" in got.skipped[1][name]
    assert got.values[1]["std_force_N"] > SIGMA
    assert any("by the measuring chain" in text for text in found.warnings) == (not stated)


def test_outliers_are_reported_and_graded() -> None:
    samples = by_time()
    force = samples.force.copy()
    force[0, 6000] = 900.0
    found = ready(RecordSamples(force=force, time=samples.time, position=samples.position))
    assert any("1 outlier, which are graded: 900 N at 833.3 m" in text for text in found.warnings)
    assert values(found)["max_force_N"] > values(ready(samples))["max_force_N"] + 10
    assert find_outliers(samples.force[0]).size == 0
    assert list(find_outliers(force[0])) == [6000]


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
    assert len(outliers) == 1
    assert outliers[0].startswith(
        f"the force of pantograph {row + 1} has 1 outlier, which are graded: 900 N at {place}"
    )


def test_noise_of_a_million_samples_has_no_outlier() -> None:
    assert find_outliers(np.random.default_rng(1).normal(120, 25, 1_000_000)).size == 0


def test_rear_pantograph_is_placed_by_its_spacing() -> None:
    samples = by_time()
    two = RecordSamples(
        np.vstack([samples.force, force_at(samples.position - 200.0)]), samples.time, None, samples.position
    )
    found = ready(two, pantographs=2, spacing_m=[200.0])
    assert found.pantographs[2].parts[0].position[0] == pytest.approx(-200.0)
    assert found.section == pytest.approx((0.0, SPEED * 29.998 - 200), abs=0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: RecordSamples(s.force, s.time[::-1], position=s.position), "time: does not increase from sample 1"),
        (
            lambda s: RecordSamples(s.force, s.time, position=s.position[:, ::-1]),
            "position: does not increase from sample 1",
        ),
        (lambda s: RecordSamples(s.force, np.full(s.time.size, np.nan)), "fewer than two samples"),
        (
            lambda s: RecordSamples(s.force, speed=np.zeros(s.time.size), position=s.position),
            "stands still at nearly every",
        ),
        (lambda s: RecordSamples(s.force, np.r_[s.time[:-1], 1e8], position=s.position), "are more than"),
    ],
)
def test_impossible_axes_are_rejected(change: Callable[[RecordSamples], RecordSamples], message: str) -> None:
    with pytest.raises(RecordInvalid, match=message):
        ready(change(by_time()))


def test_odometer_that_moves_in_steps_is_smoothed() -> None:
    """A counter of 0.5 m steps, sampled every 0.14 m: the position grows evenly in between, the statistics stay."""
    samples = by_time()
    stepped = np.floor(samples.position * 2) / 2
    found = ready(RecordSamples(samples.force, samples.time, position=stepped))
    assert np.all(np.diff(found.pantographs[1].parts[0].position) > 0)
    assert_allclose(values(found)["std_force_N"], values(ready(samples))["std_force_N"], rtol=1e-3)


def test_record_that_covers_too_little_has_no_values() -> None:
    """A truncated record does not represent the line: 30 s are 2083 m."""
    for asked, share in ((3000.0, "69"), (2083.0, None), (10_000.0, "only 21")):
        found = ready(by_time(), evaluated_m=[10.0, asked])
        texts = [*found.warnings, *evaluate_signals(found.pantographs, found.line).skipped[1].values()]
        assert (len(found.pantographs[1].parts) == 1) == (asked < 5000)
        assert any(f"{share} % of" in text or f"{share}" in text for text in texts) == (share is not None)


def test_support_with_missing_uplift_is_not_evaluated() -> None:
    samples = by_time()
    uplift = np.full((2, samples.time.size), 0.03)
    uplift[0, 150] = 0.05
    uplift[1, 150] = np.nan  # may have been the largest
    lines = RecordSamples(samples.force, samples.time, None, samples.position, None, uplift, np.array([300.0, 360.0]))
    found = ready(lines, support_position_m=[300.0, 360.0]).line
    assert (found.uplift.shape[0], found.uplift.max()) == (1, 0.05)
    assert any("of the uplift is missing" in text for text in ready(lines, support_position_m=[300.0, 360.0]).warnings)
