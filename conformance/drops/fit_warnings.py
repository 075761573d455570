"""Warnings on a fit: ambient motion, a residual above the noise, and decays of different lengths."""

import numpy as np

from pantocheck.conformance.drops.line_fit import SAME_LENGTH, LineFit, measure_ambient_motion

SHARED_POLES = 1.5
"""Misfit above which a warning names the band and the sensor with the largest residual [-]."""
CLEAR_MOTION = 0.5
"""Ambient motion over sensor noise, from which on the motion is named as the cause [-]."""


def list_fit_warnings(fit: LineFit) -> tuple[str, ...]:
    """Caveats of the records of a fit, its ambient motion, its residual, and different lengths of its decays."""
    warnings = [text for record in fit.records for text in record.decay.warnings]
    if ambient := measure_ambient_motion(fit, fit.band.low, fit.band.high):
        warnings.append(_describe_ambient(fit, *ambient))
    if fit.misfit > SHARED_POLES:
        warnings.append(_describe_misfit(fit))
    lengths = [record.decay.linear.duration for record in fit.records]
    if max(lengths) > (1 + SAME_LENGTH) * min(lengths):
        durations = ", ".join(f"{length:.0f} s" for length in lengths)
        warnings.append(f"the linear decays differ in length ({durations}); each is used over its whole length")
    return tuple(dict.fromkeys(warnings))


def _describe_ambient(fit: LineFit, ambient: float, noise: float) -> str:
    """Sentence on the ambient motion and the noise of the sensors [unit of the record]."""
    unit = {"acceleration": "mm/s2", "velocity": "mm/s", "displacement": "mm"}[fit.records[0].decay.record.quantity]
    levels = f"{1e3 * ambient:.2g} {unit} RMS, beside {1e3 * noise:.2g} {unit} of sensor noise in the same band"
    if ambient < CLEAR_MOTION * noise:
        return f"the noise is not white: coloured, or the line moved by up to {levels}; the intervals contain it"
    return (
        f"the line moved by itself during the records, as in light wind: {levels}. The intervals of frequency and "
        "damping contain this motion, and are wider than in calm air"
    )


def _describe_misfit(fit: LineFit) -> str:
    """Sentence on the band and the sensor with the largest residual."""
    bands: dict[int, list[float]] = {}
    sensors: dict[str, list[float]] = {}
    for record in fit.records:
        energy = np.abs(record.block.white_residual[:, record.columns]) ** 2 / 2
        for band in range(int(fit.band.low), int(fit.band.fitted) + 1):
            inside = np.floor(record.block.data.omega / (2 * np.pi)) == band
            bands.setdefault(band, []).extend(energy[inside].mean(axis=1) if inside.any() else ())
        for name, column in zip(record.decay.channel_names, energy.T, strict=True):
            sensors.setdefault(name, []).append(float(column.mean()))
    band = max(bands, key=lambda number: float(np.mean(bands[number] or [0.0])))
    sensor = max(sensors, key=lambda name: float(np.mean(sensors[name])))
    return (
        f"the squared residual of the fit is {fit.misfit:.1f} times that of the noise: "
        f"{np.mean(bands[band]):.1f} times from {band} to {band + 1} Hz, and {np.mean(sensors[sensor]):.1f} times at "
        f"channel {sensor}; uncertainties are increased"
    )
