"""Curves for the figures of a run: short, rounded series, so that pages stay small and their bytes reproducible."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Histogram, Spectrum, Traces, UpliftTrace
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.quantities.bands import amplitude_spectrum
from pantocheck.conformance.quantities.line_signals import LineSignals, supports_inside
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.statistics import force_histogram
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable

MAX_POINTS = 1500
"""Approximate number of points in a curve."""

LONG_STEP = 10
"""Up to this ratio of samples to points, every k-th sample shows the force well enough."""


def build_pantograph_traces(
    pantographs: Mapping[int, PantographSignals], supports: Sequence[float]
) -> dict[str, Traces]:
    """Force, spectrum and histogram of every pantograph that covers the analysis section.

    Args:
        pantographs: Signals of the pantographs by number from 1.
        supports: Positions of the supports of the line [m].
    """
    traces = {}
    for number, pantograph in pantographs.items():
        try:
            position = pantograph.position[pantograph.inside]
        except QuantityUnavailable:
            continue
        within = _select_supports(supports, pantograph.section)
        traces[str(number)] = _build_traces(pantograph, position, within)
    return traces


def build_uplift_traces(line: LineSignals, time: RealArray) -> list[UpliftTrace]:
    """Uplift at every support of the analysis section, over the whole record where it is known.

    Args:
        line: Uplift at the supports.
        time: Times of the record, (n,) [s].
    """
    try:
        supports, uplift = line.supports, line.uplift
    except QuantityUnavailable:
        return []
    return [
        UpliftTrace(
            support_m=float(x),
            time_s=thin_series(time[known]),
            uplift_mm=thin_series(1e3 * trace[known]),
        )
        for x, trace, known in zip(supports, uplift, np.isfinite(uplift), strict=True)
    ]


def _select_supports(supports: Sequence[float], section: tuple[float, float]) -> list[float]:
    """Positions of the supports inside a section, both ends included [m]."""
    positions = np.asarray(supports, dtype=np.float64)
    return list(map(float, positions[supports_inside(positions, section)]))


def thin_series(series: RealArray) -> list[float]:
    """Every k-th value, at most `MAX_POINTS`, rounded to six significant digits."""
    step = max(1, -(-series.size // MAX_POINTS))
    return round_series(series[::step])


def round_series(series: RealArray) -> list[float]:
    """Every value, rounded to six significant digits."""
    return round_digits(series, 6)


def _build_traces(signals: PantographSignals, position: RealArray, supports: list[float]) -> Traces:
    try:
        graded = signals.graded
    except QuantityUnavailable:
        graded = None
    drawn = _select_samples(signals.delivered)
    return Traces(
        position_m=thin_series(position[drawn]),
        force_N=thin_series(signals.delivered[drawn]),
        force_20_N=None if graded is None else thin_series(graded[drawn]),
        strip_forces_N=[thin_series(force[drawn]) for force in signals.strip_forces] or None,
        mean_N=float(signals.delivered.mean()),
        std_N=None if graded is None else float(graded.std()),
        supports_m=supports,
        spectrum=build_spectrum(signals),
        histogram=None if graded is None else _build_histogram(graded),
    )


def build_spectrum(signals: PantographSignals) -> Spectrum:
    """Spectrum of the delivered force up to 50 Hz, or up to the highest frequency that is known; its peaks remain."""
    lines = amplitude_spectrum(signals.delivered, signals.force.rate, signals.highest_frequency)
    frequency, amplitude = _keep_peaks(*lines)
    return Spectrum(frequency_Hz=thin_series(frequency), amplitude_N=thin_series(amplitude))


def _select_samples(force: RealArray) -> NDArray[np.intp]:
    """Indices of the drawn samples; of a long record, the lowest and the highest of every few neighbours.

    Every k-th sample of a record of minutes would not show the one peak that decides its extremes.
    """
    if force.size <= LONG_STEP * MAX_POINTS:
        return np.arange(force.size)
    step = -(-force.size // (MAX_POINTS // 2))
    extremes = {
        first + int(extreme(force[first : first + step]))
        for first in range(0, force.size, step)
        for extreme in (np.argmin, np.argmax)
    }
    return np.array(sorted(extremes), dtype=np.intp)


def _keep_peaks(frequency: RealArray, amplitude: RealArray) -> tuple[RealArray, RealArray]:
    """The highest line of every k neighbours, so that a thinned spectrum keeps its peaks."""
    step = max(1, -(-frequency.size // MAX_POINTS))
    firsts = range(0, frequency.size, step)
    peaks = np.array([first + int(np.argmax(amplitude[first : first + step])) for first in firsts], dtype=int)
    return frequency[peaks], amplitude[peaks]


def _build_histogram(force: RealArray) -> Histogram:
    edges, share = force_histogram(force)
    return Histogram(edges_N=thin_series(edges), share_pct=thin_series(share))
