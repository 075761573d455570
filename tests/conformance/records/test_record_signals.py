"""Quantities of a record: values computed by hand, and a reason for each quantity that is not available."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import ArrayLike

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.force_quantities import PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals, evaluate_record

RATE, SPEED = 1000.0, 50.0


def record(force: ArrayLike | None = None, rate: float = RATE, length: float = 600.0, **changes: Any) -> Record:
    """100 N and sines of 20 N at 2 Hz, 10 N at 10 Hz, 8 N at 30 Hz; whole periods in the 4 s of 200 m to 400 m."""
    time = np.arange(int(length / SPEED * rate)) / rate
    if force is None:
        force = 100 + sum(a * np.sin(2 * np.pi * f * time) for a, f in ((20, 2), (10, 10), (8, 30)))
    fields: dict[str, Any] = {
        "time": time,
        "speed": SPEED,
        "position": SPEED * time[None],
        "force": np.atleast_2d(force),
        "evaluated": (200.0, 400.0),
    }
    return Record(**(fields | changes))


def values(item: Record, **filter_settings: Any) -> dict[str, Value]:
    return evaluate_record(item, Filter(**filter_settings)).values[1]


def test_every_quantity_of_a_known_force() -> None:
    found = values(record(contact_height=5.3 + 0.02 * np.sin(2 * np.pi * np.arange(12_000) / 12_000 * 12)[None]))
    # Gain of the default filter at 2, 10 and 30 Hz, and of the 50 Hz one: 1 / (1 + (sqrt(2) - 1) W^6) by definition.
    gain = Filter().gain(np.array([2.0, 10.0, 30.0]), RATE)
    gain_50 = Filter(cutoff_Hz=50.0).gain(np.array([2.0, 10.0, 30.0]), RATE)
    sigma = np.sqrt(np.sum((gain * [20, 10, 8]) ** 2) / 2)
    sigma_50 = np.sqrt(np.sum((gain_50 * [20, 10, 8]) ** 2) / 2)
    expected = {
        "mean_force_N": 100.0,
        "std_force_N": sigma,
        "std_force_50_N": sigma_50,
        "cov_20": sigma / 100,
        "cov_50": sigma_50 / 100,
        "rms_0_5_N": 20 / np.sqrt(2),
        "rms_5_20_N": 10 / np.sqrt(2),
        "rms_20_50_N": 8 / np.sqrt(2),
        "statistical_max_N": 100 + 3 * sigma,
        "statistical_min_N": 100 - 3 * sigma,
        "contact_loss_pct": 0.0,
        "longest_contact_loss_s": 0.0,
        "contact_loss_events": 0.0,
        "contact_height_range_mm": 40.0,
    }
    for name, number in expected.items():
        # The filter's transients from the ends of the record, 4 s away, are below 1e-9.
        assert_allclose(found[name], number, rtol=1e-6, err_msg=name)
    assert 100 + 20 < found["max_force_N"] < 100 + 20 + 10 + 8 * gain[2]
    assert set(found) == {quantity.name for quantity in PANTOGRAPH_QUANTITIES}


def test_extremes_are_those_of_the_whole_filtered_record() -> None:
    """A spike of one sample: 500 N in the unfiltered force, below 20 N after 20 Hz (2 f_c / rate of its height)."""
    force = np.full(12_000, 100.0)
    force[6000] += 500
    assert 100 < values(record(force))["max_force_N"] < 125
    # A step 20 ms before the analysis section still rings inside it; filtering the section alone would miss it.
    force = np.full(12_000, 100.0)
    force[: int(RATE * 200 / SPEED) - 20] = 200.0
    assert values(record(force))["max_force_N"] > 101


def test_quantities_belong_to_their_pantograph_and_supports() -> None:
    """The second pantograph runs 100 m behind: it crosses the section 2 s later, at another force."""
    time = np.arange(12_000) / RATE
    position = np.array([SPEED * time, SPEED * time - 100])
    force = np.where(position < 200, 500.0, np.where(position < 400, [[110.0], [130.0]], 900.0))
    found = evaluate_record(record(force, position=position), Filter()).values
    assert_allclose([found[1]["mean_force_N"], found[2]["mean_force_N"]], [110, 130], rtol=1e-12)
    supports = np.array([150.0, 200.0, 300.0, 400.0, 450.0])
    uplift = np.zeros((5, 12_000))
    uplift[:, 7000] = [0.9, 0.04, 0.05, 0.06, 0.9]
    found = evaluate_record(record(support_position=supports, support_uplift=uplift), Filter(), tuple(supports))
    assert_allclose(found.values[LINE]["max_uplift_at_support_mm"], 60.0)


def test_filtered_force_and_low_rate_have_no_values_above() -> None:
    evaluation = evaluate_record(record(filter_applied_Hz=20.0), Filter())
    losses = {"contact_loss_pct", "longest_contact_loss_s", "contact_loss_events"}
    assert set(evaluation.skipped[1]) == {"std_force_50_N", "cov_50", "rms_20_50_N", "contact_height_range_mm"} | losses
    assert "filtered at 20 Hz" in evaluation.skipped[1]["rms_20_50_N"]
    assert "filtered at 20 Hz" in evaluation.skipped[1]["std_force_50_N"]
    assert "mean_force_N" in evaluation.values[1]
    evaluation = evaluate_record(record(rate=100.0), Filter())
    assert {"rms_20_50_N", "std_force_50_N", "cov_50"} < set(evaluation.skipped[1])
    assert "100 samples per second; a filter at 50 Hz needs at least 125" in evaluation.skipped[1]["rms_20_50_N"]
    assert evaluation.values[1]["std_force_N"] > 0


@pytest.mark.parametrize("length", [190.0, 390.0])
def test_truncated_record_has_no_values(length: float) -> None:
    evaluation = evaluate_record(record(length=length), Filter())
    assert evaluation.values[1] == {}
    assert "but the analysis section extends from 200 m to 400 m" in evaluation.skipped[1]["mean_force_N"]


@pytest.mark.parametrize("samples", [-20.0, -0.5, 0.0, 0.9, 1.1, 2.0, 5.0, 9.9, 100.0])
@pytest.mark.parametrize("rate", [250.0, 1000.0])
def test_every_pantograph_covers_the_section_to_one_sample(rate: float, samples: float) -> None:
    """The front begins, or the rear ends, some samples inside the section, which may end between two samples."""
    time = np.arange(int(12 * rate)) / rate
    position = np.array([SPEED * time, SPEED * time - 100])
    force = np.array([[110.0], [130.0]]) + 20 * np.sin(2 * np.pi * 2 * time)
    start, end, missing = position[0, 0], position[1, -1], samples * SPEED / rate
    for number, section in ((1, (start - missing, end)), (2, (start, end + missing))):
        evaluation = evaluate_record(record(force, rate, position=position, evaluated=section), Filter())
        assert ("mean_force_N" in evaluation.values[number]) is (samples <= 1)
        assert samples <= 1 or "the record covers" in evaluation.skipped[number]["mean_force_N"]
        assert "mean_force_N" in evaluation.values[3 - number]


def test_minimum_may_be_negative() -> None:
    """A minimum clipped at zero, or without its sign, would meet a lower limit; adhesion gives -60 N and -20 N."""
    # The step of the filter has settled after a quarter of the 0.4 s: the overshoot alone is less than 15 %.
    time = np.arange(12_000) / RATE
    inside = np.abs(time - 6.5) < 0.2
    force = np.where(inside, [[-60.0], [-20.0]], 100.0)
    position = np.array([SPEED * time, SPEED * time])
    found = evaluate_record(record(force, position=position), Filter()).values
    assert -60 - 0.15 * 160 < found[1]["min_force_N"] <= -60
    assert -20 - 0.15 * 120 < found[2]["min_force_N"] <= -20


def test_short_section_or_bare_record_states_the_reason() -> None:
    evaluation = evaluate_record(record(evaluated=(200.0, 220.0)), Filter())
    assert "lasts 0.4 s" in evaluation.skipped[1]["rms_0_5_N"]
    assert evaluation.values[1]["std_force_N"] > 0
    shorter = evaluate_record(record(evaluated=(200.0, 205.0)), Filter())
    assert "need at least 0.2 s" in shorter.skipped[1]["std_force_N"]
    evaluation = evaluate_record(record(), Filter())
    assert evaluation.skipped[1]["contact_height_range_mm"] == "the record has no contact height"
    assert evaluation.skipped[LINE]["max_uplift_at_support_mm"] == "the record has no uplift at supports"


def test_statistics_are_linear_in_the_force() -> None:
    """A gain of 1.05 scales all statistics; an offset changes only mean and extremes."""
    plain, louder = values(record()), values(record(1.05 * record().force))
    for name in ("mean_force_N", "std_force_N", "rms_5_20_N", "max_force_N", "statistical_min_N"):
        assert_allclose(louder[name], 1.05 * plain[name], rtol=1e-9)
    moved = values(record(record().force + 7))
    assert_allclose(moved["std_force_N"], plain["std_force_N"], rtol=1e-9)
    assert_allclose(moved["min_force_N"], plain["min_force_N"] + 7, rtol=1e-9)


def test_registry_has_every_name_of_the_contract() -> None:
    names = """mean_force_N std_force_N std_force_50_N cov_20 cov_50 rms_0_5_N rms_5_20_N rms_20_50_N statistical_max_N
    statistical_min_N max_force_N min_force_N contact_loss_pct max_uplift_at_support_mm contact_height_range_mm
    presag_mm dropper_length_m elasticity_mm_N elasticity_non_uniformity_pct wave_speed_m_s speed_over_wave_speed
    mode_frequency_Hz damping_ratio"""
    assert set(QUANTITIES) >= set(names.split())
    assert all(
        name == quantity.name and quantity.label and quantity.definition and quantity.needs.text and quantity.source
        for name, quantity in QUANTITIES.items()
    )


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda u: -u, "falls by 50 mm"),
        (lambda u: u + 0.01, "is 10 mm at rest"),
        (lambda u: np.minimum(u, 0.03), "flat"),
    ],
)
def test_uplift_of_a_faulty_sensor_has_no_value(change: Callable[[RealArray], RealArray], reason: str) -> None:
    """In a record of one file, such as that of a case; the checks of the passages still see the uplift."""
    uplift = np.round(0.05 * np.exp(-np.abs(SPEED * np.arange(12_000) / RATE - 300) / 12), 6)
    signals = [
        RecordSignals(record(support_position=np.array([300.0]), support_uplift=row[None]), Filter())
        for row in (uplift, change(uplift))
    ]
    assert signals[0].line.largest_uplift == 0.05
    with pytest.raises(QuantityUnavailable, match=reason):
        signals[1].line.largest_uplift  # noqa: B018 - raises
    assert_allclose(signals[1].delivered_line.uplift[0], change(uplift))
