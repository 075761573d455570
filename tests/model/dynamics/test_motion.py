"""Motion of a line: predictors in place of displacements, rows longer than the line, stations that leave the window."""

import numpy as np

from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.motion import Layout, Motion, build_motion, end_of_step, hold_passed_stations

STEP = 2e-3
LAYOUT = Layout(stations=50, width=64)


def random_motion() -> tuple[Motion, np.ndarray, np.ndarray]:
    """Motion of two rows, with its deflections and slopes."""
    w, r = np.random.default_rng(0).normal(size=(2, 3, 2, 50))
    return build_motion(LAYOUT, STEP, (w, r), np.ones(3)), w, r


def test_predictors_lead_back_to_the_end_of_the_step() -> None:
    """Displacement and velocity to rounding, accelerations exactly; nothing beyond the end of the line."""
    motion, w, r = random_motion()
    for field, expected in zip(end_of_step(motion, LAYOUT, STEP), (w, r), strict=True):
        np.testing.assert_allclose(field, expected, rtol=0, atol=1e-15)
    for field, expected in ((motion.w, w), (motion.r, r)):
        assert not field[..., 50:].any()
        np.testing.assert_array_equal(field[2, :, :50], expected[2])
        np.testing.assert_allclose(field[0, :, :50], expected[0] - STEP**2 / 4 * expected[2], rtol=0, atol=1e-15)


def test_next_predictors_are_those_of_newmark() -> None:
    """q* + dt v* + dt^2 a and v* + dt a against q + dt v + dt^2/4 a and v + dt/2 a; rounding of numbers of order 1."""
    motion, w, _ = random_motion()
    q, v, a = motion.w[..., :50]
    np.testing.assert_allclose(q + STEP * v + STEP**2 * a, w[0] + STEP * w[1] + STEP**2 / 4 * w[2], rtol=0, atol=1e-14)
    np.testing.assert_allclose(v + STEP * a, w[1] + STEP / 2 * w[2], rtol=0, atol=1e-14)


def test_stations_that_leave_the_window_are_held_where_they_are() -> None:
    """At rest at their last displacement; the others, and all stations in a second call, stay as they are."""
    motion, w, r = random_motion()
    motion.active[:] = 8, 47
    hold_passed_stations(STEP, motion, Window(16, 39))
    left = np.r_[8:16, 40:48]
    stay = np.setdiff1d(np.arange(50), left)
    assert motion.active.tolist() == [16, 39]
    for field, expected in zip(end_of_step(motion, LAYOUT, STEP), (w, r), strict=True):
        np.testing.assert_allclose(field[0], expected[0], rtol=0, atol=1e-15)
        assert not field[1:, :, left].any()
        np.testing.assert_allclose(field[..., stay], expected[..., stay], rtol=0, atol=1e-15)
    before = motion.w.copy()
    hold_passed_stations(STEP, motion, Window(16, 39))
    np.testing.assert_array_equal(motion.w, before)


def test_a_window_that_jumps_leaves_all_its_stations() -> None:
    """The old and the new window have no station in common."""
    for window in (Window(32, 47), Window(0, 7)):
        motion, w, _ = random_motion()
        motion.active[:] = 8, 23
        hold_passed_stations(STEP, motion, window)
        held, _ = end_of_step(motion, LAYOUT, STEP)
        assert not held[1:, :, 8:24].any()
        np.testing.assert_allclose(held[0], w[0], rtol=0, atol=1e-15)
