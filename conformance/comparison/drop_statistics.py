"""Agreement of the models of a drop with its record: RMS and correlation by window and band, and residual energy."""

from typing import get_args

import numpy as np

from pantocheck.conformance.comparison.comparison_limits import TimeWindow
from pantocheck.conformance.comparison.drop_motion import GRAPHIC_BAND, DropMotion, MotionBand
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.criterion import ComparedMotion
from pantocheck.conformance.drops.repeatability import round_curve
from pantocheck.conformance.results.drop_comparison_format import (
    EnergyCurve,
    ModelAgreement,
    MotionCurve,
    WindowStatistics,
)

LARGEST_NOISE = 0.3
"""Largest RMS of the noise over that of the record for which ratio and correlation are stated [-]."""

ENERGY_WINDOW_S = 2.0
"""Length of the windows of the residual energy [s]: about two periods of the lowest mode."""

CURVE_RATE_HZ = 100.0
"""Largest rate of drawn curves [Hz]: five samples per period of the highest drawn frequency."""

COMPARED_MOTIONS: tuple[ComparedMotion, ...] = get_args(ComparedMotion)


def compute_statistics(
    motion: DropMotion, places: tuple[str, ...], windows: tuple[TimeWindow, ...], bands: tuple[MotionBand, ...]
) -> tuple[WindowStatistics, ...]:
    """Compute RMS, ratio and correlation of every place, motion, window and band.

    Args:
        motion: Motion of record and models.
        places: Names of the columns of the models; those of the record come first.
        windows: Windows after the release that the record contains [s].
        bands: Frequency bands.

    Returns:
        One row per place, motion, window and band.
    """
    rows = []
    for kind in COMPARED_MOTIONS:
        for band in bands:
            record, noise = motion.filter_record(kind, band), motion.noise(kind, band)
            models = {name: motion.filter_model(name, kind, band) for name in motion.models}
            for window in windows:
                inside = select_window(motion, window)
                for c, place in enumerate(places):
                    measured = record[inside, c] if c < record.shape[1] else None
                    floor = None if measured is None or noise is None else float(noise[c])
                    row = WindowStatistics(
                        place=place,
                        motion=kind,
                        window_s=window,
                        band_Hz=band,
                        record_rms=None if measured is None else _remove_noise(measured, floor or 0.0),
                        noise_rms=floor,
                        models=(),
                    )
                    agreements = tuple(_compare_model(name, m[inside, c], measured, row) for name, m in models.items())
                    rows.append(row.model_copy(update={"models": agreements}))
    return tuple(rows)


def is_mostly_noise(statistics: WindowStatistics) -> bool:
    """Whether the known noise of a record is so large that ratio and correlation state little."""
    clean, noise = statistics.record_rms, statistics.noise_rms
    return clean is not None and noise is not None and noise > LARGEST_NOISE * float(np.hypot(clean, noise))


def select_window(motion: DropMotion, window: TimeWindow) -> IntegerArray:
    """Indices of the samples inside a window."""
    return np.flatnonzero((motion.time >= window[0] - 1e-9) & (motion.time < window[1] - 1e-9))


def compute_energies(motion: DropMotion, places: tuple[str, ...]) -> tuple[EnergyCurve, ...]:
    """Compute the mean square of the velocity in windows of `ENERGY_WINDOW_S` at every place."""
    record = motion.filter_record("velocity", GRAPHIC_BAND)
    models = {name: motion.filter_model(name, "velocity", GRAPHIC_BAND) for name in motion.models}
    count = int((motion.end + 1e-9) // ENERGY_WINDOW_S)
    width = round(ENERGY_WINDOW_S * motion.rate)

    def average(signal: RealArray) -> tuple[float, ...]:
        squares = signal[motion.lead : motion.lead + count * width] ** 2
        return tuple(round_curve(squares.reshape(count, width).mean(axis=1)))

    return tuple(
        EnergyCurve(
            place=place,
            time_s=tuple(ENERGY_WINDOW_S * (k + 0.5) for k in range(count)),
            record=average(record[:, c]) if c < record.shape[1] else None,
            models={name: average(values[:, c]) for name, values in models.items()},
            differences={name: average(values[:, c] - record[:, c]) for name, values in models.items()}
            if c < record.shape[1]
            else {},
        )
        for c, place in enumerate(places)
    )


def sample_curves(
    motion: DropMotion, places: tuple[str, ...], windows: tuple[TimeWindow, ...]
) -> tuple[MotionCurve, ...]:
    """Curves of velocity and acceleration below 20 Hz in every window."""
    step = max(1, int(motion.rate / CURVE_RATE_HZ))
    curves = []
    for kind in COMPARED_MOTIONS:
        record = motion.filter_record(kind, GRAPHIC_BAND)
        models = {name: motion.filter_model(name, kind, GRAPHIC_BAND) for name in motion.models}
        for window in windows:
            index = select_window(motion, window)[::step]
            curves += [
                MotionCurve(
                    place=place,
                    motion=kind,
                    window_s=window,
                    time_s=tuple(round_curve(motion.time[index])),
                    record=tuple(round_curve(record[index, c])) if c < record.shape[1] else None,
                    models={name: tuple(round_curve(values[index, c])) for name, values in models.items()},
                )
                for c, place in enumerate(places)
            ]
    return tuple(curves)


def _remove_noise(signal: RealArray, noise: float) -> float:
    """RMS of a signal without its noise; 0 if the noise explains all of it."""
    return float(np.sqrt(max(float(np.mean(signal**2)) - noise**2, 0.0)))


def _compare_model(
    name: str, model: RealArray, record: RealArray | None, statistics: WindowStatistics
) -> ModelAgreement:
    rms, clean = float(np.sqrt(np.mean(model**2))), statistics.record_rms
    if record is None or not clean or is_mostly_noise(statistics):
        return ModelAgreement(model=name, rms=rms, rms_ratio=None, correlation=None)
    correlation = float(np.mean(model * record)) / (float(np.sqrt(np.mean(record**2))) * rms) if rms > 0 else 0.0
    return ModelAgreement(model=name, rms=rms, rms_ratio=rms / clean, correlation=correlation)
