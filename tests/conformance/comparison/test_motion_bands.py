"""Motion in frequency bands: derivatives, integrals, advance, power shared out by the bands, and noise."""

import numpy as np
import pytest

from pantocheck.conformance.comparison.drop_motion import (
    MOTION_BANDS,
    TAPER_S,
    MotionBand,
    band_gain,
    filter_motion,
    noise_rms,
)

RATE = 200.0
TIME = np.arange(0, 20, 1 / RATE)
BAND = MotionBand(1.0, 20.0)
ENVELOPE = np.exp(-(((TIME - 9) / 2.5) ** 2))
"""Rest at both ends; its own spectrum is narrower than a crossfade."""
INNER = slice(0, round((20 - TAPER_S) * RATE))


def wave(frequency: float, phase: float = 0.0) -> np.ndarray:
    """Packet of a wave at one place, (n, 1)."""
    return (ENVELOPE * np.cos(2 * np.pi * frequency * TIME + phase))[:, None]


@pytest.mark.parametrize(("derivatives", "phase"), [(-1, -np.pi / 2), (0, 0.0), (1, np.pi / 2), (2, np.pi)])
def test_motion_is_differentiated_and_integrated(derivatives: int, phase: float) -> None:
    """A slow envelope changes the amplitude by the ratio of its rate to the frequency, 1 / (2.5 * 2 pi * 5)."""
    filtered = filter_motion(wave(5.0), RATE, derivatives, BAND)[INNER]
    expected = (2 * np.pi * 5.0) ** derivatives * wave(5.0, phase)[INNER]
    assert np.abs(filtered - expected).max() < 0.025 * np.abs(expected).max()


def test_motion_is_advanced_by_a_part_of_a_sample() -> None:
    """A phase of 2 pi f times the advance; 3 ms are 0.6 samples."""
    advanced = filter_motion(wave(5.0), RATE, 0, BAND, 0.003)[INNER]
    expected = wave(5.0, 2 * np.pi * 5.0 * 0.003)[INNER]
    assert np.abs(advanced - expected).max() < 2e-3


def test_neighbouring_bands_share_out_the_power() -> None:
    frequency = np.linspace(0.6, 40, 500)
    low, middle, high, _ = MOTION_BANDS
    power = sum(band_gain(frequency, band) ** 2 for band in (low, middle, high))
    assert power == pytest.approx(1.0, abs=1e-12)
    assert band_gain(np.array([0.1, 5.6]), low) == pytest.approx([0.0, 0.0])
    assert band_gain(np.array([5.0]), low) == pytest.approx([np.sqrt(0.5)])


def test_end_of_a_cut_decay_does_not_reach_its_start() -> None:
    """A constant acceleration from 10 s on: the lower crossfade, 0.3 Hz wide, rings for some of its periods of 3 s."""
    step = np.where(TIME >= 10, 1.0, 0.0)[:, None]
    filtered = filter_motion(step, RATE, 0, MOTION_BANDS[0])
    assert np.abs(filtered[TIME < 4]).max() < 0.01


def test_last_second_is_faded() -> None:
    """A constant in a band without edges: half a period of a cosine, from 1 to 0."""
    filtered = filter_motion(np.cos(2 * np.pi * 5.0 * TIME)[:, None], RATE, 0, BAND)[:, 0]
    fade = (1 + np.cos(np.pi * (TIME - TIME[-1] + TAPER_S) / TAPER_S)) / 2
    last = TIME[-1] - TAPER_S < TIME
    np.testing.assert_allclose(filtered[last], (fade * np.cos(2 * np.pi * 5.0 * TIME))[last], rtol=0, atol=0.03)


def test_noise_at_rest_has_the_share_of_the_band() -> None:
    """White noise: its power is spread over half the rate; 30 s give an estimate within some percent."""
    rest = 0.01 * np.random.default_rng(0).standard_normal((round(30 * RATE), 1))
    expected = 0.01 * np.sqrt((20.0 - 1.0) / (RATE / 2))
    assert noise_rms(rest, RATE, 0, BAND) == pytest.approx([expected], rel=0.05)
    high, low = MotionBand(20.0, 50.0), MotionBand(1.0, 5.0)
    assert noise_rms(rest, RATE, -1, high)[0] < noise_rms(rest, RATE, -1, low)[0]
