"""Usable parts of a measured record: without gaps, at the nominal speed, evenly sampled."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.line_signals import SUPPORT_TOLERANCE_M, supports_inside
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, complete_samples
from pantocheck.conformance.records.source_alignment import GAP_STEPS

SHORT_GAP_S = 0.01
"""Longest gap that is interpolated [s]: a fifth of a period at 20 Hz, too short to hide content below 20 Hz."""

SHORTEST_S = 1.0
"""Shortest usable part [s]: its lowest band, 0-5 Hz, then has a few spectral lines."""

MOST_BACK_M = SUPPORT_TOLERANCE_M
"""Largest fall of a noisy position that is smoothed [m]; a train that runs back further is not graded."""

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
    front_strip: RealArray | None = None
    """Contact force of the front strip, (n,) [N], or None."""
    arcs: RealArray | None = None
    """Arcs, and time under load, as 1, 0 or NaN, (2, n); None without an arc detector."""


def local_speed(time: RealArray, position: RealArray) -> RealArray:
    """Speed of the train at each sample, averaged over about a second, also at the ends [m/s]."""
    width = min(2 * max(1, round(SPEED_AVERAGED_S / 2 / float(np.median(np.diff(time))))), time.size - 1)
    begin = np.clip(np.arange(time.size) - width // 2, 0, time.size - 1 - width)
    return np.asarray((position[begin + width] - position[begin]) / (time[begin + width] - time[begin]))


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
        section: Channels as recorded; a height or a force of a strip with missing values is dropped.
        rate: Sampling rate of the result [Hz].

    Returns:
        Section with uniform sampling.
    """
    height, front = (
        None if values is None or not np.isfinite(values).all() else values
        for values in (section.height, section.front_strip)
    )
    uniform = np.linspace(time[0], time[-1], time.size)
    if np.abs(time - uniform).max() <= 0.01 / rate and abs((time.size - 1) / (time[-1] - time[0]) / rate - 1) < 1e-3:
        return UsableSection(section.position, section.force, height, front, section.arcs)
    even = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * rate * (1 + 1e-12))) + 1) / rate
    even[-1] = min(even[-1], time[-1])

    def interpolate(values: RealArray) -> RealArray:
        return np.asarray(scipy.interpolate.PchipInterpolator(time, values)(even))

    nearest = np.clip(np.searchsorted((time[1:] + time[:-1]) / 2, even), 0, time.size - 1)
    return UsableSection(
        interpolate(section.position),
        interpolate(section.force),
        None if height is None else interpolate(height),
        None if front is None else interpolate(front),
        None if section.arcs is None else section.arcs[:, nearest],
    )


# Time and position of each sample of a measured record.
@dataclass(frozen=True)
class PlacedSamples:
    """Samples with their time and position, both increasing."""

    samples: RecordSamples
    """Samples with time and position."""
    time: RealArray
    """Time of each sample, (n,) [s]."""
    position: RealArray
    """Position of each pantograph along the track, (p, n) [m]."""
    warnings: tuple[str, ...]
    """Notes on discarded samples."""


