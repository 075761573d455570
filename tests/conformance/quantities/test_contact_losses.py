"""Contact losses: their intervals, and the quantities that count them."""

import numpy as np
import pytest

from pantocheck.conformance.quantities.contact_losses import list_losses, loss_durations
from pantocheck.conformance.quantities.evaluation import evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.length_uncertainty import StatisticInterval, length_uncertainties

RATE, SPEED = 1000.0, 50.0
POSITION = SPEED * np.arange(20_000) / RATE


def build_signals(force: np.ndarray, shortest: float | None = None) -> PantographSignals:
    """Analysis section from 100 m to 900 m: samples 2000 to 17999, 16 s."""
    return PantographSignals(POSITION, ForceChannel(force, RATE, Filter()), (100.0, 900.0), None, None, shortest)


def lose_contact(*intervals: tuple[int, int]) -> np.ndarray:
    force = np.full(20_000, 120.0)
    for number, (start, end) in enumerate(intervals, 1):
        force[start:end] = -number
    return force


def test_losses_have_place_time_duration_and_lowest_force_inside_the_section() -> None:
    """Losses of 8 ms, 25 ms and 2 ms; the first one before the section does not count."""
    force = lose_contact((1000, 1010), (3000, 3008), (5000, 5025), (9000, 9002))
    signals = build_signals(force)
    losses = list_losses(signals.delivered, signals.position[signals.inside], RATE)
    assert [(loss.place, loss.time, loss.duration, loss.lowest_force) for loss in losses] == [
        (150.0, pytest.approx(1.0), pytest.approx(0.008), -2.0),
        (250.0, pytest.approx(3.0), pytest.approx(0.025), -3.0),
        (450.0, pytest.approx(7.0), pytest.approx(0.002), -4.0),
    ]
    values = evaluate_signals({1: signals}, LineSignals(signals.section)).values[1]
    assert values["longest_contact_loss_s"] == pytest.approx(0.025)
    assert values["contact_loss_events"] == pytest.approx(3.0)
    assert values["contact_loss_pct"] == pytest.approx(100 * 35 / 16_000)
    assert "long_contact_loss_pct" not in values
    signals = build_signals(lose_contact((1990, 2010), (17_995, 18_100)))
    values = evaluate_signals({1: signals}, LineSignals(signals.section)).values[1]
    assert values["contact_loss_events"] == pytest.approx(2.0)
    assert values["longest_contact_loss_s"] == pytest.approx(0.010)


@pytest.mark.parametrize(("shortest", "samples"), [(0.001, 35), (0.008, 33), (0.0081, 25), (0.03, 0)])
def test_long_losses_are_those_of_the_stated_duration(shortest: float, samples: int) -> None:
    force = lose_contact((3000, 3008), (5000, 5025), (9000, 9002))
    signals = build_signals(force, shortest)
    values = evaluate_signals({1: signals}, LineSignals(signals.section)).values[1]
    assert values["long_contact_loss_pct"] == pytest.approx(100 * samples / 16_000)


def test_random_losses_are_those_of_a_plain_count() -> None:
    """A slow count over the samples gives the same durations."""
    force = np.random.default_rng(4).choice([-1.0, 0.0, 5.0, 50.0], size=3000, p=[0.2, 0.1, 0.4, 0.3])
    durations, run = np.zeros(3000), 0
    for i, value in enumerate([*force, 1.0]):
        if value <= 0:
            run += 1
        elif run:
            durations[i - run : i] = run / RATE
            run = 0
    np.testing.assert_allclose(loss_durations(force, RATE), durations)


def test_interval_gives_the_scatter_of_the_losses() -> None:
    """250 losses in eighty spans: a Poisson number scatters by its root, 6 %; four squares show it within 40 %.

    On the scale of logarithms, the half-width is 250 (exp(2.78 x 0.063) - 1) = 48.
    """
    random = np.random.default_rng(6)
    starts = random.choice(np.arange(2000, 17_990, 5), 250, replace=False)
    signals = build_signals(lose_contact(*((start, start + 3) for start in starts)))
    found = length_uncertainties(signals, 0.2)
    assert isinstance(found["contact_loss_events"], StatisticInterval)
    assert found["contact_loss_events"].half_width == pytest.approx(48, rel=0.4)
    assert found["longest_contact_loss_s"].half_width == 0, "every loss lasts 3 ms"


@pytest.mark.parametrize(
    ("loaded", "expected", "reason"),
    [
        (np.ones(20_000), 100 * 320 / 16_000, None),
        (np.r_[np.zeros(10_000), np.ones(10_000)], 100 * 160 / 8_000, None),
        (np.full(20_000, np.nan), None, "the current is not known"),
        (np.zeros(20_000), None, "never above 30 %"),
    ],
)
def test_arc_share_is_that_under_load(loaded: np.ndarray, expected: float | None, reason: str | None) -> None:
    """Arcs of 16 ms each 0.8 s: twenty in the section, ten of them in its loaded half."""
    arcing = np.zeros(20_000)
    for start in range(2400, 18_000, 800):
        arcing[start : start + 16] = 1
    force = ForceChannel(np.full(20_000, 120.0), RATE, Filter())
    signals = PantographSignals(POSITION, force, (100.0, 900.0), None, np.vstack([arcing, loaded]))
    evaluation = evaluate_signals({1: signals}, LineSignals(signals.section))
    if expected is None:
        assert str(reason) in evaluation.skipped[1]["arc_share_pct"]
    else:
        assert evaluation.values[1]["arc_share_pct"] == pytest.approx(expected)
