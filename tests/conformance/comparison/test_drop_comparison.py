"""Recorded drops beside their simulation: agreement with themselves, known damping, missing data, refusals."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from helpers.recorded_drops import DURATION, RATE, RELEASE, WINDOWS, build_task, read_short_line, record_drop
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit
from pantocheck.conformance.comparison.drop_comparison import compare_drop
from pantocheck.conformance.comparison.drop_motion import ALIGNED_S, SEARCH_S, align_release
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropDescription, DropRecord
from pantocheck.conformance.drops.drop_simulation import decimate
from pantocheck.conformance.results.drop_comparison_format import DropComparison, ModelAgreement
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.model import Catenary
from pantocheck.model.dynamics import mass_drop
from pantocheck.model.dynamics.drop_values import FreeDecay, MassDropSetup
from pantocheck.model.dynamics.mass_drop import simulate_mass_drop

ALL = (0.3, 20.0)
EARLY, LATE = WINDOWS


def limit(window: tuple[float, float] = LATE, **changes: Any) -> dict[str, Any]:
    """Limit of 2 % on the RMS ratio of both sensors."""
    table = {"quantity": "rms_ratio", "sensors": [1, 2], "window_s": window, "band_Hz": ALL}
    return table | {"lower": 0.98, "upper": 1.02} | changes


def limits(*tables: dict[str, Any]) -> tuple[ComparisonLimit, ...]:
    return tuple(map(ComparisonLimit.model_validate, tables))


def find(
    comparison: DropComparison, place: str, motion: str, window: tuple[float, float]
) -> tuple[ModelAgreement, ...]:
    """Agreement of the models at one place, up to 20 Hz."""
    (row,) = (
        row for row in comparison.statistics
        if (row.place, row.motion, row.window_s, row.band_Hz) == (place, motion, window, ALL)
    )  # fmt: skip
    return row.models


SIMULATIONS: dict[str, FreeDecay] = {}
"""Simulated drops by their inputs: most comparisons of this file need the same one."""


@pytest.fixture(scope="module", autouse=True)
def _share_simulations() -> Iterator[None]:
    def simulate(catenary: Catenary, element: float, test: MassDropSetup, progress: Any) -> FreeDecay:
        key = repr((catenary, element, test))
        if key not in SIMULATIONS:
            SIMULATIONS[key] = simulate_mass_drop(catenary, element, test, progress)
        return SIMULATIONS[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mass_drop, "simulate_mass_drop", simulate)
        yield


SHARES: list[float] = []
"""Completed shares that the comparison of two models reports."""


@pytest.fixture(scope="module")
def two_models() -> DropComparison:
    """Record under 0.1 1/s; models with 0.1 and 0.3 1/s."""
    return compare_drop(record_drop(), build_task(0.1, 0.3), SHARES.append)


def test_progress_grows_over_all_models_and_the_release_lies_between_two_samples(two_models: DropComparison) -> None:
    assert len(two_models.models) == 2
    assert sorted(SHARES) == SHARES
    assert 0 <= SHARES[0] <= 0.5 < SHARES[-1] <= 1
    # A sample lasts 5 ms; the search interpolates to some microseconds, and noise adds as little.
    assert two_models.drop.release_s == pytest.approx(RELEASE, abs=2e-5)
    assert two_models.drop.release_correlation > 0.9999
    assert (two_models.verdict, two_models.criteria) == ("info", ())


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("motion", ["velocity", "acceleration"])
def test_model_agrees_with_itself(two_models: DropComparison, motion: str, window: tuple[float, float]) -> None:
    """Noise of 1 mm/s2 is 0.05 % of the late acceleration."""
    for place in ("S1_z", "S2_z"):
        own, _ = find(two_models, place, motion, window)
        assert own.rms_ratio == pytest.approx(1.0, abs=2e-4)
        assert own.correlation == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
def test_records_of_other_quantities_agree_too(quantity: str) -> None:
    """The second derivative of noise of 0.01 mm is 4 % of the acceleration; a tenth of it remains after its removal."""
    comparison = compare_drop(record_drop(noise=1e-5, quantity=quantity), build_task(0.1))
    for motion in ("velocity", "acceleration"):
        (own,) = find(comparison, "S1_z", motion, EARLY)
        assert own.rms_ratio == pytest.approx(1.0, abs=4e-3)


def test_deviation_of_another_damping_is_that_of_theory(two_models: DropComparison) -> None:
    """With damping proportional to mass, (zeta_2 - zeta_1) omega = 0.1 1/s for every mode.

    The ratio of both models falls with exp(-0.1 t): its square, weighted by the energy of the record in windows of two
    seconds, gives the ratio of a window. Slack droppers do not change this decay; the frequency does, by zeta^2 / 2.
    """
    for energy in two_models.energies:
        ratio = np.sqrt(np.array(energy.models["b0.3"]) / np.array(energy.models["b0.1"]))
        expected = np.exp(-0.1 * np.array(energy.time_s))
        assert ratio == pytest.approx(expected, rel=0.05)


def test_mass_has_curves_of_the_models_and_no_record(two_models: DropComparison) -> None:
    curves = [curve for curve in two_models.curves if curve.place == "mass"]
    assert [(curve.motion, curve.window_s) for curve in curves] == [
        (motion, window) for motion in ("velocity", "acceleration") for window in WINDOWS
    ]
    assert all(curve.record is None and set(curve.models) == {"b0.1", "b0.3"} for curve in curves)
    assert all(row.rms_ratio is None for row in find(two_models, "mass", "velocity", EARLY))


def grade(record: DropRecord, *tables: dict[str, Any], model: float = 0.1) -> DropComparison:
    return compare_drop(record, build_task(model, limits=limits(*tables)))


def test_limits_grade_the_first_model() -> None:
    comparison = grade(record_drop(), limit(), limit(quantity="correlation", lower=0.99, upper=None))
    assert comparison.verdict == "pass"
    assert {item.source for item in comparison.criteria} == {""}
    assert [item.where.sensor for item in comparison.criteria] == [1, 2, 1, 2]
    assert all(item.uncertainty is not None and item.uncertainty > 0 for item in comparison.criteria)
    # Elements of 2.25 m: half of them change the late ratio of sensor 2 by more than 2 %.
    assert comparison.criteria[0].close == []
    assert "finer mesh and time step could reverse the verdict" in comparison.criteria[1].close[0]
    other = grade(record_drop(), limit(source="plan 3"), model=0.11)
    assert other.verdict == "fail"
    assert {item.source for item in other.criteria} == {"plan 3"}
    assert "below the lower limit" in str(other.criteria[0].reason)


def keep_channels(record: DropRecord, columns: tuple[int, ...]) -> DropRecord:
    return replace(
        record, signals=record.signals[:, list(columns)].copy(), channels=tuple(record.channels[c] for c in columns)
    )


def test_no_removal_of_a_sensor_makes_a_failing_record_pass() -> None:
    """Sensor 1 measures 10 % too much. Without it, its limit stays open."""
    signals = record_drop().signals * [1.1, 1.0]
    record = replace(record_drop(), signals=signals)
    assert grade(record, limit()).verdict == "fail"
    for columns in combinations(range(2), 1):
        comparison = grade(keep_channels(record, columns), limit())
        assert comparison.verdict in {"fail", "skip"}
    assert comparison.criteria[0].reason == "the record has no vertical channel of sensor 1"


def test_sensor_without_a_limit_does_not_move_the_release() -> None:
    """The clock of sensor 2 is 20 ms late: if it took part, its removal would raise the correlation of sensor 1."""
    record = record_drop()
    late = replace(record, signals=np.column_stack([record.signals[:, 0], np.roll(record.signals[:, 1], 4)]))
    table = limit(EARLY, quantity="correlation", sensors=[1], lower=0.99, upper=None)
    with_it, without_it = (grade(each, table) for each in (late, keep_channels(late, (0,))))
    assert with_it.criteria == without_it.criteria
    assert with_it.drop.release_s == pytest.approx(RELEASE, abs=2e-5)


def test_release_at_an_end_of_the_search_is_found() -> None:
    """The record is not longer than the compared seconds, or the release lies at the latest time of the search."""
    model = np.sin(2 * np.pi * 1.3 * np.arange(round(ALIGNED_S * RATE)) / RATE)[:, None]
    assert align_release(model, model, RATE, 0.0) == (pytest.approx(0.0, abs=2e-3), pytest.approx(1.0, abs=0.01))
    late = np.vstack([np.zeros((round(SEARCH_S * RATE), 1)), model, np.zeros((400, 1))])
    found, correlation = align_release(late, model, RATE, 0.0)
    assert found == pytest.approx(SEARCH_S, abs=1e-3)
    assert correlation > 0.99


@pytest.mark.parametrize("rest", [0.0, 0.4, 1.7])
def test_release_near_the_start_of_the_record_is_found(rest: float) -> None:
    """A record that begins at the release, or less than a second before it; the wave needs 0.1 s to a sensor.

    Without rest, the offset of a sensor follows from the decay, with an error of less than a percent of it.
    """
    begin = round((RELEASE - rest) * RATE)
    comparison = compare_drop(keep_samples(begin, trigger_nominal=rest), build_task(0.1))
    assert comparison.drop.release_s == pytest.approx(RELEASE - begin / RATE, abs=1e-4)
    (own,) = find(comparison, "S1_z", "velocity", LATE)
    assert own.rms_ratio == pytest.approx(1.0, abs=5e-3)


def keep_samples(begin: int | None, end: int | None = None, **drop: float) -> DropRecord:
    """Part of the record; its description of the drop may be changed."""
    record = record_drop()
    return replace(record, signals=record.signals[begin:end].copy(), drop=replace(record.drop, **drop))


def test_record_that_ends_early_or_has_no_rest_leaves_its_limits_open() -> None:
    """The fade of one second at the end must lie behind the window."""
    record = keep_samples(None, round((RELEASE + 9.9) * RATE))
    comparison = grade(record, limit(EARLY), limit(LATE))
    assert [item.verdict for item in comparison.criteria] == ["pass", "pass", "skip", "skip"]
    assert "does not contain the window from 6 to 9 s" in str(comparison.criteria[2].reason)
    assert any("window from 6 to 9 s" in text for text in comparison.warnings)
    # The window of the first four seconds ends half a second before the fade.
    early = compare_drop(keep_samples(None, round((RELEASE + 5.5) * RATE)), build_task(0.1, windows=(EARLY,)))
    assert not any("window from" in text for text in early.warnings)
    # Its noise is not known, and could hide a ratio outside the limits.
    record = keep_samples(round(2.5 * RATE), trigger_nominal=RELEASE - 2.5)
    comparison = grade(record, limit())
    assert comparison.verdict == "skip"
    assert "no rest before the release" in str(comparison.criteria[0].reason)


def test_noise_leaves_a_limit_open_or_marks_a_close_criterion() -> None:
    """Noise of 2 m/s2 has 0.8 m/s2 in the band, more than 0.3 of the 2.1 m/s2 of the record."""
    comparison = grade(record_drop(noise=2.0), limit(band_Hz=(5.0, 20.0), sensors=[1]))
    assert comparison.verdict == "skip"
    assert "noise of the record is too large" in str(comparison.criteria[0].reason)
    assert comparison.criteria[0].value is None
    # Noise of 1 m/s2: 2 * 0.4 / 2.0 / sqrt(2 * 15 * 3) = 4 %, more than the distance from the limits.
    comparison = grade(record_drop(noise=1.0), limit(band_Hz=(5.0, 20.0), sensors=[1], lower=0.9, upper=1.03))
    (item,) = comparison.criteria
    assert item.limit_uncertainty == pytest.approx(0.041, abs=0.003)
    assert "could reverse the verdict" in item.close[0]


def test_clipped_channel_unknown_line_and_high_band_leave_limits_open() -> None:
    """Sensor 2 is saturated shortly after the release; integrals and filters carry the error on."""
    signals = record_drop().signals.copy()
    signals[:, 1] = np.clip(signals[:, 1], -8.0, 8.0)
    comparison = grade(replace(record_drop(), signals=signals), limit(lower=0.5, upper=2.0))
    assert [item.verdict for item in comparison.criteria] == ["pass", "skip"]
    assert comparison.criteria[1].reason == "the channel is clipped in this window"
    comparison = grade(replace(record_drop(), line=MeasuredLine()), limit())
    assert comparison.verdict == "unconfirmed"
    assert any("not confirmed" in text for text in comparison.warnings)
    # A record of 100 samples per second supports 40 Hz.
    record = replace(record_drop(), signals=record_drop().signals[::2].copy(), rate=RATE / 2)
    comparison = grade(record, limit(band_Hz=(20.0, 50.0)))
    assert comparison.criteria[0].reason == "the sampling rate of the record does not support the band of 20 to 50 Hz"


def test_slow_record_is_aligned_too_and_a_very_slow_one_is_refused() -> None:
    """The filter of a record of 25 samples per second rings for 0.5 s before the release; 10 support 4 Hz only."""
    slow, slower = (replace(record_drop(), signals=decimate(record_drop().signals, k), rate=RATE / k) for k in (8, 20))
    comparison = compare_drop(slow, build_task(0.1))
    assert comparison.bands_Hz == ((0.3, 5.0),)
    assert comparison.drop.release_s == pytest.approx(RELEASE, abs=1e-4)
    with pytest.raises(InputError, match=r"has 10 samples per second.*\n.*lowest band needs 12\.5"):
        compare_drop(slower, build_task(0.1))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drop": DropDescription(None, "CW", 94.5)}, "record 'drop.h5', key drop.mass_kg: missing"),
        ({"drop": DropDescription(30.0, "", 94.5)}, "key drop.wire: missing"),
        ({"drop": DropDescription(30.0, "XW", 94.5)}, "key drop.wire: found 'XW'"),
        ({"drop": DropDescription(30.0, "CW", None)}, "key drop.position_m: missing"),
        ({"drop": DropDescription(30.0, "CW", 400.0)}, "key drop.position_m: no wire CW at 400 m"),
        ({"line": MeasuredLine(spans_m=(63.0, 63.0, 54.0))},
         "length of span 3 is 54 m in the record, 58.5 m on the line"),
        ({"line": MeasuredLine(spans_m=(63.0, 63.0))}, "number of spans is 2 in the record, 3 on the line"),
        ({"line": MeasuredLine(spans_m=(), contact_wire_tension_N=24e3)},
         "tension of the contact wire is 24000 N in the record, 20000 N on the line"),
    ],
)  # fmt: skip
def test_record_of_another_drop_or_line_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        compare_drop(replace(record_drop(), **changes), build_task(0.1))


def test_record_of_another_sensor_wire_or_duration_is_refused() -> None:
    record = record_drop()
    for channel, message in (
        (replace(record.channels[0], wire="XW"), "channel 'S1_z', key wire: found 'XW'"),
        (replace(record.channels[0], position=None), "channel 'S1_z', key position_m: missing"),
        (replace(record.channels[0], position=300.0), "position of sensor 1 on the contact wire is 300 m"),
    ):
        with pytest.raises(InputError, match=message):
            compare_drop(replace(record, channels=(channel, record.channels[1])), build_task(0.1))
    lateral = tuple(replace(channel, axis="y") for channel in record.channels)
    with pytest.raises(InputError, match="no vertical channel"):
        compare_drop(replace(record, channels=lateral), build_task(0.1))
    with pytest.raises(InputError, match="can be compared until"):
        compare_drop(record, build_task(0.1, windows=((0.0, DURATION),)))
    short = replace(record, signals=record.signals[: round((RELEASE + 2.4) * RATE)].copy())
    with pytest.raises(InputError, match="after the first motion"):
        compare_drop(short, build_task(0.1))


def test_limit_of_another_window_or_of_two_equal_sensors_is_refused() -> None:
    with pytest.raises(InputError, match=r"limit\[1\].window_s: \[1.0, 2.0\] is not a compared window"):
        grade(record_drop(), limit((1.0, 2.0)))
    record = record_drop()
    equal = tuple(replace(channel, sensor=1) for channel in record.channels)
    with pytest.raises(InputError, match="2 vertical channels have the number 1"):
        grade(replace(record, channels=equal), limit())


def test_wrong_mass_is_doubted_in_the_ratio_and_wrong_place_in_the_correlation() -> None:
    record = record_drop()
    heavy = compare_drop(replace(record, drop=replace(record.drop, mass=33.0)), build_task(0.1))
    assert find(heavy, "S1_z", "acceleration", EARLY)[0].rms_ratio == pytest.approx(1.1, abs=0.03)
    elsewhere = compare_drop(replace(record, drop=replace(record.drop, position=20.0)), build_task(0.1))
    assert any("mass, place, line or units" in text for text in elsewhere.warnings)


def test_same_record_gives_the_same_bytes_on_its_line() -> None:
    first = compare_drop(record_drop(), build_task(0.1)).model_dump_json()
    SIMULATIONS.clear()
    assert compare_drop(record_drop(), build_task(0.1)).model_dump_json() == first
    assert read_short_line().geometry.span_lengths == (63.0, 63.0, 58.5)
