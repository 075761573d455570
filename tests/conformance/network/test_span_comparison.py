"""Comparison of spans: a stated rate of false alarms, and defects of known size."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from pantocheck.conformance.network.run_placement import find_offsets, measure_agreement
from pantocheck.conformance.network.span_comparison import (
    BLOCK_M,
    EXTENTS_M,
    FALSE_ALARMS_PER_1000_KM,
    GRID_M,
    LONGEST_SPAN_M,
    estimate_period,
    find_deviations,
    find_spans,
    find_threshold,
    scale_difference,
    subtract_neighbours,
)

Array = NDArray[np.float64]
NO_SUPPORTS = np.empty(0)


def build_force(length_m: float, span_m: float, seed: int, rough_N: float = 8.0) -> Array:
    """Force with a pattern of 37 N that repeats from span to span, and a rough line with waves of some metres."""
    x = GRID_M * np.arange(round(length_m / GRID_M))
    rough = np.convolve(np.random.default_rng((37, seed)).standard_normal(x.size + 8), np.ones(9) / 3, "valid")
    phase = 2 * np.pi * x / span_m
    return np.asarray(130 + 45 * np.sin(phase) + 25 * np.sin(4 * phase + 1) + rough_N * rough)


def test_false_alarms_have_the_stated_rate() -> None:
    """In 500 km of a Gaussian process, no more than stated: a Poisson number of mean 0.5 exceeds 4 in 0.02 %."""
    rest = np.convolve(np.random.default_rng(37).standard_normal(1_000_008), np.ones(9) / 3, "valid")
    assert len(list(find_deviations(rest))) <= 4


def test_the_threshold_is_not_far_above_that_of_gaussian_blocks() -> None:
    """The largest of 14 independent values exceeds u in a share p: u = Q^-1((1 - (1 - p)^(1/14)) / 2) = 4.86.

    The Gumbel distribution of the square has a longer tail: it gives up to 10 % more. One value of six being a defect
    changes the quartiles by less than 15 %.
    """
    random = np.random.default_rng(37)
    peaks = np.abs(random.standard_normal((100_000, 14))).max(axis=1)
    share = FALSE_ALARMS_PER_1000_KM * BLOCK_M / 1e6 / len(EXTENTS_M)
    exact = norm.isf((1 - (1 - share) ** (1 / 14)) / 2)
    assert exact < find_threshold(peaks) < 1.1 * exact
    peaks[::6] = 20.0
    assert exact < find_threshold(peaks) < 1.3 * exact


@pytest.mark.parametrize("span_m", [41.3, 55.0, 65.2])
def test_the_length_of_spans_is_that_of_the_period(span_m: float) -> None:
    force = build_force(1000.0, span_m, 1)
    assert estimate_period(force) == pytest.approx(span_m, abs=0.1)  # the step of the search
    assert estimate_period(np.random.default_rng(1).standard_normal(2000)) == 0.0
    nothing = np.full(2000, np.nan)
    assert estimate_period(nothing) == 0.0
    assert (np.diff(find_spans(nothing, NO_SUPPORTS)) == LONGEST_SPAN_M).all()


@pytest.mark.parametrize(("extent_m", "force_N"), [(3.0, -60.0), (12.0, 40.0), (30.0, 25.0)])
def test_defects_are_found_where_they_are(extent_m: float, force_N: float) -> None:
    """Defects of the three extents in 5 km, each of six times the scatter of the mean over its extent or more."""
    force = build_force(5000.0, 55.0, 2)
    x = GRID_M * np.arange(force.size)
    assert not list(find_deviations(subtract_neighbours(force, find_spans(force, NO_SUPPORTS))))
    force[np.abs(x - 2310.0) <= extent_m / 2] += force_N
    (found,) = find_deviations(subtract_neighbours(force, find_spans(force, NO_SUPPORTS)))
    assert abs(GRID_M * found.index - 2310.0) <= extent_m / 2
    assert found.deviation * np.sign(force_N) > found.threshold
    assert 4.5 < found.threshold < 5.5  # standard deviations of the mean over the extent


def test_spans_of_known_supports_are_compared_with_spans_of_their_length() -> None:
    """Spans of 50 and 60 m in turn: each is compared with its own kind; without supports, no two spans agree."""
    lengths = np.tile([50.0, 60.0], 40)
    supports = np.concatenate([[0.0], np.cumsum(lengths)])
    x = GRID_M * np.arange(round(supports[-1] / GRID_M))
    number = np.searchsorted(supports, x, "right") - 1
    share = (x - supports[number]) / lengths[number]
    noise = np.random.default_rng(3).normal(0, 1, x.size)
    force = 130 + np.where(lengths[number] == 50.0, 1.0, -1.0) * 40 * np.sin(2 * np.pi * share) + noise
    spans = find_spans(force, supports)
    np.testing.assert_array_equal(spans[:2], [[0.0, 50.0], [50.0, 110.0]])
    rest = subtract_neighbours(force, spans)
    # The median of five of the ten neighbours adds a variance of 0.287 N2 to the noise of 1 N; the scale makes it 1.
    assert np.nanstd(rest) == pytest.approx(np.sqrt(1.287), abs=0.05)
    assert np.nanstd(scale_difference(rest, force)) == pytest.approx(1.0, abs=0.05)
    assert np.abs(np.corrcoef(np.nan_to_num(rest), force - noise)[0, 1]) < 0.05
    assert np.isnan(subtract_neighbours(force, np.array([[0.0, 50.0], [50.0, 110.0]]))).all()  # no neighbours


def test_a_gap_is_compared_with_nothing_and_hides_no_neighbour() -> None:
    force = build_force(5000.0, 50.0, 4)
    force[4010:4020] = np.nan
    rest = subtract_neighbours(force, find_spans(force, NO_SUPPORTS))
    known = np.isfinite(rest)
    assert np.isnan(rest[4010:4020]).all()
    assert known[:4000].all()
    assert known[4100:9800].all()


def test_offsets_are_found_in_part_of_a_run() -> None:
    """The second half is 76.5 m too far; the fifth kilometre of another passage agrees nowhere."""
    random = np.random.default_rng(5)
    line = np.convolve(random.standard_normal(12_008), np.ones(9) / 3, "valid")
    others, own = line[1000:11_000], line[1000:11_000] + random.normal(0, 0.5, 10_000)
    own[4000:] = line[1000 + 4000 - 153 : 11_000 - 153]
    (part,) = find_offsets(own, others, 0.9)
    assert (part.first, part.last, part.offset_m) == (4000, 10_000, 76.5)
    own = line[1000:11_000].copy()
    own[8000:] = random.standard_normal(2000)
    (foreign,) = find_offsets(own, others, 0.9)
    assert (foreign.first, foreign.last, foreign.offset_m) == (8000, 10_000, None)
    assert not find_offsets(own, others, 0.4)  # where the passages do not agree, none of them is foreign
    assert measure_agreement(own, others) == pytest.approx(1.0, abs=1e-6)
    # A tenth of the force in a quiet stretch is no agreement: its energy is 1 % of that around it, and counts as 50 %.
    quiet = random.standard_normal(4000)
    quiet[100:2100] = 0.1 * own[8000:]
    assert measure_agreement(own[8000:], quiet) < 0.25
