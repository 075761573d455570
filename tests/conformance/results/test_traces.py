"""Curves of the figures: short, without losing peaks."""

from typing import Any

import numpy as np
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.traces import MAX_POINTS, build_pantograph_traces, build_uplift_traces, thin_series

RATE, SPEED = 200.0, 50.0


def signals(**changes: Any) -> RecordSignals:
    """100 s with a sine of 10 N at 12.38 Hz, one spectral line of thousands."""
    time = np.arange(20_000) / RATE
    force = 120 + 10 * np.sin(2 * np.pi * 12.38 * time)
    channels = {
        "time": time,
        "speed": SPEED,
        "position": SPEED * time[None],
        "force": force[None],
        "evaluated": (0.0, 5000.0),
    }
    return RecordSignals(Record(**(channels | changes)), LowPass())


def test_thinned_spectrum_keeps_its_peak() -> None:
    traces = build_pantograph_traces(signals().pantographs, [0.0, 50.0])["1"]
    spectrum = traces.spectrum
    assert len(spectrum.frequency_Hz) <= MAX_POINTS
    assert_allclose(max(spectrum.amplitude_N), 10.0, rtol=1e-5)
    assert spectrum.frequency_Hz[int(np.argmax(spectrum.amplitude_N))] == 12.38
    assert len(traces.position_m) == len(traces.force_N) <= MAX_POINTS
    assert traces.histogram is not None
    assert_allclose(sum(traces.histogram.share_pct), 100, rtol=1e-4)  # six digits each


def test_spectrum_ends_where_the_force_was_filtered() -> None:
    traces = build_pantograph_traces(signals(filter_applied_Hz=20.0).pantographs, [])["1"]
    assert max(traces.spectrum.frequency_Hz) <= 20


def test_section_that_is_not_covered_has_no_traces() -> None:
    assert build_pantograph_traces(signals(evaluated=(0.0, 9000.0)).pantographs, []) == {}
    assert build_uplift_traces(signals()) == []


def test_series_are_rounded_and_thinned() -> None:
    assert thin_series(np.array([1 / 3])) == [0.333333]
    assert thin_series(np.arange(3001.0)) == list(range(0, 3001, 3))
