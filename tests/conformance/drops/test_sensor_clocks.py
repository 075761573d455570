"""Clocks of the sensors: rate and start from the decays, correction, and a stated clock that is refuted."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.surrogate_drops import build_line_modes, make_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.drops.sensor_clocks import interpolate
from verification.tables.field_records import LINES, Disturbance


def test_interpolation_is_exact_below_a_third_of_the_rate() -> None:
    """Window of 32 samples: error below 1e-4 of a sine with three samples in a period, away from the ends."""
    t = np.arange(400.0)
    place = t + 0.37 + 5e-5 * t
    signals = np.column_stack([np.sin(2 * np.pi * f * t + 0.3) for f in (0.01, 0.1, 0.33)])
    expected = np.column_stack([np.sin(2 * np.pi * f * place + 0.3) for f in (0.01, 0.1, 0.33)])
    assert_allclose(interpolate(signals, place)[20:-20], expected[20:-20], atol=1e-4)


@pytest.fixture(scope="module")
def skewed() -> tuple[DropRecord, np.ndarray, np.ndarray]:
    """Record whose second sensor has a slow clock, and true frequencies."""
    modes = build_line_modes(next(iter(LINES)))
    made = make_record(modes, np.random.default_rng(4), Disturbance(), sensors=3, minutes=1.5)
    record = made.record
    signals = record.signals.copy()
    # A clock that is slow by 60 ppm and starts 15 ms late shows at t the motion at t (1 + 60 ppm) + 15 ms.
    signals[:, [1]] = interpolate(signals[:, [1]], (record.time * (1 + 60e-6) + 0.015) * record.rate)
    return replace(record, signals=signals), made.frequency, made.ratio


def test_rate_and_start_are_found_and_corrected(skewed: tuple[DropRecord, np.ndarray, np.ndarray]) -> None:
    """Rate and start within five of their deviations; frequencies then agree within 2 ppm and their bound."""
    record, frequency, _ = skewed
    (found,) = identify_modes((record,), 2.3)
    clock = next(clock for clock in found.clocks if clock.sensor == 2)
    assert clock.rate == pytest.approx(-60e-6, abs=5 * clock.rate_std)
    assert clock.rate_std < 5e-6
    assert clock.start == pytest.approx(0.015, abs=5 * clock.start_std)
    assert clock.start_std < 0.0003  # 0.07 ms; phases of near poles, whose residues are uncertain, would make it 5 ms
    assert any("clocks of their own" in text for text in found.warnings)
    for mode in found.modes:
        if mode.certain:
            nearest = frequency[np.argmin(np.abs(frequency - mode.frequency_Hz))]
            assert mode.frequency_Hz == pytest.approx(nearest, abs=5 * mode.frequency_std_Hz + 2e-6 * nearest)
    rows = analyse_identification(found).clocks
    assert [row.corrected for row in rows] == [True, False]


def test_stated_common_clock_that_is_refuted_is_an_error(skewed: tuple[DropRecord, np.ndarray, np.ndarray]) -> None:
    with pytest.raises(InputError, match="states one clock for all sensors, but that of sensor 2 runs slow by"):
        identify_modes((replace(skewed[0], shared_clock=True),), 2.3)
