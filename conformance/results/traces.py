"""What is drawn of a run: short, rounded series, so that a page stays small and the bytes stay the same."""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import amplitude_spectrum
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE, LowPass
from pantocheck.conformance.quantities.signals import EXTENDED_CUTOFF_HZ, ForceSignals
from pantocheck.conformance.quantities.statistics import force_histogram
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import line_signals, pantograph_signals
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.results_format import Histogram, Spectrum, Traces, UpliftTrace

MOST_POINTS = 1500

LONG_STEP = 10
"""Up to this many samples to one that is drawn, every k-th shows the force well enough."""


def build_pantograph_traces(record: Record, low_pass: LowPass, supports: list[float]) -> dict[str, Traces]:
    """Force, spectrum and histogram of every pantograph over the evaluated stretch; none where it is not covered.

    Parameters
    ----------
    record : Record
        Of a run or a measurement.
    low_pass : LowPass
        Filter of the graded force.
    supports : list[float]
        Positions of the supports of the line [m].
    """
    traces = {}
    start, end = record.evaluated
    for pantograph in range(1, record.pantographs + 1):
        signals = pantograph_signals(record, pantograph, low_pass)
        try:
            inside = signals.inside
        except QuantityUnavailable:
            continue
        within = [x for x in supports if start - 1e-6 <= x <= end + 1e-6]
        highest = min(EXTENDED_CUTOFF_HZ, HIGHEST_SHARE_OF_RATE * record.rate, record.filter_applied_Hz or np.inf)
        traces[str(pantograph)] = build_signal_traces(
            signals, signals.position[inside], within, amplitude_spectrum(signals.delivered, record.rate, highest)
        )
    return traces


def build_signal_traces(
    signals: ForceSignals, position: RealArray, supports: list[float], spectrum: tuple[RealArray, RealArray]
) -> Traces:
    """What is drawn of one pantograph.

    Parameters
    ----------
    signals : ForceSignals
        That are evaluated.
    position : ndarray
        Of their samples along the track [m].
    supports : list[float]
        Positions of the supports there [m].
    spectrum : tuple[ndarray, ndarray]
        Frequencies [Hz] and amplitudes [N]; empty if there is none.
    """
    try:
        graded = signals.graded
    except QuantityUnavailable:
        graded = None
    frequency, amplitude = _peaks(*spectrum)
    at = _drawn(signals.delivered)
    return Traces(
        position_m=thin_series(position[at]),
        force_N=thin_series(signals.delivered[at]),
        force_20_N=None if graded is None else thin_series(graded[at]),
        mean_N=float(signals.delivered.mean()),
        std_N=None if graded is None else float(graded.std()),
        supports_m=supports,
        spectrum=Spectrum(frequency_Hz=thin_series(frequency), amplitude_N=thin_series(amplitude)),
        histogram=None if graded is None else _histogram(graded),
    )


def build_uplift_traces(record: Record) -> list[UpliftTrace]:
    """Uplift at every support of the evaluated spans, over the whole record."""
    if record.support_position is None:
        return []
    start, end = record.evaluated
    positions = [float(x) for x in record.support_position if start - 1e-6 <= x <= end + 1e-6]
    try:
        uplift = line_signals(record).uplift
    except QuantityUnavailable:
        return []
    return [
        UpliftTrace(support_m=x, time_s=thin_series(record.time), uplift_mm=thin_series(1e3 * trace))
        for x, trace in zip(positions, uplift, strict=True)
    ]


def thin_series(series: RealArray) -> list[float]:
    """Every k-th value, at most about 1500, rounded to six significant digits."""
    step = max(1, -(-series.size // MOST_POINTS))
    return [float(f"{value:.6g}") for value in series[::step]]


def _drawn(force: RealArray) -> NDArray[np.intp]:
    """Samples of a long record that are drawn, at most 1500: the lowest and the highest of every few neighbours.

    A record of minutes thinned evenly would not show the one peak that its extremes are about.
    """
    if force.size <= LONG_STEP * MOST_POINTS:
        return np.arange(force.size)
    step = -(-force.size // (MOST_POINTS // 2))
    found = {
        first + int(extreme(force[first : first + step]))
        for first in range(0, force.size, step)
        for extreme in (np.argmin, np.argmax)
    }
    return np.array(sorted(found), dtype=np.intp)


def _peaks(frequency: RealArray, amplitude: RealArray) -> tuple[RealArray, RealArray]:
    """The highest line of every k neighbours: thinning a spectrum must not lose a peak."""
    step = max(1, -(-frequency.size // MOST_POINTS))
    firsts = range(0, frequency.size, step)
    at = np.array([first + int(np.argmax(amplitude[first : first + step])) for first in firsts], dtype=int)
    return frequency[at], amplitude[at]


def _histogram(force: RealArray) -> Histogram:
    edges, share = force_histogram(force)
    return Histogram(edges_N=thin_series(edges), share_pct=thin_series(share))
