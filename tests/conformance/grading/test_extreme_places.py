"""Places of the extremes: those of the graded force and of the uplift that counts."""

import numpy as np

from pantocheck.conformance.grading.contact_loss_list import find_force_places, find_uplift_place
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals

RATE, SPEED = 1000.0, 60.0
TIME = np.arange(6000) / RATE
POSITION = SPEED * TIME


def make_signals(section: tuple[float, float]) -> PantographSignals:
    """A peak at 120 m, a dip at 180 m and a higher peak at 300 m; spikes of one sample are above 20 Hz."""
    force = 100 + sum(a * np.exp(-(((POSITION - x) / 5) ** 2)) for a, x in ((50, 120), (-40, 180), (70, 300)))
    force[POSITION == 150.0] += 500
    return PantographSignals(POSITION, ForceChannel(force, RATE, Filter(cutoff_Hz=20.0)), section)


def test_force_places_lie_in_the_analysis_section_and_ignore_what_the_filter_removes() -> None:
    """The filter is of zero phase: it moves no peak by more than the 60 mm between two samples."""
    places = find_force_places({1: make_signals((60.0, 240.0)), 2: make_signals((60.0, 500.0))})
    assert list(places) == ["1"]  # the second record ends before its section
    assert abs(places["1"]["max_force_N"].position_m - 120) <= 0.06
    assert abs(places["1"]["min_force_N"].position_m - 180) <= 0.06


def test_uplift_place_is_the_support_and_time_of_the_counted_maximum() -> None:
    """The larger uplift at 120 m occurs when the last pantograph is more than 60 m past it, and does not count."""
    uplift = np.array([0.05 * np.exp(-(((TIME - x / SPEED) / 0.1) ** 2)) for x in (60.0, 120.0)])
    uplift[1] *= 0.9
    uplift[1, TIME == 4.0] = 0.2
    line = LineSignals((60.0, 120.0), np.array([60.0, 120.0]), uplift, (0.0, 60.0, 120.0), POSITION)
    place = find_uplift_place(line, TIME)["0"]["max_uplift_at_support_mm"]
    assert (place.position_m, place.time_s) == (60.0, 1.0)
    assert find_uplift_place(LineSignals((60.0, 120.0)), TIME) == {}
