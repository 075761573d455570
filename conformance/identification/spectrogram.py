"""Spectrogram of a record: amplitude over time and frequency, over the whole record and around the release."""

from math import ceil

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.decay_preparation import PreparedDecay
from pantocheck.conformance.identification.identification_format import Spectrogram, SpectrogramPart
from pantocheck.conformance.identification.repeatability import round_curve

HIGHEST_SHOWN = 20.0
"""Highest frequency [Hz]: slack droppers excite the line above the band of the reported modes."""

LOWEST_LEVEL = -60
"""Lowest level [dB]; the level of the largest amplitude is 0 dB."""

WHOLE_WINDOW, WHOLE_COLUMNS = 4.0, 120
"""Window over the whole record [s], which separates the groups of span modes, and about the number of its columns."""

START_WINDOW, START_STEP, START_SPAN = 1.0, 0.1, (-2.0, 8.0)
"""Window and step around the release, and its range after the release [s]: slack droppers become taut in seconds."""


def compute_spectrogram(decay: PreparedDecay) -> Spectrogram:
    """Spectrogram of the channel with the largest motion."""
    record, release = decay.record, decay.release.time
    signals = record.signals[:, list(decay.columns)]
    column = int(np.argmax(signals.std(axis=0)))
    signal = np.asarray(signals[:, column] - np.median(signals[:, column]))
    begin, end = (round((release + t) * record.rate) for t in START_SPAN)
    whole_step = ceil(record.duration / WHOLE_COLUMNS)
    return Spectrogram(
        record=record.name,
        channel=decay.channel_names[column],
        whole=_transform(signal, record.rate, WHOLE_WINDOW, whole_step, -release),
        start=_transform(
            signal[max(begin, 0) : end], record.rate, START_WINDOW, START_STEP, max(begin, 0) / record.rate - release
        ),
    )


def _transform(signal: RealArray, rate: float, window: float, step: float, first: float) -> SpectrogramPart:
    """Levels in windows (Hann) of a length at steps [s]; `first` is the time of the first sample [s]."""
    length = max(round(window * rate), 4)
    frames = np.lib.stride_tricks.sliding_window_view(signal, length)[:: max(round(step * rate), 1)]
    frequency = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=np.float64)
    shown = frequency <= min(HIGHEST_SHOWN, 0.45 * rate)
    amplitude = np.abs(np.fft.rfft(frames * np.hanning(length), axis=1))[:, shown]
    largest = max(float(amplitude.max(initial=0.0)), np.finfo(float).tiny)
    levels = 20 * np.log10(np.maximum(amplitude / largest, 10 ** (LOWEST_LEVEL / 20)))
    samples = np.arange(frames.shape[0], dtype=np.float64) * max(round(step * rate), 1)
    return SpectrogramPart(
        window_s=window,
        time_s=round_curve(first + (samples + length / 2) / rate),
        frequency_Hz=round_curve(frequency[shown]),
        level_dB=tuple(tuple(int(level) for level in row) for row in np.rint(levels)),
    )
