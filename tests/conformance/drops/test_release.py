"""Release of the mass: the first movement that exceeds the noise at rest."""

import numpy as np
import pytest

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_preparation import find_release

RATE = 50.0


def build_signals(moves: dict[float, float], noise: float = 0.01, duration: float = 20.0) -> RealArray:
    """Two channels that alternate by the noise, with another offset each; the second one moves by steps."""
    t = np.arange(int(duration * RATE)) / RATE
    signals = np.outer(noise * (-1.0) ** np.arange(t.size), [1.0, 1.0]) + np.array([3.0, -1.0])
    for time, step in moves.items():
        signals[t >= time - 1e-9, 1] += step
    return signals


def test_movement_counts_from_eight_standard_deviations_of_the_rest() -> None:
    """The median of the magnitude is 0.01: normal noise has 1.4826 times that as std, so the threshold is 0.1186."""
    release = find_release(build_signals({6.0: 0.10, 7.5: 0.03}), RATE, 5.0, "record")
    assert release.time == pytest.approx(7.5)
    assert release.rest_end == pytest.approx(4.4)  # 0.6 s before the planned release
    assert release.warnings == ("record: the first motion is 2.5 s after the planned release",)


def test_early_movement_ends_the_rest() -> None:
    release = find_release(build_signals({4.44: 1.0}), RATE, 5.0, "record")
    assert (release.time, release.rest_end, release.warnings) == (pytest.approx(4.44), pytest.approx(4.34), ())


def test_downward_movement_is_a_release() -> None:
    assert find_release(build_signals({7.0: -1.0}), RATE, 5.0, "record").time == pytest.approx(7.0)


def test_spike_of_two_samples_is_no_movement() -> None:
    signals = build_signals({6.0: 1.0, 6.04: -1.0, 9.0: 1.0})
    assert find_release(signals, RATE, 5.0, "record").time == pytest.approx(9.0)


def test_record_without_noise_moves_at_the_first_change() -> None:
    assert find_release(build_signals({5.2: 1e-3}, noise=0.0), RATE, 5.0, "record").time == pytest.approx(5.2)


def test_planned_release_without_rest_is_used() -> None:
    release = find_release(build_signals({0.0: 1.0}), RATE, 1.5, "record")
    assert (release.time, release.rest_end) == (1.5, 0.0)
    assert "no rest before the release; the planned time of release is used" in release.warnings[0]
    with pytest.raises(InputError, match="no channel moves"):
        find_release(build_signals({}), RATE, 1.81, "record")


@pytest.mark.parametrize("time", [2.9, 6.3])
def test_release_without_a_trigger_time_follows_a_quiet_start(time: float) -> None:
    """Three channels of different noise, of which one moves: the window of half a second before the jump is rest."""
    random = np.random.default_rng(1)
    t = np.arange(int(20 * RATE)) / RATE - time
    signals = random.standard_normal((t.size, 3)) * [0.01, 0.002, 0.05]
    signals[:, 1] += np.where(t > -1e-9, np.cos(5 * t), 0.0)
    release = find_release(signals, RATE, None, "record")
    assert release.time == pytest.approx(time, abs=0.5 / RATE)
    assert time - 1.0 < release.rest_end < time


def test_release_in_the_first_second_needs_a_trigger_time() -> None:
    with pytest.raises(InputError, match="has neither a planned release nor a rest"):
        find_release(build_signals({0.7: 1.0, 0.9: -1.0}), RATE, None, "record")


def test_record_that_ends_within_a_second_of_the_release_is_refused() -> None:
    assert find_release(build_signals({19.0: 1.0}), RATE, 18.89, "record").time == pytest.approx(19.0)
    with pytest.raises(InputError, match=r"ends 0\.70 s after the release"):
        find_release(build_signals({19.3: 1.0}), RATE, 19.25, "record")
    with pytest.raises(InputError, match=r"ends after 20\.00 s, but the release is planned at 19\.70 s"):
        find_release(build_signals({19.3: 1.0}), RATE, 19.70, "record")