def place_samples(samples: RecordSamples, sidecar: RecordSidecar) -> PlacedSamples:
    """Determine time and position of the samples; samples without them are discarded.

    Returns:
        Remaining samples with time and position.

    Raises:
        RecordInvalid: Time or position decreases, or fewer than two samples have both.
    """
    warnings = []
    axes = [axis for axis in (samples.time, samples.speed, samples.position) if axis is not None]
    known = np.all([np.isfinite(np.atleast_2d(axis)).all(axis=0) for axis in axes], axis=0)
    if known.sum() < 2:
        raise RecordInvalid("time", "fewer than two samples have a time or position")
    if not known.all():
        warnings.append(f"{format_share(~known)} of the samples were discarded: they have no time or no position")
        samples = samples.select(known)
    if samples.time is None and samples.speed is not None and not (samples.speed > 0).all():
        warnings.append(f"{format_share(samples.speed <= 0)} of the samples were discarded: the train stands still")
        samples = samples.select(samples.speed > 0)
    if samples.force.shape[1] < 2:
        raise RecordInvalid("speed", "fewer than two samples have a positive speed")
    time, position = complete_samples(samples, sidecar)
    if samples.time is not None:
        position, fall = _smooth_noise(position)
        if fall:
            warnings.append(f"the position runs back by up to {fall:.2g} m; it was smoothed")
        samples, time, position = _smooth_steps(samples, time, position)
    for name, axis in (("time", time[None]), ("position", position)):
        backwards = np.argwhere(np.diff(axis, axis=1).T <= 0)
        if backwards.size:
            first = backwards[0][0] + 1
            raise RecordInvalid(
                name,
                f"the value of sample {first + 1} is not greater than that of sample {first}"
                + ("" if name == "time" else f" (noise of {MOST_BACK_M:g} m is smoothed); cut it, or use speed_m_s"),
            )
    return PlacedSamples(samples, time, position, tuple(warnings))


def _smooth_noise(position: RealArray) -> tuple[RealArray, float]:
    """Increasing positions midway between the largest value so far and the smallest one to come, and the largest fall.

    A fall [m] of more than `MOST_BACK_M` remains.
    """
    ahead = np.maximum.accumulate(position, axis=1)
    fall = float((ahead - position).max())
    if not 0 < fall <= MOST_BACK_M:
        return position, 0.0
    return (ahead + np.minimum.accumulate(position[:, ::-1], axis=1)[:, ::-1]) / 2, fall


def _smooth_steps(
    samples: RecordSamples, time: RealArray, position: RealArray
) -> tuple[RecordSamples, RealArray, RealArray]:
    """Interpolate positions of a wheel-pulse counter, which are constant for some samples between two steps."""
    stepped = np.diff(position[0], prepend=-np.inf) > 0
    if stepped.all() or (np.diff(position, axis=1) < 0).any() or stepped.sum() < 2:
        return samples, time, position
    # The position after the last step is unknown.
    within = np.arange(time.size) <= np.flatnonzero(stepped)[-1]
    smooth = np.vstack([np.interp(time[within], time[stepped], row[stepped]) for row in position])
    return samples.select(within), time[within], smooth


def format_share(mask: NDArray[np.bool_]) -> str:
    """Share of the samples in a mask as text."""
    return f"{100 * mask.mean():.2g} %"


# Supports of a measured line, from the positions and the span length in its record.
def list_line_supports(
    listed: Sequence[float], span_m: float | None, section: tuple[float, float]
) -> tuple[float, ...] | None:
    """Positions of the supports of a section: the listed ones, and one more where their distance exceeds a span.

    Args:
        listed: Positions of the supports in the record [m].
        span_m: Length of the longest span [m]; None if it is not known.
        section: Start and end of the analysis section [m].

    Returns:
        Positions in increasing order [m]; None if the span length is not known.
    """
    if span_m is None:
        return None
    positions = np.unique(np.asarray(listed, dtype=np.float64))
    inside = [float(position) for position in positions[supports_inside(positions, section)]]
    return tuple(sorted((*inside, *_missing_supports(inside, span_m, section)))) if inside else ()


def _missing_supports(inside: list[float], span_m: float, section: tuple[float, float]) -> Iterator[float]:
    start, end = section
    yield from (inside[0] - span_m * (i + 1) for i in range(_spans(inside[0] - start, span_m)))
    yield from (inside[-1] + span_m * (i + 1) for i in range(_spans(end - inside[-1], span_m)))
    for left, right in pairwise(inside):
        spans = int(np.ceil((right - left - SUPPORT_TOLERANCE_M) / span_m))
        yield from (left + (right - left) * i / spans for i in range(1, spans))


def _spans(distance: float, span_m: float) -> int:
    """Number of whole spans in a distance [m]; a support at the section limit belongs to the section."""
    return max(0, int((distance + SUPPORT_TOLERANCE_M) // span_m))
