"""Sweeps over scalar forces against a linear solution and against the law of a force that cannot push."""

import numpy as np
from scipy.sparse import csr_array

from helpers.lines import Array
from pantocheck.model.dynamics.scalar_forces import (
    FORCE_TOLERANCE,
    NEGLIGIBLE_FORCE,
    ScalarLaw,
    ScalarWorkspace,
    allocate_scalar_workspace,
    build_scalar_forces,
    sweep_forces,
)

STEP = 2e-3


def settle(law: ScalarLaw, compliance: Array, start: Array) -> tuple[Array, ScalarWorkspace, Array]:
    """Forces after sweeps from a first guess, the workspace, and the accelerations under the first guess."""
    forces, work = build_scalar_forces(law, csr_array(compliance), STEP), allocate_scalar_workspace(start.size)
    random = np.random.default_rng(3)
    work.predicted[:] = random.normal(0.0, 100.0, start.size)
    work.acceleration[:] = before = random.normal(0.0, 50.0, start.size)
    force = start.copy()
    while sweep_forces(forces, work, force, 0, start.size) > FORCE_TOLERANCE:
        pass
    return force, work, before


def problem(unilateral: bool) -> tuple[ScalarLaw, Array, Array]:
    """Twenty forces with a dense positive definite compliance, and a first guess."""
    random = np.random.default_rng(2)
    root = np.eye(20) + 0.1 * random.normal(size=(20, 20))
    law = ScalarLaw(np.zeros(20), random.uniform(1e4, 1e6, 20), random.uniform(0.0, 500.0, 20), np.full(20, unilateral))
    return law, root @ root.T, random.uniform(0.0, 200.0, 20)


def test_sweeps_solve_the_linear_system() -> None:
    """X = X* + h a with a = a_0 - C (X - X_0), in one solution; the sweeps stop at changes of 1e-9 N of 100 N."""
    law, compliance, start = problem(unilateral=False)
    force, work, before = settle(law, compliance, start)
    h = np.diag(STEP**2 / 4 * law.stiffness + STEP / 2 * law.damping)
    expected = np.linalg.solve(np.eye(20) + h @ compliance, work.predicted + h @ (before + compliance @ start))
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-8)
    np.testing.assert_allclose(work.change, force - start, rtol=0, atol=1e-10)
    np.testing.assert_allclose(work.acceleration, before - compliance @ (force - start), rtol=0, atol=1e-10)


def test_unilateral_forces_are_complementary() -> None:
    """Every force obeys max(0, X* + h a) with the accelerations under all forces."""
    law, compliance, start = problem(unilateral=True)
    force, work, _ = settle(law, compliance, start)
    h = STEP**2 / 4 * law.stiffness + STEP / 2 * law.damping
    np.testing.assert_allclose(force, np.maximum(0.0, work.predicted + h * work.acceleration), rtol=0, atol=1e-8)
    assert (force == 0.0).any()
    assert (force > 0.0).any()


def test_a_sweep_covers_its_range_and_applies_no_negligible_change() -> None:
    """Three forces without stiffness, so that each becomes the predicted one; changes below 1e-11 N are not applied."""
    law = ScalarLaw(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3, dtype=np.bool_))
    forces, work = build_scalar_forces(law, csr_array(np.full((3, 3), 0.5)), STEP), allocate_scalar_workspace(3)
    force = np.full(3, 100.0)
    work.predicted[:] = 101.0, 100.0 + NEGLIGIBLE_FORCE / 2, 102.0
    assert sweep_forces(forces, work, force, 1, 3) == 2.0
    assert force.tolist() == [100.0, 100.0, 102.0]
    assert work.change.tolist() == [0.0, 0.0, 2.0]
    assert work.acceleration.tolist() == [-1.0, -1.0, -1.0]
