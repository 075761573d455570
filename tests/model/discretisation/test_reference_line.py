"""EN 50318:2002 reference model against the range of published codes."""

from functools import cache

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from helpers.lines import PANTOGRAPH_2002, Array, simple_line
from pantocheck.model import History, Kind, Passage, Rayleigh, build_chain, simulate_passage
from pantocheck.model.discretisation.discretised_line import discretise

# Damping and limits: published_values.toml, en50318_2002.
DAMPING = {kind: Rayleigh(0.0125, 1e-4) for kind in Kind}


@cache
def passage(speed_km_h: float, element_length: float = 0.5, time_step: float = 1e-3, reach: float = np.inf) -> History:
    """Passage from the first span to the end of the seventh."""
    speed = speed_km_h / 3.6
    supports = tuple(("contact", x) for x in (240.0, 300.0, 360.0))
    task = Passage((PANTOGRAPH_2002,), (20.0,), speed, 400.0 / speed, time_step, supports, reach)
    return simulate_passage(discretise(simple_line(spans=10, damping=DAMPING), element_length), task)


def filtered_force(history: History) -> Array:
    """Contact force below 20 Hz over spans five and six, zero phase, -3 dB at 20 Hz in all (twice third order) [N]."""
    rate = 1 / history.time[0]
    sos = butter(3, 20.0 / (np.sqrt(2) - 1) ** (1 / 6), fs=rate, output="sos")
    inside = (history.position[0] >= 240.0) & (history.position[0] <= 360.0)
    return np.asarray(sosfiltfilt(sos, history.force[0])[inside])


@pytest.mark.parametrize(
    ("speed", "deviation", "uplift"),
    [(250.0, (26.0, 31.0), (0.048, 0.055)), (300.0, (32.0, 40.0), (0.055, 0.065))],
)
def test_force_and_uplift_lie_in_the_range_of_published_codes(
    speed: float, deviation: tuple[float, float], uplift: tuple[float, float]
) -> None:
    """Mean, standard deviation, uplift at the supports, no contact loss: ranges of Wang et al. 2016, Table III."""
    history = passage(speed)
    force = filtered_force(history)
    assert 110.0 < force.mean() < 120.0
    assert deviation[0] < force.std() < deviation[1]
    assert uplift[0] < history.motion[:, :, 0].max() < uplift[1]
    assert history.force.min() > 0


def test_standard_deviation_converges_under_refinement() -> None:
    """Element and time step halved: less than 1 % of sigma, as the reference case states."""
    coarse, fine = (filtered_force(passage(250.0, h, dt)).std() for h, dt in ((0.5, 1e-3), (0.25, 5e-4)))
    assert coarse == pytest.approx(fine, rel=0.01)


def test_active_window_of_four_spans_changes_no_printed_digit() -> None:
    """Waves from beyond four spans return too late to matter: sigma to 1e-4, each sample to 0.1 N."""
    whole, near = passage(250.0), passage(250.0, reach=240.0)
    assert filtered_force(near).std() == pytest.approx(filtered_force(whole).std(), rel=1e-4)
    np.testing.assert_allclose(near.force, whole.force, rtol=0, atol=0.1)


def test_simulate_passage_is_reproducible_to_the_last_bit() -> None:
    """A simulation leaves no state behind."""
    first = passage(300.0)
    passage.cache_clear()
    np.testing.assert_array_equal(passage(300.0).force, first.force)


def test_simulate_passage_at_speed_zero_stays_at_rest() -> None:
    """Without a base spring the start is an equilibrium: the force stays 120 N, the line at rest."""
    free = build_chain(np.array([15.0, 7.2]), np.array([0.0, 4200.0]), np.array([90.0, 10.0]), 120.0, 0, 50e3)
    line = discretise(simple_line(spans=3, damping=DAMPING), 0.5)
    history = simulate_passage(line, Passage((free,), (83.7,), 0.0, 0.5, 1e-3, (("contact", 60.0),)))
    np.testing.assert_allclose(history.force, 120.0, rtol=1e-8)
    np.testing.assert_allclose(history.motion[:, :, 0], history.motion[:, :1, 0].repeat(500, axis=1), rtol=0, atol=1e-9)
