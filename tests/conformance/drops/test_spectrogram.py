"""Spectrogram of a record whose content is known in time and frequency."""

from dataclasses import replace

import numpy as np

from helpers.exact_decays import RATE, RELEASE, build_exact_decay
from pantocheck.conformance.drops.identification_analysis import compute_spectrogram

SLOW, FAST = 2.0, 12.0
"""Frequencies of a tone over the whole record and of one in the first two seconds [Hz]; both are spectral lines."""


def test_tones_appear_at_their_times_and_frequencies() -> None:
    """A tone has 0 dB at its line, and a Hann window leaves nothing three lines away. The fast tone ends after 2 s.

    The second channel moves most and is shown. Only windows without a step of the signal are compared.
    """
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


def test_long_records_have_no_more_columns() -> None:
    """About 120 columns, so that the file stays small: steps of whole seconds."""
    decay = build_exact_decay(np.array([-0.1 + 6j]), np.array([[1.0]], dtype=complex), duration=240.0)
    assert np.ptp(np.diff(compute_spectrogram(decay).whole.time_s)) < 1e-6
    assert 60 <= len(compute_spectrogram(decay).whole.time_s) <= 120
