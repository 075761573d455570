"""Curves of the figures: short, without losing peaks."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.traces import MAX_POINTS, build_pantograph_traces, build_uplift_traces, thin_series

RATE, SPEED = 200.0, 50.0


def signals(**changes: Any) -> RecordSignals:
    """100 s with a sine of 10 N at 12.38 Hz, one spectral line of thousands."""
    time = np.arange(20_000) / RATE
    force = 120 + 10 * np.sin(2 * np.pi * 12.38 * time)
    channels = {"time": time, "position": SPEED * time[None], "force": force[None], "evaluated": (0.0, 5000.0)}
    return RecordSignals(Record(**{"speed": SPEED, **channels, **changes}), Filter())


def test_thinned_series_and_spectrum_keep_the_peak() -> None:
    traces = build_pantograph_traces(signals().pantographs, [0.0, 50.0])["1"]
    spectrum = traces.spectrum
    assert len(spectrum.frequency_Hz) <= MAX_POINTS
    assert_allclose(max(spectrum.amplitude_N), 10.0, rtol=1e-5)
    assert spectrum.frequency_Hz[int(np.argmax(spectrum.amplitude_N))] == 12.38
    assert len(traces.position_m) == len(traces.force_N) <= MAX_POINTS
    assert_allclose(sum(traces.histogram.share_pct), 100, rtol=1e-4)  # six digits each
    assert thin_series(np.array([1 / 3])) == [0.333333]
    assert thin_series(np.arange(3001.0)) == list(range(0, 3001, 3))
    # 15 000 samples: every tenth one.
    item = signals(evaluated=(0.0, 3750.0))
    trace = build_pantograph_traces(item.pantographs, [])["1"]
    assert_allclose(trace.position_m, SPEED * np.arange(0, 15_000, 10) / RATE, rtol=1e-5)


def test_filtered_force_or_uncovered_section_has_less_to_draw() -> None:
    traces = build_pantograph_traces(signals(filter_applied_Hz=20.0).pantographs, [])["1"]
    assert max(traces.spectrum.frequency_Hz) <= 20
    assert build_pantograph_traces(signals(evaluated=(0.0, 9000.0)).pantographs, []) == {}
    item = signals()
    assert build_uplift_traces(item.line, item.record.time) == []


def test_uplift_is_drawn_in_millimetres_at_each_support() -> None:
    """Uplifts of 40 mm and 50 mm at the supports of the section, 90 mm outside it."""
    supports, time = np.array([210.0, 270.0, 450.0]), np.arange(20_000) / RATE
    bumps = np.array([[0.04], [0.05], [0.09]]) * np.exp(-(((SPEED * time - supports[:, None]) / 5) ** 2))
    item = signals(evaluated=(200.0, 300.0), support_position=supports, support_uplift=bumps)
    traces = build_uplift_traces(item.line, item.record.time)
    assert [trace.support_m for trace in traces] == [210.0, 270.0]
    # The bump is sampled every 0.25 m and drawn every fourteenth time, so that the peak is met within 1.75 m: 12 %.
    assert [max(trace.uplift_mm) for trace in traces] == pytest.approx([40.0, 50.0], rel=0.12)
    assert all(len(trace.uplift_mm) == len(trace.time_s) <= MAX_POINTS for trace in traces)
    assert_allclose(traces[0].time_s, time[::14], rtol=1e-5)


@pytest.mark.parametrize(
    ("rate", "filter_applied_Hz", "highest"),
    [(200.0, None, 50.0), (100.0, None, 40.0), (200.0, 30.0, 30.0), (60.0, 30.0, 24.0)],
)
def test_spectrum_ends_at_the_known_frequency(rate: float, filter_applied_Hz: float | None, highest: float) -> None:
    """50 Hz, 0.4 of the rate or the cut-off of the delivered force, whichever is lowest; 10 s give lines of 0.1 Hz."""
    time = np.arange(int(10 * rate)) / rate
    force = 120 + np.random.default_rng(4).normal(0, 10, time.size)
    item = signals(
        time=time, position=SPEED * time[None], force=force[None], evaluated=(0.0, 500.0),
        filter_applied_Hz=filter_applied_Hz,
    )  # fmt: skip
    frequency = build_pantograph_traces(item.pantographs, [])["1"].spectrum.frequency_Hz
    assert_allclose(frequency, 0.1 * np.arange(1, len(frequency) + 1), rtol=1e-5)
    assert highest - 0.11 < frequency[-1] < highest + 1e-6  # the last line may lie just beyond by rounding


def test_two_pantographs_are_drawn_with_their_own_section_and_supports() -> None:
    """The rear runs 100 m behind at another force; supports 0.4 m outside the section belong to it."""
    time = np.arange(20_000) / RATE
    position = SPEED * time - np.array([[0.0], [100.0]])
    item = signals(
        position=position, force=np.where(position < 2500, [[110.0], [130.0]], 900.0), evaluated=(1000.0, 2000.0)
    )
    traces = build_pantograph_traces(item.pantographs, [999.6, 1500.0, 2000.4, 2001.0])
    assert [traces[key].mean_N for key in ("1", "2")] == pytest.approx([110.0, 130.0])
    for trace in traces.values():
        assert (trace.position_m[0], trace.supports_m) == (1000.0, [999.6, 1500.0, 2000.4])


@pytest.mark.parametrize("sample", [1, 7_000, 59_998])
@pytest.mark.parametrize("peak", [700.0, -300.0])
def test_long_force_is_drawn_with_its_extremes(sample: int, peak: float) -> None:
    """60 000 samples: the lowest and the highest of every 80 neighbours, in their order."""
    time = np.arange(60_000) / RATE
    force = 120 + 10 * np.sin(2 * np.pi * 12.38 * time)
    force[sample] = peak
    item = signals(time=time, position=SPEED * time[None], force=force[None], evaluated=(0.0, 15_000.0))
    trace = build_pantograph_traces(item.pantographs, [])["1"]
    drawn = np.array(trace.force_N)
    assert peak in drawn
    assert_allclose(trace.position_m[int(np.flatnonzero(drawn == peak)[0])], SPEED * sample / RATE, rtol=1e-5)
    assert np.all(np.diff(trace.position_m) > 0)
    blocks = force.reshape(-1, 80)
    assert_allclose(sorted(drawn), sorted([*blocks.min(axis=1), *blocks.max(axis=1)]), rtol=1e-5)
