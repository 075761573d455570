"""Uncertainty from the length of a record: closed forms, slow twins and the coverage of its intervals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.force_quantities import PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.quantities.statistics import WHOLE_RECORD, Sampling
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered
from pantocheck.conformance.records.length_uncertainty import (
    COSINES,
    FEWEST_SPANS_INTERVAL,
    GUMBEL_HALF_WIDTH,
    ExtremeInterval,
    SingleSpans,
    SpanSelections,
    StatisticInterval,
    SubRecordRange,
    cosine_contributions,
    draw_deviations,
    extreme_scale,
    length_uncertainties,
    uplift_uncertainties,
)

RATE, SPEED, SPAN = 100.0, 60.0, 60.0  # a span a second
DIGEST = "9f" * 32


def force_signals(force: RealArray, filter_applied_Hz: float | None = None) -> PantographSignals:
    position = np.arange(force.size) * SPEED / RATE
    channel = ForceChannel(force, RATE, Filter(), filter_applied_Hz)
    return PantographSignals(position, channel, (position[0], position[-1]))


def spans(random: np.random.Generator, count: int) -> RealArray:
    """A sine per span whose amplitude varies from span to span, and slow noise: mean 120, sigma known."""
    amplitude = 30 * (1 + 0.3 * random.standard_normal(count))
    phase = np.arange(count * 100) / 100
    noise = np.repeat(random.standard_normal(count * 4), 25) * 8
    return np.append(120 + np.repeat(amplitude, 100) * np.sin(2 * np.pi * phase) + noise, 120.0)


SIGMA = np.sqrt(30**2 * (1 + 0.3**2) / 2 + 8**2)

STARTS = np.array([0, 3, 5, 9, 10])
KEPT = np.array([[True, True, True, True], [False, True, True, True], [True, False, True, False]])


def write_out(series: RealArray) -> list[RealArray]:
    """Samples of each selection, one after the other."""
    pieces = np.split(series, STARTS[1:-1])
    return [np.concatenate([piece for piece, kept in zip(pieces, row, strict=True) if kept]) for row in KEPT]


def test_every_statistic_of_a_sampling_has_selections() -> None:
    """A statistic of `Sampling` that `SpanSelections` inherits is one number: its uncertainty would be zero."""
    statistics = {name for name in vars(Sampling) if not name.startswith("_")}
    assert len(statistics) >= 7
    assert statistics <= vars(SpanSelections).keys()


def test_statistics_of_a_selection_are_those_of_its_spans() -> None:
    """Each selection is written out; sums are rounded in another order."""
    series = np.random.default_rng(8).normal(120, 0.2, 10)
    selections, written = SpanSelections(STARTS, KEPT), write_out(series)

    def expect(statistic: object) -> list[float]:
        return [statistic(part) for part in written]  # type: ignore[operator]

    assert selections.mean(series) == pytest.approx(expect(np.mean), rel=1e-12)
    assert selections.std(series) == pytest.approx(expect(np.std), rel=1e-9, abs=1e-8)
    assert selections.apply(np.median, series) == pytest.approx(expect(np.median), rel=1e-15)
    assert selections.largest(series) == pytest.approx(expect(np.max), rel=1e-15)
    assert selections.smallest(series) == pytest.approx(expect(np.min), rel=1e-15)
    assert selections.extent(series, 1e3) == pytest.approx(expect(lambda part: 1e3 * np.ptp(part)), rel=1e-12)
    assert selections.percentage(series > 120) == pytest.approx(expect(lambda part: 100 * (part > 120).mean()))
    single = SingleSpans(STARTS, np.eye(4, dtype=np.bool_)).extent(series, 1e3)
    assert single.max(axis=1).sum() == pytest.approx(1e3 * np.ptp(series))


def test_spans_of_a_band_are_those_of_its_part_of_the_force() -> None:
    """A line of 12 Hz has 3 N in the first half and 30 N in the second; near the step, the band leaks."""
    time = np.arange(1000) / RATE
    force = 120 + 3 * np.sqrt(2) * np.where(time < 5, 1.0, 10.0) * np.sin(2 * np.pi * 12 * time)
    starts, kept = np.arange(0, 1001, 100), np.zeros((2, 10), dtype=np.bool_)
    kept[0, 1:4] = kept[1, 6:9] = True
    selections = SpanSelections(starts, kept)
    assert selections.band_rms(force_signals(np.append(force, 120.0)), BANDS[1]) == pytest.approx([3, 30], rel=0.02)
    with pytest.raises(AlreadyFiltered):
        selections.band_rms(force_signals(np.append(force, 120.0), filter_applied_Hz=10.0), BANDS[1])


def test_independent_influences_have_the_variance_of_their_mean() -> None:
    """Six squared coefficients average to the variance over n; a positive correlation is assumed only if it shows.

    The mean of 4000 chi-square variates of six degrees of freedom is known within 0.9 %. The assumed correlation of
    60 independent spans widens by some per cent.
    """
    random = np.random.default_rng(3)
    squares = [np.sum(cosine_contributions(random.standard_normal(60)) ** 2) * 60 for _ in range(4000)]
    assert np.mean(squares) == pytest.approx(1.03, abs=0.05)
    assert np.var(squares) == pytest.approx(2 / COSINES * np.mean(squares) ** 2, rel=0.15)
    # A step along the record is the slowest fluctuation: its first coefficient has most of it, its even ones nothing.
    step = cosine_contributions(np.repeat([1.0, -1.0], 30))
    assert step[0] ** 2 > 0.7 * step @ step
    assert step[1::2] == pytest.approx(0.0, abs=1e-12)
    assert cosine_contributions(np.zeros(60)) == pytest.approx(0.0)


def half_width_of(influence: RealArray) -> float:
    """Half-width of the interval of a mean influence, with its widening by skewness."""
    n = influence.size
    correlation = np.sum(influence[1:] * influence[:-1]) / np.sum(influence**2)
    assumed = max(correlation + (1 + 4 * correlation) / n, 0.0)
    assumed = min(assumed + 2 * np.sqrt((1 - assumed**2) / n), 0.85)
    widening = min(0.4 * stats.skew(influence) ** 2 / (n * (1 - assumed) / (1 + assumed)), 0.2)
    return float((1 + widening) * np.linalg.norm(cosine_contributions(influence)) * stats.t(COSINES).ppf(0.975))


def test_interval_of_the_mean_is_that_of_a_slow_twin() -> None:
    """The jackknife of the mean of equal spans gives the means of the spans themselves."""
    force = spans(np.random.default_rng(9), FEWEST_SPANS_INTERVAL)
    found = length_uncertainties(force_signals(force, filter_applied_Hz=20.0), 1.0)
    means = force[:-1].reshape(FEWEST_SPANS_INTERVAL, 100).mean(axis=1)
    assert found["mean_force_N"].half_width == pytest.approx(half_width_of(means - means.mean()), rel=1e-9)
    # Logarithm of the deviation, with every span left out in turn by hand.
    pieces, value = np.split(force[:-1], FEWEST_SPANS_INTERVAL), force[:-1].std()
    others = np.log([np.concatenate(pieces[:j] + pieces[j + 1 :]).std() for j in range(FEWEST_SPANS_INTERVAL)])
    influence = FEWEST_SPANS_INTERVAL * others.mean() - FEWEST_SPANS_INTERVAL * others - others.mean() + others
    deviation = half_width_of(influence)
    assert found["std_force_N"].half_width == pytest.approx(value * np.expm1(deviation), rel=1e-9)


@pytest.mark.parametrize(("power", "widening"), [(0.5, 0.051), (1.5, 0.2)])
def test_skewed_influences_widen_the_interval_up_to_a_fifth(power: float, widening: float) -> None:
    """Lognormal means of the spans: the exponent sets their skewness."""
    means = 120 + np.exp(power * np.random.default_rng(5).standard_normal(60))
    found = length_uncertainties(force_signals(np.append(np.repeat(means, 100), 0.0), filter_applied_Hz=20.0), 1.0)
    influence = means - means.mean()
    plain = np.linalg.norm(cosine_contributions(influence)) * stats.t(COSINES).ppf(0.975)
    assert half_width_of(influence) / plain - 1 == pytest.approx(widening, rel=0.01)
    assert found["mean_force_N"].half_width == pytest.approx(half_width_of(influence), rel=1e-9)


@pytest.mark.parametrize("shape", [0.0, 0.2, 0.5, -0.1])
def test_scale_of_an_extreme_is_that_of_its_distribution(shape: float) -> None:
    """Largest of 50 variates: scale 3 x 50^-shape. Plotting positions replace random numbers; they leave 2 %."""
    levels = (np.arange(200_000) + 0.5) / 200_000
    maxima = stats.genextreme(shape, scale=3.0).ppf(levels)
    assert extreme_scale(maxima[None, :], 50) == pytest.approx(3.0 * 50.0**-shape, rel=0.02)
    gumbel = stats.gumbel_r()
    inside = gumbel.cdf(gumbel.mean() + GUMBEL_HALF_WIDTH) - gumbel.cdf(gumbel.mean() - GUMBEL_HALF_WIDTH)
    assert inside == pytest.approx(0.95, abs=1e-4)


def test_joint_draws_have_the_stated_intervals_and_correlations() -> None:
    """Student variates: 100,000 draws give the quantile within 1 %, the correlation within 0.02."""
    one, two = np.array([3.0, *[0.0] * 5]), np.array([1.0] * 4 + [0.0] * 2)
    intervals = {
        "one": StatisticInterval(one, 0.0, np.asarray),
        "two": StatisticInterval(two, 0.0, np.asarray),
        "scattered": StatisticInterval(two, 2.0, np.asarray),
        "logarithm": StatisticInterval(0.02 * two, 0.0, lambda deviation: 10 * np.expm1(deviation)),
    }
    drawn = draw_deviations(intervals, 100_000, DIGEST)
    for name in ("one", "two", "scattered"):
        assert np.quantile(np.abs(drawn[name]), 0.95) == pytest.approx(intervals[name].half_width, rel=0.02)
    assert np.quantile(drawn["logarithm"], 0.975) == pytest.approx(intervals["logarithm"].half_width, rel=0.03)
    assert stats.kstest(drawn["one"][:5000] / 3, stats.t(COSINES).cdf).pvalue > 0.01
    ranks = {name: np.argsort(np.argsort(values)) for name, values in drawn.items()}
    assert np.corrcoef(ranks["two"], ranks["logarithm"])[0, 1] == pytest.approx(1.0)
    assert np.corrcoef(drawn["one"], drawn["two"])[0, 1] == pytest.approx(1 / 2, abs=0.03)
    assert np.corrcoef(drawn["two"], drawn["scattered"])[0, 1] == pytest.approx(np.sqrt(1 / 2), abs=0.03)
    again, other = draw_deviations(intervals, 10, DIGEST), draw_deviations(intervals, 10, "0" + DIGEST[1:])
    assert again["one"].tolist() == draw_deviations(intervals, 10, DIGEST)["one"].tolist()
    assert again["one"].tolist() != other["one"].tolist()


def test_intervals_of_95_percent_cover_the_truth() -> None:
    """400 records give the coverage within 2.2 % (two standard deviations); coverage.csv has 2,000 in a row."""
    random, hits = np.random.default_rng(4), np.zeros(2)
    for _ in range(400):
        signals = force_signals(spans(random, FEWEST_SPANS_INTERVAL), filter_applied_Hz=20.0)
        found = length_uncertainties(signals, SPAN / SPEED)
        hits += [
            abs(signals.delivered.mean() - 120) < found["mean_force_N"].half_width,
            abs(signals.graded.std() - SIGMA) < found["std_force_N"].half_width,
        ]
    assert hits / 400 == pytest.approx(0.95, abs=0.025)


def test_few_spans_have_a_range_and_a_short_record_nothing() -> None:
    """A range is the largest change of any stretch of half the record: here three of the five spans."""
    force = spans(np.random.default_rng(7), 5)
    found = length_uncertainties(force_signals(force, filter_applied_Hz=20.0), 1.0)
    assert {type(uncertainty) for uncertainty in found.values()} == {SubRecordRange}
    expected = max(abs(force[s : s + 300].mean() - force[:-1].mean()) for s in (0, 100, 200))
    assert found["mean_force_N"].half_width == pytest.approx(expected, rel=1e-9)
    assert "contact_loss_pct" not in found, "a share of zero says nothing about other records"
    assert not length_uncertainties(force_signals(spans(np.random.default_rng(7), 4)), 1.0)
    cut_short = replace(force_signals(spans(np.random.default_rng(7), 60)), section=(0.0, 4500.0))  # 60 spans: 3600 m
    assert not length_uncertainties(cut_short, 1.0)


@pytest.mark.parametrize(("count", "kind"), [(59, SubRecordRange), (60, StatisticInterval)])
def test_interval_needs_sixty_spans(count: int, kind: type) -> None:
    """Contact losses in fewer than half of the spans have a range with any number of spans."""
    force = np.repeat(spans(np.random.default_rng(6), count), 2)
    position = np.arange(force.size) * SPEED / (2 * RATE)
    force[300:306] = force[-504:-500] = -1.0
    signals = PantographSignals(position, ForceChannel(force, 2 * RATE, Filter()), (0.0, SPAN * count))
    found = length_uncertainties(signals, 1.0)
    lossy = {"contact_loss_pct", "longest_contact_loss_s", "contact_loss_events"}
    extremes = {"max_force_N", "min_force_N"}
    assert {type(found[name]) for name in found.keys() - lossy - extremes} == {kind}
    of_extremes = ExtremeInterval if kind is StatisticInterval else SubRecordRange
    assert {type(found[name]) for name in extremes} == {of_extremes}, "no share is stated for extremes"
    assert found.keys() >= {"max_force_N", "min_force_N", "cov_20", *lossy}
    assert {type(found[name]) for name in lossy} == {SubRecordRange}


@pytest.mark.parametrize("name", [quantity.name for quantity in PANTOGRAPH_QUANTITIES if quantity.extreme])
def test_extreme_is_the_largest_value_of_the_spans(name: str) -> None:
    """The declared side is that of the value: the extremes of the single spans add up to it."""
    (quantity,) = (quantity for quantity in PANTOGRAPH_QUANTITIES if quantity.name == name)
    force = np.random.default_rng(1).normal(20, 30, 4001)
    channel = ForceChannel(force, 400.0, Filter())
    signals = PantographSignals(np.arange(4001) * 0.15, channel, (0.0, 600.0), force)
    single = SingleSpans(np.arange(0, 4001, 400), np.eye(10, dtype=np.bool_))
    sign = {"largest": 1, "smallest": -1}[quantity.extreme]
    extremes = np.atleast_2d(sign * quantity.compute(signals, single))
    assert sign * extremes.max(axis=1).sum() == pytest.approx(float(quantity.compute(signals, WHOLE_RECORD)))


def test_uplift_has_an_interval_with_enough_supports() -> None:
    """Gumbel uplifts of scale 4 mm: half-width 2.43 x 4 mm, widened by the estimate of the scale, within a third."""
    peaks = 1e-3 * stats.gumbel_r(60, 4).ppf((np.random.default_rng(2).permutation(60) + 0.5) / 60)
    found = {}
    for count in (39, 60):
        supports = 60.0 * np.arange(count)
        uplift = np.column_stack([np.zeros(count), peaks[:count]])
        found[count] = uplift_uncertainties(LineSignals((0.0, 3600.0), supports, uplift, tuple(supports)))
    assert not found[39]
    assert found[60]["max_uplift_at_support_mm"].half_width == pytest.approx(1.3 * 4 * GUMBEL_HALF_WIDTH, rel=0.3)
