"""Stretches of a measured record that can be evaluated: without gaps, at the speed of the case, evenly sampled."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import uniform_filter1d

from pantocheck.conformance.array_types import RealArray

SHORT_GAP_S = 0.01
"""A gap up to this long [s] is bridged: a fifth of a period at 20 Hz cannot hide anything below that."""

GAP_STEPS = 1.5
"""Samples farther apart than this many median steps have a gap between them."""

SHORTEST_S = 1.0
"""A stretch must last this long [s]: its lowest band, 0-5 Hz, then holds a few spectral lines."""

SPEED_AVERAGED_S = 1.0
"""Speed is averaged over this long [s], so that the jitter of a position sensor is not taken for a change of speed."""


@dataclass(frozen=True)
class UsableSection:
    """A part of one pantograph's record, evenly sampled.

    Parameters
    ----------
    position : (n,) ndarray
        Contact point along the track [m].
    force : (n,) ndarray
        [N].
    height : (n,) ndarray or None
        Height of the contact point [m], or None.
    """

    position: RealArray
    force: RealArray
    height: RealArray | None


def local_speed(time: RealArray, position: RealArray) -> RealArray:
    """Speed of the train at each sample, averaged over about a second [m/s]."""
    speed = np.gradient(position, time)
    width = max(1, round(SPEED_AVERAGED_S / float(np.median(np.diff(time)))))
    return np.asarray(uniform_filter1d(speed, min(width, speed.size), mode="nearest"))


def find_usable_sections(time: RealArray, usable: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Indices of the usable samples between each two gaps; a gap of up to `SHORT_GAP_S` is no gap.

    Parameters
    ----------
    time : (n,) ndarray
        Increasing [s].
    usable : (n,) ndarray
        Whether a sample may be evaluated.
    """
    chosen = np.flatnonzero(usable)
    if chosen.size == 0:
        return []
    step = float(np.median(np.diff(time)))
    longest = max(GAP_STEPS * step, SHORT_GAP_S + step)
    breaks = np.flatnonzero(np.diff(time[chosen]) > longest)
    return [run for run in np.split(chosen, breaks + 1) if time[run[-1]] - time[run[0]] >= SHORTEST_S]


def cut_section(
    run: NDArray[np.intp], time: RealArray, position: RealArray, force: RealArray, height: RealArray | None, rate: float
) -> UsableSection:
    """The samples of a run on a uniform time axis.

    Samples that are evenly spaced are taken as they are. Others are interpolated by monotone cubics, which do not
    overshoot: a loss of contact stays one, and no extreme is made that was not recorded.

    Parameters
    ----------
    run : ndarray
        Indices of the samples.
    time, position, force, height : (n,) ndarray or ndarray or None
        Of one pantograph [s, m, N, m].
    rate : float
        Samples per second of the result [Hz].
    """
    at, height = time[run], None if height is None or not np.isfinite(height[run]).all() else height[run]
    uniform = np.linspace(at[0], at[-1], at.size)
    if np.abs(at - uniform).max() <= 0.01 / rate and abs((at.size - 1) / (at[-1] - at[0]) / rate - 1) < 1e-3:
        return UsableSection(position[run], force[run], height)
    even = at[0] + np.arange(int(np.floor((at[-1] - at[0]) * rate * (1 + 1e-12))) + 1) / rate
    even[-1] = min(even[-1], at[-1])

    def resampled(values: RealArray) -> RealArray:
        return np.asarray(PchipInterpolator(at, values)(even))

    return UsableSection(resampled(position[run]), resampled(force[run]), None if height is None else resampled(height))
