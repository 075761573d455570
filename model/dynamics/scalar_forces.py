"""Scalar forces of a time step, and the Gauss-Seidel sweeps that solve them.

Within one step, each of these forces X changes its own closing acceleration linearly, by the compliance c:

    X = k (d + dt^2/4 a),    a = a_others - c X

so X is solved exactly with all other forces held. One sweep solves each force once. The sweeps are repeated until no
force changes any more; forces far apart hardly influence each other within a step, so two or three sweeps suffice.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.dynamics.kernel_compilation import kernel

FORCE_TOLERANCE = 1e-9
"""A step has converged when no force changes by more than this in a sweep [N]; forces are of the order of 100 N."""
NEGLIGIBLE_FORCE = 1e-11
"""Changes of a force below this, a hundredth of the tolerance of a step, do not update the accelerations [N]."""
MAX_SWEEPS = 200
"""A step without convergence after this number of sweeps is abandoned."""


@kernel
def maximum(a: float, b: float) -> float:
    """Larger of two numbers, or NaN if either is NaN: `max` would drop it, and a diverged step would look converged."""
    return a if a >= b or math.isnan(a) else b


# Scalar forces in a time step: Gauss-Seidel sweeps over all forces except those of the contacts.
#
# A scalar force X acts on the line along a vector g of coefficients, with the elongation e = g'q: the tension of a
# connector, the additional tension of a held stretch, the damping force of a mode. At the end of a step
#
# X = X0 + k e + c e',    of connectors that cannot push    X = max(0, X0 + k e + c e')
#
# With the predicted e*, e*' and the acceleration a = g'q'' of the elongation, X = X* + h a with h = k dt^2/4 + c dt/2.
# A change of the force Y along another vector changes a by -(compliance) times the change, compliance = g' A^-1 g_Y
# with the effective matrix A. The sweeps need these compliances only, not the motion of the line: with all other forces
# held,
#
# X = (X* + h a + h_c X_old) / (1 + h_c),    h_c = h times the compliance of X to itself
#
# Within one step forces far apart hardly influence each other: the compliances are a sparse matrix, and two or three
# sweeps suffice.
class ScalarLaw(NamedTuple):
    """Laws of F scalar forces."""

    preload: Array
    stiffness: Array
    damping: Array
    """Force at rest X0, and its coefficients k, c, (F,) [N, N/m, N s/m]."""
    unilateral: NDArray[np.bool_]
    """Whether the force cannot be negative, (F,)."""


class ScalarForces(NamedTuple):
    """Scalar forces of a line in a time step; F forces, M pairs of forces that influence each other."""

    law: ScalarLaw
    """Laws of the forces."""
    per_acceleration: Array
    """Force per acceleration of the elongation within a step, h, (F,) [kg]."""
    self_compliance: Array
    """Change of the force within a step per force, h_c, (F,) [-]."""
    settling: Array
    """1 / (1 + h_c), (F,) [-]."""
    first: Indices
    """First pair of each force, and M, (F + 1,)."""
    other: Indices
    """The other force of each pair, (M,); every force is also a pair with itself."""
    compliance: Array
    """Acceleration of its elongation per force, (M,) [1/kg]."""


class ScalarWorkspace(NamedTuple):
    """Scratch arrays of a step for F scalar forces."""

    predicted: Array
    """Forces of the predicted motion, X*, (F,) [N]."""
    acceleration: Array
    """Accelerations of the elongations under all forces so far, (F,) [m/s2]."""
    change: Array
    """Changes of the forces since the last step, (F,) [N]."""


def build_scalar_forces(law: ScalarLaw, compliance: csr_array, time_step: float) -> ScalarForces:
    """Build the scalar forces for a time step [s] from their laws and the (F, F) matrix of compliances [1/kg]."""
    compliance.sum_duplicates()
    per_acceleration = time_step**2 / 4 * law.stiffness + time_step / 2 * law.damping
    self_compliance = per_acceleration * compliance.diagonal()
    return ScalarForces(
        law=law,
        per_acceleration=per_acceleration,
        self_compliance=self_compliance,
        settling=1 / (1 + self_compliance),
        first=compliance.indptr.astype(np.int64),
        other=compliance.indices.astype(np.int64),
        compliance=compliance.data.astype(np.float64),
    )


def allocate_scalar_workspace(forces: int) -> ScalarWorkspace:
    """Scratch arrays for a number of scalar forces."""
    return ScalarWorkspace(*(np.zeros(forces) for _ in range(3)))


@kernel
def sweep_forces(forces: ScalarForces, work: ScalarWorkspace, force: Array, first: int, end: int) -> float:
    """Solve the forces from `first` to before `end` once, all others held; return the largest change [N].

    Args:
        forces: Scalar forces of a line.
        work: Predicted forces; accelerations and changes are updated.
        force: Forces, replaced, (F,) [N].
        first, end: Range of the forces.
    """
    largest = 0.0
    for n in range(first, end):
        old = force[n]
        new = work.predicted[n] + forces.per_acceleration[n] * work.acceleration[n] + forces.self_compliance[n] * old
        new *= forces.settling[n]
        if forces.law.unilateral[n] and new < 0.0:
            new = 0.0
        change = new - old
        if abs(change) > NEGLIGIBLE_FORCE:
            force[n] = new
            work.change[n] += change
            for i in range(forces.first[n], forces.first[n + 1]):
                work.acceleration[forces.other[i]] -= forces.compliance[i] * change
        largest = maximum(largest, abs(change))
    return largest
