"""Block bootstrap: its intervals have the stated coverage, and a short record has none."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.quantities.statistics import WHOLE_RECORD, Sampling
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered
from pantocheck.conformance.records.block_bootstrap import BlockReplicates, bootstrap_uncertainties

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
    return 120 + np.repeat(amplitude, 100) * np.sin(2 * np.pi * phase) + noise


def test_every_statistic_of_a_sampling_has_replicates() -> None:
    """A statistic of `Sampling` that `BlockReplicates` inherits is one number: its uncertainty would be zero."""
    statistics = {name for name in vars(Sampling) if not name.startswith("_")}
    assert len(statistics) >= 7
    assert statistics <= vars(BlockReplicates).keys()
    # Replicates of the mean by `apply` are those of `mean`; the median of a normal force scatters by sqrt(pi / 2).
    random = np.random.default_rng(7)
    force = random.standard_normal(6000)
    replicates = BlockReplicates(random.integers(0, 5900, (400, 60)), 100)
    assert replicates.apply(np.mean, force) == pytest.approx(replicates.mean(force), abs=1e-12)
    medians = replicates.apply(np.median, force)
    assert medians.shape == (400,)
    assert WHOLE_RECORD.apply(np.median, force) == pytest.approx(medians.mean(), abs=0.01)
    # The scatter of 400 replicates is known within 3.5 %, that of one record of 60 blocks within 10 %.
    assert medians.std() == pytest.approx(np.sqrt(np.pi / 2 / 6000), rel=0.25)


SIGMA = np.sqrt(30**2 * (1 + 0.3**2) / 2 + 8**2)


@pytest.mark.parametrize("count", [20, 60])
def test_intervals_of_95_percent_cover_the_truth(count: int) -> None:
    """200 records give the coverage within 3 % (two standard deviations); few blocks stay some percent below 95 %."""
    random = np.random.default_rng(4)
    hits = np.zeros(2)
    for i in range(200):
        signals = force_signals(spans(random, count), filter_applied_Hz=20.0)
        found = bootstrap_uncertainties(signals, SPAN / SPEED, f"{i:064x}"[::-1])
        hits += [
            abs(signals.delivered.mean() - 120) < found["mean_force_N"],
            abs(signals.graded.std() - SIGMA) < found["std_force_N"],
        ]
    assert np.all(hits / 200 > 0.88)
    assert np.all(hits / 200 < 0.985)


def test_uncertainty_decreases_with_the_length_and_needs_the_band() -> None:
    random = np.random.default_rng(5)
    short, long = (
        bootstrap_uncertainties(force_signals(spans(random, count), filter_applied_Hz=20.0), 1.0, DIGEST)
        for count in (40, 640)
    )
    for name in ("mean_force_N", "std_force_N", "statistical_min_N", "cov_20"):
        assert short[name] / long[name] == pytest.approx(4, rel=0.35)  # an estimate from 40 blocks is off by a fifth
    signals = force_signals(spans(np.random.default_rng(6), 50), filter_applied_Hz=10.0)
    with pytest.raises(AlreadyFiltered):
        BlockReplicates(STARTS, 2).band_rms(signals, BANDS[1])
    assert "rms_5_20_N" not in bootstrap_uncertainties(signals, 1.0, DIGEST)


def test_same_record_has_the_same_uncertainty_and_a_short_one_none() -> None:
    signals = force_signals(spans(np.random.default_rng(6), 50))
    first = bootstrap_uncertainties(signals, 1.0, DIGEST)
    assert first == bootstrap_uncertainties(signals, 1.0, DIGEST)
    assert first != bootstrap_uncertainties(signals, 1.0, "ab" * 32)
    assert set(first) >= {"max_force_N", "min_force_N", "contact_loss_pct", "cov_20"}
    assert bootstrap_uncertainties(force_signals(spans(np.random.default_rng(7), 4)), 1.0, DIGEST) == {}
    cut_short = replace(
        force_signals(spans(np.random.default_rng(7), 40)), section=(0.0, 3000.0)
    )  # 40 spans are 2400 m
    assert bootstrap_uncertainties(cut_short, 1.0, DIGEST) == {}
    signals = force_signals(spans(np.random.default_rng(7), 6))
    assert bootstrap_uncertainties(signals, 0.001, DIGEST) == bootstrap_uncertainties(signals, 0.01, DIGEST)


STARTS = np.array([[0, 3, 7, 7], [7, 0, 1, 2], [5, 5, 5, 5]])


@pytest.mark.parametrize("length", [1, 2, 3])
def test_statistics_of_a_replicate_are_those_of_its_blocks(length: int) -> None:
    """Each replicate is written out as the series of its blocks; sums are rounded in another order."""
    series = np.random.default_rng(8).normal(120, 0.2, 10)
    replicates = BlockReplicates(STARTS, length)
    written = np.array([np.concatenate([series[start : start + length] for start in row]) for row in STARTS])
    assert replicates.mean(series) == pytest.approx(written.mean(axis=1), rel=1e-12)
    assert replicates.std(series) == pytest.approx(written.std(axis=1), rel=1e-9, abs=1e-8)
    assert replicates.largest(series) == pytest.approx(written.max(axis=1), rel=1e-15)
    assert replicates.smallest(series) == pytest.approx(written.min(axis=1), rel=1e-15)
    assert replicates.extent(series, 1e3) == pytest.approx(1e3 * np.ptp(written, axis=1), rel=1e-12)
    assert replicates.percentage(series > 120) == pytest.approx(100 * (written > 120).mean(axis=1), rel=1e-12)


def test_replicates_of_a_band_are_those_of_its_part_of_the_force() -> None:
    """Two lines of 3 Hz and 12 Hz, both of whole periods; the second grows tenfold in the second half."""
    # Blocks of whole periods see the first with 6 N in every replicate. The second has 3 N or 30 N in a block.
    time = np.arange(1000) / RATE
    growth = np.where(time < 5, 1.0, 10.0)
    force = 120 + 6 * np.sqrt(2) * np.sin(2 * np.pi * 3 * time)
    signals = force_signals(np.append(force, 120.0))
    starts = np.array([[100, 200, 300], [600, 700, 800]])
    replicates = BlockReplicates(starts, 100)
    assert replicates.band_rms(signals, BANDS[0]) == pytest.approx([6.0, 6.0], rel=1e-9)
    assert WHOLE_RECORD.band_rms(signals, BANDS[0]) == pytest.approx(6.0, rel=1e-9)
    bursts = force_signals(np.append(force + 3 * np.sqrt(2) * growth * np.sin(2 * np.pi * 12 * time), 120.0))
    # Near the steps of the amplitude, at 0 s and 5 s, the band would hold a part of the larger line.
    assert replicates.band_rms(bursts, BANDS[1]) == pytest.approx([3.0, 30.0], rel=0.02)
    assert {"rms_0_5_N", "rms_5_20_N"} <= set(bootstrap_uncertainties(signals, 1.0, DIGEST))


@pytest.mark.parametrize("block_s", [1.0, 0.997, 1.003, 2.5])
def test_uncertainty_of_the_mean_is_that_of_a_thousand_replicates(block_s: float) -> None:
    """The seed is the first 16 digits of the digest. A scatter about the mean of n blocks is widened by n / (n - 1)."""
    force = spans(np.random.default_rng(9), 12)[:-30]
    signals = force_signals(force, filter_applied_Hz=20.0)
    evaluated, length = force.size - 1, round(100 * block_s)  # the last sample is the end of the section
    blocks = round(evaluated / length)
    starts = np.random.default_rng(int(DIGEST[:16], 16)).choice(evaluated - length + 1, size=(1000, blocks))
    means = np.lib.stride_tricks.sliding_window_view(force[:evaluated], length).mean(axis=1)[starts].mean(axis=1)
    expected = 1.96 * means.std() * np.sqrt(blocks / (blocks - 1))
    uncertainty = bootstrap_uncertainties(signals, block_s, DIGEST)["mean_force_N"]
    assert uncertainty == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("digit", "same"), [(15, False), (16, True)])
def test_seed_is_the_first_sixteen_digits(digit: int, same: bool) -> None:
    signals = force_signals(spans(np.random.default_rng(6), 20))
    other = DIGEST[:digit] + "0" + DIGEST[digit + 1 :]
    assert (bootstrap_uncertainties(signals, 1.0, other) == bootstrap_uncertainties(signals, 1.0, DIGEST)) is same


@pytest.mark.parametrize(("seconds", "available"), [(4.49, False), (4.53, True)])
def test_five_blocks_are_needed(seconds: float, available: bool) -> None:
    """4.5 blocks are rounded to five."""
    force = spans(np.random.default_rng(7), 6)[: round(100 * seconds)]
    assert bool(bootstrap_uncertainties(force_signals(force), 1.0, DIGEST)) is available
