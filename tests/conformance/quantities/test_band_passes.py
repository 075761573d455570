"""Edges of a filter and bands behind band-passes: closed forms of the gain, and the sum of the squares."""

import csv
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import butter, sosfiltfilt

from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.force_quantities import BAND_PASS_CHANGE
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals, edge_warnings
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

RATE = 500.0
TIME = np.arange(8000) / RATE
TWICE = Filter(order=8, attenuation_dB=6, bands="band-pass")
"""Order 4, forwards and backwards."""
BANDS = ((0.0, 5.0), (5.0, 20.0))


def read(force: np.ndarray, low_pass: Filter, applied: float | None = None) -> PantographSignals:
    """Signals over 8 s in the middle of 16 s: whole periods of 0.125 Hz, transients far outside."""
    return PantographSignals(TIME, ForceChannel(force, RATE, low_pass, applied), (4.0, 12.0))


def test_stated_change_of_a_band_is_the_largest_of_the_computed_ones() -> None:
    table = Path(__file__).parents[3] / "docs" / "tables" / "bands.csv"
    rows = csv.DictReader(table.read_text("utf-8").splitlines())
    changes = [(row["band"], abs(float(row["band-pass"].removesuffix(" %")))) for row in rows]
    largest = {name: max(change for band, change in changes if band == name) for name, _ in changes}
    assert largest == BAND_PASS_CHANGE


@pytest.mark.parametrize("phase", ["zero", "causal"])
@pytest.mark.parametrize(("decibels", "expected"), [(3, np.sqrt(0.5)), (6, 0.5)])
@pytest.mark.parametrize("order", [2, 6, 8])
def test_whole_filter_has_the_stated_attenuation_at_every_edge(
    phase: Literal["zero", "causal"], decibels: Literal[3, 6], expected: float, order: int
) -> None:
    """The bilinear transform is pre-warped at the edges, so that only rounding is left."""
    low_pass = Filter(order=order, phase=phase, attenuation_dB=decibels)
    assert_allclose(low_pass.gain(np.array([20.0]), RATE), expected, rtol=1e-9)
    assert_allclose(low_pass.gain(np.array([5.0, 20.0]), RATE, low=5.0), expected, rtol=1e-8)
    assert_allclose(low_pass.gain(np.array([10.0]), RATE, low=5.0), 1.0, atol=0.06 if order == 2 else 0.01)
    # A sine at the edge, whose RMS over whole periods is exact.
    sine = np.sqrt(2) * np.sin(2 * np.pi * 20 * TIME)
    assert read(sine, low_pass).graded.std() == pytest.approx(expected, rel=1e-6)
    bands = low_pass.model_copy(update={"bands": "band-pass"})
    assert read(sine, bands).band(5, 20) == pytest.approx(expected, rel=1e-6)


def test_six_decibels_are_the_filter_of_half_the_order_run_twice() -> None:
    force = np.random.default_rng(5).normal(size=TIME.size)
    expected = sosfiltfilt(butter(4, [5, 20], "bandpass", fs=RATE, output="sos"), force, padlen=200)
    assert_allclose(TWICE(force, RATE, low=5.0), expected, atol=1e-10)


@pytest.mark.parametrize(("frequency", "shares"), [(1.0, (1, 0)), (5.0, (0.5, 0.5)), (10.0, (0, 1)), (20.0, (0, 0.5))])
def test_band_passes_share_out_a_sine(frequency: float, shares: tuple[float, float]) -> None:
    """Far from an edge the squares add up; at the common edge each band has half of the amplitude, half in sum."""
    signals = read(120 + np.sqrt(2) * np.sin(2 * np.pi * frequency * TIME + 0.3), TWICE)
    # At 1 Hz the band-pass leaves (1/5)^8, at 10 Hz the low-pass (5/10)^8 = 0.4 %.
    assert_allclose([signals.band(*edges) for edges in BANDS], shares, atol=5e-3)
    lines = read(signals.force.delivered, TWICE.model_copy(update={"bands": "spectral lines"}))
    assert np.hypot(*(lines.band(*edges) for edges in BANDS)) == pytest.approx(1.0, rel=1e-9)


def test_sum_of_squares_is_the_power_that_the_bands_leave() -> None:
    """A sum of sines over whole periods: the squares add up to the power times both squared gains."""
    frequencies = np.array([0.5, 3.0, 4.5, 5.5, 8.0, 15.0, 19.0, 21.0, 30.0])
    signals = read(np.sin(2 * np.pi * np.outer(frequencies, TIME)).sum(axis=0), TWICE)
    gains = [TWICE.change_cutoff(high).gain(frequencies, RATE, low) for low, high in BANDS]
    expected = np.sqrt(0.5 * np.sum(np.square(gains)))
    assert np.hypot(*(signals.band(*edges) for edges in BANDS)) == pytest.approx(expected, rel=1e-6)
    part = signals.band_part(5, 20)
    assert np.sqrt(np.mean(part**2)) == pytest.approx(signals.band(5, 20), rel=1e-12)


def test_band_pass_needs_the_unfiltered_force_and_room_to_settle() -> None:
    force = np.sin(2 * np.pi * 3 * TIME)
    assert read(force, TWICE, applied=50.0).band(5, 20) >= 0
    with pytest.raises(AlreadyFiltered, match="a band-pass up to 20 Hz needs the unfiltered force"):
        read(force, TWICE, applied=20.0).band(5, 20)
    short = PantographSignals(TIME, ForceChannel(force, RATE, TWICE, None), (4.0, 4.1))
    with pytest.raises(BandNotObservable, match="s; a band of 15 Hz needs"):
        short.band(5, 20)
    # Two periods of 5 Hz, the lowest edge, at 20 m/s are 8 m; the record begins 4 m before the section.
    assert edge_warnings({1: read(force, TWICE)}, 20.0) != []
    assert edge_warnings({1: read(force, Filter())}, 20.0) == []
