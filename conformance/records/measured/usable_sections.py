"""Usable parts of a measured record: without gaps, at the nominal speed, evenly sampled."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import uniform_filter1d

from pantocheck.conformance.array_types import RealArray

SHORT_GAP_S = 0.01
"""Longest gap that is interpolated [s]: a fifth of a period at 20 Hz, too short to hide content below 20 Hz."""

GAP_STEPS = 1.5
"""Smallest gap between two samples, over the median sampling interval [-]."""

SHORTEST_S = 1.0
"""Shortest usable part [s]: its lowest band, 0-5 Hz, then has a few spectral lines."""

SPEED_AVERAGED_S = 1.0
"""Averaging time of the speed [s], so that noise of a position sensor does not appear as a change of speed."""


@dataclass(frozen=True)
class UsableSection:
    """Evenly sampled section of the record of one pantograph."""

    position: RealArray
    """Contact point along the track, (n,) [m]."""
    force: RealArray
    """Contact force, (n,) [N]."""
    height: RealArray | None
    """Height of the contact point, (n,) [m], or None."""
    arcs: RealArray | None = None
    """Arcs, and time under load, as 1, 0 or NaN, (2, n); None without an arc detector."""


def local_speed(time: RealArray, position: RealArray) -> RealArray:
    """Speed of the train at each sample, averaged over about a second [m/s]."""
    speed = np.gradient(position, time)
    width = max(1, round(SPEED_AVERAGED_S / float(np.median(np.diff(time)))))
    return np.asarray(uniform_filter1d(speed, min(width, speed.size), mode="nearest"))


def find_usable_sections(time: RealArray, usable: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Find the sections of usable samples between gaps; gaps of up to `SHORT_GAP_S` are ignored.

    Args:
        time: Increasing time, (n,) [s].
        usable: Whether each sample may be evaluated, (n,).

    Returns:
        Indices of the samples of each section that lasts at least `SHORTEST_S`.
    """
    indices = np.flatnonzero(usable)
    if indices.size == 0:
        return []
    step = float(np.median(np.diff(time)))
    longest = max(GAP_STEPS * step, SHORT_GAP_S + step)
    breaks = np.flatnonzero(np.diff(time[indices]) > longest)
    sections = np.split(indices, breaks + 1)
    return [section for section in sections if time[section[-1]] - time[section[0]] >= SHORTEST_S]


def resample_section(time: RealArray, section: UsableSection, rate: float) -> UsableSection:
    """Resample a section to a uniform time axis.

    Evenly spaced samples remain unchanged. Others are interpolated by monotone cubics, which do not overshoot: contact
    losses remain, and no new extremes appear.

    Args:
        time: Time of the samples, (n,) [s].
        section: Channels as recorded; a height with missing values is dropped.
        rate: Sampling rate of the result [Hz].

    Returns:
        Section with uniform sampling.
    """
    height = section.height
    if height is not None and not np.isfinite(height).all():
        height = None
    uniform = np.linspace(time[0], time[-1], time.size)
    if np.abs(time - uniform).max() <= 0.01 / rate and abs((time.size - 1) / (time[-1] - time[0]) / rate - 1) < 1e-3:
        return UsableSection(section.position, section.force, height, section.arcs)
    even = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * rate * (1 + 1e-12))) + 1) / rate
    even[-1] = min(even[-1], time[-1])

    def interpolate(values: RealArray) -> RealArray:
        return np.asarray(PchipInterpolator(time, values)(even))

    nearest = np.clip(np.searchsorted((time[1:] + time[:-1]) / 2, even), 0, time.size - 1)
    return UsableSection(
        interpolate(section.position),
        interpolate(section.force),
        None if height is None else interpolate(height),
        None if section.arcs is None else section.arcs[:, nearest],
    )
