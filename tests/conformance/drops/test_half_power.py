"""Count of the spectral lines in the half-power bands."""

import pytest

from pantocheck.conformance.drops.identification_analysis import count_half_power_lines
from pantocheck.conformance.results.identified_modes import Mode

PAPER = Mode(
    frequency_Hz=0.9, damping_ratio=0.005, damping_ratio_std=1e-6, sensor_shape=(), half_power_points=1.08
)  # in 120 s
MANY = PAPER.model_copy(update={"frequency_Hz": 9.0, "half_power_points": 10.8})


def test_needed_duration_is_that_of_the_paper() -> None:
    """0.5 % at 0.9 Hz needs 5 / (2 * 0.005 * 0.9) = 555.6 s; Vo Van, Balmes and Lorang print 555 s."""
    counts = count_half_power_lines((PAPER, MANY))
    assert (counts.recommended, counts.modes, counts.fewer) == (5, 2, 1)
    assert counts.needed_s == pytest.approx(555.6, abs=0.05)


@pytest.mark.parametrize("caveat", [{"certain": False}, {"lateral": True}])
def test_doubtful_modes_do_not_determine_the_duration(caveat: dict[str, bool]) -> None:
    doubtful = PAPER.model_copy(update={"damping_ratio": 1e-5, **caveat})
    assert count_half_power_lines((PAPER, doubtful)).needed_s == pytest.approx(555.6, abs=0.05)
    assert count_half_power_lines((doubtful,)).needed_s is None
