"""Contact force and pantographs in the time step of the second formulation."""

from numba import njit

from verification.formulations.difference_data import Heads, Lines
from verification.formulations.difference_strands import Floats


@njit(cache=True)
def push_wire(line: Lines, heads: Heads, k: int, w: Floats, v: Floats) -> float:
    """Contact force of a pantograph, applied to the contact wire: a Catmull-Rom spline interpolates and distributes."""
    x = heads.position[k] / line.spacing
    s, point = x - int(x), line.first[line.contact] + int(x) - 1
    weights = (
        0.5 * (-s + 2 * s**2 - s**3),
        0.5 * (2 - 5 * s**2 + 3 * s**3),
        0.5 * (s + 4 * s**2 - 3 * s**3),
        0.5 * (-(s**2) + s**3),
    )
    height, excess = 0.0, 0.0
    for j in range(4):
        height += weights[j] * (w[point + j] + line.rest[point + j])
        for m in range(4):
            excess += weights[j] * line.excess[abs(j - m)] * weights[m]
    stiffness = heads.contact_stiffness / (1 - heads.contact_stiffness * excess)
    push = max(0.0, stiffness * (heads.height[k, -1] - height))
    for j in range(4):
        v[point + j] += line.gain[point + j] * weights[j] * push
    return push


@njit(cache=True)
def move_pantograph(heads: Heads, k: int, push: float, dt: float) -> None:
    """Advance the masses of a pantograph under its contact force; its base spring is unstretched at `unstretched`."""
    z, u, n = heads.height[k], heads.velocity[k], heads.mass.shape[1]
    below_z, below_u = heads.unstretched[k], 0.0
    for j in range(n):
        spring = heads.stiffness[k, j] * (z[j] - below_z) + heads.damping[k, j] * (u[j] - below_u)
        below_z, below_u = z[j], u[j]
        load = heads.uplift[k, j] - spring - (push if j == n - 1 else 0.0)
        u[j] += dt * load / heads.mass[k, j]
        if j > 0:
            u[j - 1] += dt * spring / heads.mass[k, j - 1]
    for j in range(n):
        z[j] += dt * u[j]
    heads.position[k] += heads.speed * dt
