"""Count of the spectral lines in the half-power bands."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.exact_decays import RATE, RELEASE, build_exact_decay
from pantocheck.conformance.drops.identification_analysis import (
    compute_spectrogram,
    count_half_power_lines,
    describe_search,
)
from pantocheck.conformance.drops.identify import PoleSearch
from pantocheck.conformance.drops.start_poles import BandTrials
from pantocheck.conformance.results.identified_modes import Mode

PAPER = Mode(frequency_Hz=0.9, damping_ratio=0.005, damping_ratio_std=1e-6, sensor_shape=(), half_power_points=1.08)
"""Mode in a record of 120 s."""
MANY = PAPER.model_copy(update={"frequency_Hz": 9.0, "half_power_points": 10.8})


def test_needed_duration_is_that_of_the_paper() -> None:
    """0.5 % at 0.9 Hz needs 5 / (2 * 0.005 * 0.9) = 555.6 s; Vo Van, Balmes and Lorang print 555 s."""
    counts = count_half_power_lines((PAPER, MANY))
    assert (counts.recommended, counts.modes, counts.fewer) == (5, 2, 1)
    assert counts.needed_s == pytest.approx(555.6, abs=0.05)


@pytest.mark.parametrize("caveat", [{"certain": False}, {"lateral": True}])
def test_doubtful_modes_do_not_determine_the_duration(caveat: dict[str, bool]) -> None:
    doubtful = PAPER.model_copy(update={"damping_ratio": 1e-5, **caveat})
    assert count_half_power_lines((PAPER, doubtful)).needed_s == pytest.approx(555.6, abs=0.05)
    assert count_half_power_lines((doubtful,)).needed_s is None


# Spectrogram of a record whose content is known in time and frequency.
SLOW, FAST = 2.0, 12.0
"""Frequencies of a tone over the whole record and of one in the first two seconds [Hz]; both are spectral lines."""


def test_tones_appear_at_their_times_and_frequencies() -> None:
    """A tone has 0 dB at its line, and a Hann window leaves nothing three lines away. The fast tone ends after 2 s."""
    # The second channel moves most and is shown. Only windows without a step of the signal are compared.
    decay = build_exact_decay(np.array([-0.1 + 6j]), np.array([[1e-3, 2e-3]], dtype=complex), duration=80.0)
    t = np.arange(decay.record.signals.shape[0]) / RATE - RELEASE
    tones = np.sin(2 * np.pi * SLOW * t) + np.where((t > 0) & (t < 2.0), np.sin(2 * np.pi * FAST * t), 0.0)
    signals = np.column_stack([np.zeros_like(t), tones + 0.5])
    spectrogram = compute_spectrogram(replace(decay, record=replace(decay.record, signals=signals)))
    assert (spectrogram.record, spectrogram.channel) == ("exact", "S2_z")
    for part, window in ((spectrogram.whole, 4.0), (spectrogram.start, 1.0)):
        time, frequency, levels = np.array(part.time_s), np.array(part.frequency_Hz), np.array(part.level_dB)
        assert levels.shape == (time.size, frequency.size)
        assert frequency[-1] == 20.0
        assert time[0] - window / 2 >= -RELEASE - 1e-6
        after = levels[time > 2.0 + window / 2]
        slow = int(np.argmin(np.abs(frequency - SLOW)))
        assert after[:, slow].min() >= -1
        assert after[:, slow + 3 :].max() <= -50
    time, frequency, levels = (np.array(v) for v in (part.time_s, part.frequency_Hz, part.level_dB))
    during = (time > 0.5) & (time < 1.5)
    assert levels[during][:, int(np.argmin(np.abs(frequency - FAST)))].min() >= -1
    assert levels[~during & (time < -0.5)][:, frequency > 5].max() <= -50


# Description of the search for the model order.
def pole(frequency: float, ratio: float) -> complex:
    """Pole of a frequency [Hz] and a damping ratio [1/s]."""
    return 2 * np.pi * frequency * complex(-ratio, np.sqrt(1 - ratio**2))


def test_pole_is_stable_if_frequency_and_damping_stay() -> None:
    """Limits of 0.1 % and 10 %. At the first order no pole is stable."""
    orders = (
        [pole(1.0, 0.005)],
        [pole(1.0009, 0.0054), pole(1.2, 0.004)],  # both within the limits; new
        [],
        [pole(1.0, 0.005), pole(1.2, 0.004)],  # none at the order before
        [pole(1.0012, 0.005), pole(1.2, 0.0045)],  # frequency beyond its limit, damping beyond its limit
    )
    trials = (BandTrials(0.8, 1.4, tuple(np.array(poles, dtype=complex) for poles in orders), 2),)
    (band,) = describe_search(PoleSearch(trials)).bands
    assert (band.from_Hz, band.to_Hz, band.selected_order) == (0.8, 1.4, 2)
    assert band.order == (1, 2, 2, 4, 4, 5, 5)
    np.testing.assert_allclose(band.frequency_Hz, [1.0, 1.0009, 1.2, 1.0, 1.2, 1.0012, 1.2], rtol=1e-5)
    assert band.stable == (False, True, False, False, False, False, False)


def test_steps_keep_their_order_and_long_records_their_columns() -> None:
    first, second = np.array([pole(1.0, 0.005)]), np.array([pole(1.0, 0.005), pole(2.0, 0.01)])
    search = describe_search(PoleSearch((), (("start poles", first), ("refined", second))))
    assert [(step.name, len(step.frequency_Hz)) for step in search.steps] == [("start poles", 1), ("refined", 2)]
    np.testing.assert_allclose(search.steps[1].frequency_Hz, [1.0, 2.0])
    assert search.bands == ()
    # About 120 columns, so that the file stays small: steps of whole seconds.
    decay = build_exact_decay(np.array([-0.1 + 6j]), np.array([[1.0]], dtype=complex), duration=240.0)
    assert np.ptp(np.diff(compute_spectrogram(decay).whole.time_s)) < 1e-6
    assert 60 <= len(compute_spectrogram(decay).whole.time_s) <= 120
