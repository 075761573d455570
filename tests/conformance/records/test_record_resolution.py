"""Sampling rate and resolution of a record: the components bound what fewer samples and digits do."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.graded_wave import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records import record_resolution
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_resolution import (
    CUBIC,
    STRAIGHT,
    find_step,
    interpolate_halfway,
    replace_samples,
    resolution_component,
    sampling_component,
)
from pantocheck.conformance.records.record_signals import RecordSignals

NAMES = ("mean_force_N", "std_force_N", "statistical_min_N", "statistical_max_N", "max_force_N", "rms_5_20_N")


def signals(case: Case, record: Record) -> RecordSignals:
    return RecordSignals(record, case.file.filter, case.line.geometry.supports)


@pytest.mark.parametrize(("step", "size"), [(5.0, 400), (0.1, 400), (1 / 3, 50)])
def test_step_of_rounded_numbers_is_found(step: float, size: int) -> None:
    values = np.random.default_rng(1).normal(120, 30, size)
    assert find_step(np.round(values / step) * step) == pytest.approx(step, rel=1e-9)
    clipped = np.clip(np.round(values / step) * step, None, 150.03)  # no multiple, and 1 of 6 samples
    assert find_step(clipped) == pytest.approx(step, rel=1e-9)
    assert find_step(values) == 0.0  # numbers of a computer have no common step
    assert find_step(np.full(9, 3.0)) == 0.0


def test_samples_of_a_cubic_are_replaced_by_themselves() -> None:
    """The polynomial through four samples at -3, -1, 1 and 3 is exact at 0 for a cubic, away from the ends."""
    series = np.arange(20.0) ** 3
    for first in (0, 1):
        changed = replace_samples(first, CUBIC, series)
        assert changed[3:-3] == pytest.approx(series[3:-3], rel=1e-12)
        kept = np.arange(20) % 2 != first
        assert (changed[kept] == series[kept]).all()
        straight = replace_samples(first, STRAIGHT, np.arange(20.0))
        assert straight[1:-1] == pytest.approx(np.arange(20.0)[1:-1])
    assert interpolate_halfway(series)[2:-3] == pytest.approx((np.arange(20.0) + 0.5)[2:-3] ** 3, rel=1e-12)


@pytest.mark.parametrize("place", np.linspace(0.0, 0.5, 11))
def test_extreme_between_two_samples_is_bounded(place: float) -> None:
    """Parabola whose largest value 0 lies between two samples: the changes together exceed its distance from them."""
    series = -((np.arange(-20.0, 21.0) - place) ** 2)
    largest = series.max()
    straight = max(abs(replace_samples(first, STRAIGHT, series).max() - largest) for first in (0, 1))
    later = abs(interpolate_halfway(series).max() - largest)
    assert straight + later >= 0.99 * place**2


@pytest.mark.parametrize("place", [0.0, 0.25, 0.4, 0.5])
def test_peak_between_two_samples_is_bounded_by_the_component(case_250: Case, place: float) -> None:
    """Crests of a wave in the height: samples on straight lines bound them at 0.4, samples between them at 0.5."""
    record = Wave(rate=500.0).record(case_250)
    index = np.arange(record.position.shape[1])
    turn = 2 * np.pi / 200
    height = 5.0 + 2e-6 / turn**2 * np.cos(turn * (index - place))[None]  # curvature of 2 um per sample squared
    widths = sampling_component(signals(case_250, replace(record, contact_height=height)), None).half_widths[1]
    assert widths["contact_height_range_mm"] >= 0.99 * 2e-3 * place**2  # crest and trough


def test_record_at_the_rate_of_the_case_loses_nothing(case_250: Case) -> None:
    found = signals(case_250, Wave(rate=500.0).record(case_250))
    assert set(sampling_component(found, 500.0).half_widths[1].values()) == {0.0}
    assert sampling_component(found, 1000.0).half_widths[1]["std_force_N"] > 0
    assert set(resolution_component(found).half_widths[1].values()) == {0.0}


def test_either_half_of_the_samples_is_left_out(case_250: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    replaced = set()
    monkeypatch.setattr(record_resolution, "replace_samples", lambda *given: replaced.add(given[:2]) or given[2])
    sampling_component(signals(case_250, Wave(rate=500.0).record(case_250)), None)
    assert replaced == {(first, weights) for first in (0, 1) for weights in (CUBIC, STRAIGHT)}


@pytest.mark.parametrize("step", [1.0, 5.0])
def test_resolution_bounds_the_change_by_rounding(case_250: Case, step: float) -> None:
    record = Wave().record(case_250)
    exact = signals(case_250, record).evaluation.values[1]
    rounded = signals(case_250, replace(record, force=np.round(record.force / step) * step))
    widths, values = resolution_component(rounded).half_widths[1], rounded.evaluation.values[1]
    for name in NAMES:
        assert abs(values[name] - exact[name]) <= widths[name]
    assert widths["mean_force_N"] == pytest.approx(step / 2, rel=0.05)  # all samples half a step higher
    assert widths["statistical_min_N"] < 2.1 * step  # half a step for the mean, three halves for 3 sigma


@pytest.mark.parametrize("every", [2, 5])
def test_sampling_bounds_the_change_by_fewer_samples(case_250: Case, every: int) -> None:
    record = Wave().record(case_250)
    exact = signals(case_250, record).evaluation.values[1]
    thin = signals(
        case_250,
        replace(
            record,
            time=record.time[::every],
            force=record.force[:, ::every],
            position=record.position[:, ::every],
            contact_height=None if record.contact_height is None else record.contact_height[:, ::every],
            support_uplift=None if record.support_uplift is None else record.support_uplift[:, ::every],
        ),
    )
    widths, values = sampling_component(thin, record.rate).half_widths[1], thin.evaluation.values[1]
    for name in NAMES:
        # The end of the section falls between two samples: the section may hold one more or less.
        assert abs(values[name] - exact[name]) <= widths[name] + 0.05
