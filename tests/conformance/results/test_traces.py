"""What is drawn: short, and with nothing lost that a reader looks for."""

import numpy as np
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.traces import MOST_POINTS, build_pantograph_traces, build_uplift_traces, thin_series

RATE, SPEED = 200.0, 50.0


def long_record(**changes) -> Record:
    """100 s with a sine of 10 N at 12.38 Hz, one spectral line of thousands."""
    time = np.arange(20_000) / RATE
    force = 120 + 10 * np.sin(2 * np.pi * 12.38 * time)
    given = {
        "time": time,
        "speed": SPEED,
        "position": SPEED * time[None],
        "force": force[None],
        "evaluated": (0.0, 5000.0),
    }
    return Record(**(given | changes))


def test_thinned_spectrum_keeps_its_peak():
    traces = build_pantograph_traces(long_record(), LowPass(), [0.0, 50.0])["1"]
    spectrum = traces.spectrum
    assert len(spectrum.frequency_Hz) <= MOST_POINTS
    assert_allclose(max(spectrum.amplitude_N), 10.0, rtol=1e-5)
    assert spectrum.frequency_Hz[int(np.argmax(spectrum.amplitude_N))] == 12.38
    assert len(traces.position_m) == len(traces.force_N) <= MOST_POINTS
    assert_allclose(sum(traces.histogram.share_pct), 100, rtol=1e-4)  # six digits each


def test_spectrum_ends_where_the_force_was_filtered():
    traces = build_pantograph_traces(long_record(filter_applied_Hz=20.0), LowPass(), [])["1"]
    assert max(traces.spectrum.frequency_Hz) <= 20


def test_nothing_is_drawn_of_a_stretch_that_is_not_covered():
    assert build_pantograph_traces(long_record(evaluated=(0.0, 9000.0)), LowPass(), []) == {}
    assert build_uplift_traces(long_record()) == []


def test_series_are_rounded_and_thinned():
    assert thin_series(np.array([1 / 3])) == [0.333333]
    assert thin_series(np.arange(3001.0)) == list(range(0, 3001, 3))
