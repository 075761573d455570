"""Gauss-Seidel sweeps over the scalar forces of a time step: terms that all of these forces share.

Within one step, each of these forces X changes its own closing acceleration linearly, by the compliance c:

    X = k (d + dt^2/4 a),    a = a_others - c X

so X is solved exactly with all other forces held. One sweep solves each force once. The sweeps are repeated until no
force changes any more; forces far apart hardly influence each other within a step, so two or three sweeps suffice.
"""

import math

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
