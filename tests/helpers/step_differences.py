"""Differences between the time step of the fast kernels and the reference kernel with full matrices."""

import numpy as np

from helpers.lines import Array
from pantocheck.model import Passage, build_chain
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.motion import end_of_step, motion_at_rest
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.reference_kernel import FullSystem
from pantocheck.model.dynamics.simulation import start_at_rest
from pantocheck.model.statics.assembly import bandwidth_order

SCALES = {"q": 0.01, "v": 0.1, "a": 10.0, "tension": 100.0, "contact": 100.0, "joint": 100.0}
"""Sizes of a passage [m, m/s, m/s2, N, N, N] below which a difference is not made relative to the largest value.

Both implementations balance forces of the order of 100 N to 1e-9 N, so their differences do not shrink with the motion:
a line that hardly moves has the same absolute error as a line that moves by centimetres.
"""

THREE_MASSES = build_chain(
    np.array([6.0, 9.0, 7.5]), np.array([160.0, 15500.0, 7000.0]), np.array([100.0, 0.1, 45.0]), 250.0, 0, 50e3
)


def largest_differences(
    line: DiscretisedLine, passage: Passage, steps: int, drop: float
) -> tuple[dict[str, float], Array, Array, Array]:
    """Advance both kernels side by side; the heads start with the speed `drop` downwards [m/s].

    Returns the largest difference of each quantity as a share of its largest value, at least of the size in `SCALES`,
    then the tensions, the contact forces and the forces of the joints.
    """
    kernel = build_kernel_arrays(line, passage.time_step)
    deflection, train = start_at_rest(line, passage)
    motion = motion_at_rest(kernel.layout, deflection, kernel.distributed.number)
    for p, pantograph in enumerate(passage.pantographs):
        train.z[1, p, : pantograph.head.size] = -drop * pantograph.head
    system = FullSystem(line, passage)
    state, connectors = system.start(deflection, train), line.connectors.station.size
    work, place = build_workspace(kernel, train), bandwidth_order(line)[system.free]
    computed: dict[str, list[Array]] = {name: [] for name in SCALES}
    expected: dict[str, list[Array]] = {name: [] for name in computed}
    advance = bind_arrays(step, kernel, motion, train, work)
    for _ in range(steps):
        assert advance()
        state = system.advance(state, np.zeros(system.size))
        w, r = end_of_step(motion, kernel.layout, kernel.time_step)
        for i, name in enumerate(("q", "v", "a")):
            wires = np.stack([w[i], r[i]], axis=-1).ravel()[place]
            masses = [train.z[i, p, : pan.head.size] for p, pan in enumerate(passage.pantographs)]
            computed[name].append(np.concatenate([wires, *masses]))
            expected[name].append(getattr(state, name))
        forces = (motion.force[:connectors], train.contact.ravel(), train.joint_force)
        parts = (slice(connectors), slice(system.joints.stop, None), system.joints)
        for name, values, part in zip(("tension", "contact", "joint"), forces, parts, strict=True):
            computed[name].append(values.copy())
            expected[name].append(state.force[part])
    difference = {
        name: float(np.abs(np.array(computed[name]) - np.array(expected[name])).max(initial=0.0))
        / max(float(np.abs(np.array(expected[name])).max(initial=0.0)), SCALES[name])
        for name in computed
    }
    return difference, *(np.array(computed[name]) for name in ("tension", "contact", "joint"))
