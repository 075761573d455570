"""Tuning: few runs, the last one kept."""

import numpy as np
import pytest

from pantocheck.conformance.simulation.uplift_tuning import MOST_RUNS, TOLERANCE, TuningFailed, tune_uplift


class Line:
    """Mean forces that follow the uplift forces, each a little the other's; counts its runs."""

    def __init__(self, gain: float, cross: float = 0.0) -> None:
        self.matrix, self.runs = np.array([[gain, cross], [cross, gain]]), 0

    def __call__(self, forces: tuple[float, ...]) -> np.ndarray:
        self.runs += 1
        return self.matrix @ np.array(forces) + 3.0


@pytest.mark.parametrize(("gain", "cross", "most"), [(1.0, 0.0, 2), (0.93, 0.0, 3), (0.98, 0.05, 5), (0.8, -0.1, 7)])
def test_targets_are_met_in_few_runs(gain, cross, most):
    line = Line(gain, cross)
    made, forces = tune_uplift(line, lambda run: run, (150.0, 150.0), (144.0, 169.0))
    assert np.abs(made - [144.0, 169.0]).max() <= TOLERANCE
    assert made == pytest.approx(line(forces))  # the run that is kept is the one of these forces
    assert line.runs - 1 <= most


def test_force_without_a_target_stays_and_needs_one_run():
    line = Line(1.0)
    _, forces = tune_uplift(line, lambda run: run, (120.0, 130.0), (None, None))
    assert forces == (120.0, 130.0)
    assert line.runs == 1


def test_last_run_counts():
    """A mean that stands still until the last run allowed, and then meets its target."""
    runs = []

    def run(forces: tuple[float, ...]) -> np.ndarray:
        runs.append(forces)
        return np.array([144.0 if len(runs) == MOST_RUNS else 50.0])

    made, _ = tune_uplift(run, lambda made: made, (120.0,), (144.0,))
    assert (made[0], len(runs)) == (144.0, MOST_RUNS)


def test_mean_that_does_not_follow_is_refused():
    with pytest.raises(TuningFailed, match="off its target"):
        tune_uplift(lambda forces: forces, lambda run: np.full(1, 50.0), (120.0,), (144.0,))
