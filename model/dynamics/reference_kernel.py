"""Reference kernel: every time step as one system of equations with the full matrices of line and pantographs.

It settles a doubt about the fast kernels on any case: there is no active window, no compliance and no sweep, and it
shares with them the matrices of the elements and the state at rest only. Average acceleration with the corrected mass
(`mass_correction`) predicts q* = q + dt v + dt^2/4 a and v* = v + dt/2 a. The accelerations a and all forces X between
parts at the end of the step satisfy

    M a + C v + K q + G (X - X0) = f,    q = q* + dt^2/4 a,    v = v* + dt/2 a
    X + s X^(2/3) = X0 + k (G'q - gap) + c (G'v - rate)   within the bounds of X, else X is at a bound

A column of G is the elongation or overlap of one force per unknown. Tensions of droppers (X >= 0), contact forces
(X >= 0, s by Hertz's law), stops and friction, additional tensions of held stretches and modal damping have this law.
Newton's method on the set of forces at a bound factors the system anew in every iteration; without Hertz's law it is
exact when the set does not change any more.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy  # loads scipy.interpolate when it is used
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Wire
from pantocheck.model.description.pantograph import ContactStrip, Pantograph
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.passage import Passage
from pantocheck.model.dynamics.recording import Recording, refuse_divergence
from pantocheck.model.dynamics.train import Train
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.modal.modal_damping import build_modal_terms
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    contact_stiffness,
    correct_mass,
    point_load,
    stretch_directions,
)
from pantocheck.model.statics.static_solver import Deflection

MOST_ITERATIONS = 100
STEPS_PER_REPORT = 20
"""Number of steps between two reports of progress."""


def remove_connectors(line: DiscretisedLine) -> DiscretisedLine:
    """Remove the stiffness and damping of all connectors from a line."""
    zeros = np.zeros_like(line.connectors.stiffness)
    return replace(line, connectors=line.connectors._replace(stiffness=zeros, damping=zeros))


class Forces(NamedTuple):
    """Forces between parts; n unknowns, F forces."""

    direction: sp.csc_array
    """Elongation or overlap per unknown, G, (n, F); the forces on the unknowns are -G (X - preload)."""
    stiffness: Array
    damping: Array
    """Coefficients k, c, (F,) [N/m, N s/m]."""
    preload: Array
    """Forces at rest, which the initial state balances, X0, (F,) [N]."""
    lower: Array
    upper: Array
    """Bounds, (F,) [N]."""
    gap: Array
    rate: Array
    """Elongation and its rate without a force, (F,) [m, m/s]."""
    hertz: Array
    """Factor of Hertz's law, s, (F,) [N^(1/3)]."""


def define_forces(direction: sp.csc_array | Array, **law: Array) -> Forces:
    """Forces along directions, (n, F); a part of the law that is not given is zero, a bound infinite."""
    count = direction.shape[1]
    absent = dict.fromkeys(Forces._fields[1:], np.zeros(count))
    absent |= {"lower": np.full(count, -np.inf), "upper": np.full(count, np.inf)}
    return Forces(sp.csc_array(direction), **absent | law)


def join_forces(*parts: Forces) -> Forces:
    """All forces of parts, in their order."""
    direction = sp.csc_array(sp.hstack([part.direction for part in parts]))
    return Forces(direction, *(np.concatenate(values) for values in zip(*(part[1:] for part in parts), strict=True)))


@dataclass(frozen=True)
class FullState:
    """State after a number of steps; n free unknowns of line and pantographs, F forces."""

    q: Array
    v: Array
    a: Array
    """Displacement, velocity and acceleration, (n,)."""
    force: Array
    """Forces between parts, (F,) [N]."""
    heads: Array
    """Height of every strip below every wire, (C W,) [m]."""
    steps: int = 0


class RunningStrip(NamedTuple):
    """Strip of a pantograph of the train."""

    pantograph: Pantograph
    unknowns: slice
    """Unknowns of the pantograph in the system."""
    strip: ContactStrip
    start: float
    """Position at the start [m]."""


class FullSystem:
    """Line and pantographs as one system.

    Args:
        line: Discretised line.
        passage: Pantographs, speed and time step.
    """

    def __init__(self, line: DiscretisedLine, passage: Passage) -> None:
        matrices, dt = assemble_matrices(remove_connectors(line)), passage.time_step
        self.line, self.passage, self.free = line, passage, matrices.free
        self.wires = line.catenary.contact_wires
        self.rest = line.state.deflection.ravel()[bandwidth_order(line)]
        pantographs = passage.pantographs
        ends = self.free.size + np.cumsum([0, *(p.head.size for p in pantographs)])
        self.size, blocks = int(ends[-1]), [slice(*pair) for pair in pairwise(ends.tolist())]
        self.pantographs = slice(self.free.size, self.size)
        self.damping = sp.csc_array(sp.block_diag([matrices.damping, *(p.damping for p in pantographs)]))
        self.stiffness = sp.csc_array(sp.block_diag([matrices.stiffness, *(p.stiffness for p in pantographs)]))
        mass = sp.block_diag([correct_mass(line, dt), *(p.mass for p in pantographs)])
        self.effective = sp.csc_array(mass + dt / 2 * self.damping + dt**2 / 4 * self.stiffness)
        self._factor = splu(self.effective)
        self.constant = np.concatenate([np.zeros(self.free.size), *(p.force for p in pantographs)])
        self.strips = [
            RunningStrip(pantograph, block, strip, start + strip.offset)
            for pantograph, block, start in zip(pantographs, blocks, passage.start, strict=True)
            for strip in pantograph.strips
        ]
        self.lasting = join_forces(self._connectors(), self._distributed(), self._joints(blocks))
        """Forces whose directions do not change: connectors, distributed forces, joints."""
        joints = sum(len(p.joints) for p in pantographs)
        self.joints = slice(self.lasting.stiffness.size - joints, self.lasting.stiffness.size)

    def _connectors(self) -> Forces:
        law = self.line.connectors
        return define_forces(
            self._of_line(connector_directions(self.line)), stiffness=law.stiffness, damping=law.damping,
            preload=law.preload, lower=np.where(law.unilateral, 0.0, -np.inf),
        )  # fmt: skip

    def _distributed(self) -> Forces:
        """Additional tensions of held stretches, then damping forces of modes."""
        terms, order = build_modal_terms(self.line), bandwidth_order(self.line)
        weights = terms.weight.reshape(terms.damping.size, order.size)[:, order].T
        directions = sp.hstack([stretch_directions(self.line), sp.csc_array(weights)], format="csr")
        stretched = self.line.stretches.stiffness
        return define_forces(
            self._of_line(directions),
            stiffness=np.append(stretched, np.zeros(terms.damping.size)),
            damping=np.append(np.zeros(stretched.size), terms.damping),
        )

    def _joints(self, blocks: list[slice]) -> Forces:
        owned = [(block, j) for block, p in zip(blocks, self.passage.pantographs, strict=True) for j in p.joints]
        directions = np.zeros((self.size, len(owned)))
        for n, (block, joint) in enumerate(owned):
            directions[block, n] = joint.direction
        law = {name: [getattr(j, name) for _, j in owned] for name in ("stiffness", "damping", "gap", "lower", "upper")}
        return define_forces(directions, **{name: np.array(values, dtype=float) for name, values in law.items()})

    def _of_line(self, directions: sp.csr_array) -> sp.csc_array:
        """Directions on the unknowns of the line as directions on all unknowns."""
        below = sp.csr_array((self.size - self.free.size, directions.shape[1]))
        return sp.csc_array(sp.vstack([directions[self.free], below]))

    def start(self, deflection: Deflection, train: Train) -> FullState:
        """State of the line in a static deflection and of the pantographs."""
        line = deflection.displacement.ravel()[bandwidth_order(self.line)[self.free]]
        q, v, a = (
            np.concatenate([part, *(z[p, : pan.head.size] for p, pan in enumerate(self.passage.pantographs))])
            for part, z in zip((line, 0 * line, 0 * line), train.z, strict=True)
        )
        distributed = np.zeros(self.joints.start - deflection.tension.size)
        force = np.concatenate([deflection.tension, distributed, train.joint_force, train.contact.ravel()])
        return FullState(q, v, a, force, np.zeros(train.contact.size))

    def advance(self, state: FullState, load: Array) -> FullState:
        """State one step later.

        Args:
            state: State.
            load: External forces on the unknowns at the end of the step, (n,) [N].

        Raises:
            DidNotConverge: The set of forces at a bound does not settle.
        """
        dt, steps = self.passage.time_step, state.steps + 1
        q0 = state.q + dt * state.v + dt**2 / 4 * state.a
        v0 = state.v + dt / 2 * state.a
        forces = join_forces(self.lasting, self._contacts(steps * dt, q0, v0))
        g = forces.direction
        gain = dt**2 / 4 * forces.stiffness + dt / 2 * forces.damping
        predicted = forces.stiffness * (g.T @ q0 - forces.gap) + forces.damping * (g.T @ v0 - forces.rate)
        predicted += forces.preload
        balance = self.constant + load + g @ forces.preload - self.damping @ v0 - self.stiffness @ q0
        lower, upper, force = forces.lower, forces.upper, state.force
        bound = np.where(force <= lower, lower, np.where(force >= upper, upper, np.nan))
        for _ in range(MOST_ITERATIONS):
            free, (slope, offset) = np.isnan(bound), _linearise_hertz(forces.hertz, force)
            laws = [sp.diags_array(gain * free) @ g.T, -sp.diags_array(np.where(free, slope, 1.0))]
            system = sp.block_array([[self.effective, g], laws], format="csc")
            solution = splu(system).solve(np.append(balance, np.where(free, offset - predicted, -bound)))
            a = solution[: self.size]
            force = _apply_hertz(forces.hertz, predicted + gain * (g.T @ a))
            # A force leaves a bound for the interior first: from bound to bound, Newton's method would jump to and fro.
            low, high = (force <= lower) & ~(bound == upper), (force >= upper) & ~(bound == lower)
            now = np.where(low, lower, np.where(high, upper, np.nan))
            settled = np.allclose(_linearise_hertz(forces.hertz, force)[0][free], slope[free], rtol=1e-9, atol=0.0)
            if settled and np.array_equal(now, bound, equal_nan=True):
                held = np.where(free, force, bound)
                q = q0 + dt**2 / 4 * a
                heads = g[self.pantographs, self.joints.stop :].T @ q[self.pantographs]
                return FullState(q, v0 + dt / 2 * a, a, held, heads, steps)
            bound = now
        refuse_divergence(state.steps, dt)

    def _contacts(self, time: float, q: Array, v: Array) -> Forces:
        """Contact force of every strip and wire at a time, from the predicted motion; no law where there is no wire."""
        pairs = [(strip, wire) for strip in self.strips for wire in self.wires]
        directions, laws = np.zeros((self.size, len(pairs))), np.zeros((5, len(pairs)))
        for n, (running, wire) in enumerate(pairs):
            place = running.start + self.passage.speed * time
            if wire.start < place <= wire.end:
                directions[:, n], laws[:, n] = self._contact(running, wire, place, q, v)
        stiffness, damping, gap, rate, hertz = laws
        return define_forces(
            directions, stiffness=stiffness, damping=damping, gap=gap, rate=rate, hertz=hertz,
            lower=np.zeros(len(pairs)),
        )  # fmt: skip

    def _contact(self, running: RunningStrip, wire: Wire, place: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Overlap of a strip and a wire per unknown; its stiffness, damping, gap, rate and factor of Hertz's law.

        The contact moves along the slope of the wire at rest and of q. A strip whose height depends on the lateral
        position of the wire also sinks or rises as that position changes.
        """
        model, shape, row = running.pantograph, running.strip.shape, self.line.mesh.row_of[wire.name, "z"]
        share, powers = point_load(self.line, row, place), np.arange(len(shape))
        y, moving = self._lateral_motion(wire, place, q, v) if len(shape) > 1 else (0.0, 0.0)
        overlap = np.zeros(self.size)
        overlap[: self.free.size], overlap[running.unknowns] = -share[self.free], y**powers @ shape
        height, slope = self._irregularity(wire, place)
        change = powers[1:] * y ** powers[:-1] @ shape[1:]
        rate = self.passage.speed * (slope + self._slopes(row, place) @ self._position(q))
        rate -= moving * (change @ q[running.unknowns])
        k = contact_stiffness(self.line, row, place, model.contact_stiffness)
        if np.isinf(model.contact_stiffness):
            # Critical damping of head, wire and residual flexibility, which average acceleration does not damp.
            damper = 2 * np.sqrt(k / (overlap @ self._factor.solve(overlap)))
        else:
            damper = (k / model.contact_stiffness) ** 2 * model.contact_damping
        hertz = k * model.hertz_coefficient ** (-2 / 3)
        return overlap, np.array([k, damper, share @ self.rest + height, rate, hertz])

    def _position(self, q: Array) -> Array:
        """Unknowns of the line at rest and of q, in global order."""
        position = self.rest.copy()
        position[self.free] += q[: self.free.size]
        return position

    def _slopes(self, row: int, place: float) -> Array:
        """Slope of a row at a place per unknown of the line: derivatives of the Hermite functions."""
        e, h, s = find_element(self.line.mesh.position, place)
        middle = point_load(self.line, row, float(self.line.mesh.position[e : e + 2].mean()))
        slopes = np.zeros(middle.size)
        slopes[np.flatnonzero(middle)] = [
            -6 * s * (1 - s) / h, (1 - s) * (1 - 3 * s), 6 * s * (1 - s) / h, s * (3 * s - 2),
        ]  # fmt: skip
        return slopes

    def _lateral_motion(self, wire: Wire, place: float, q: Array, v: Array) -> tuple[float, float]:
        """Lateral position of a wire at a strip, and its rate as the strip moves; zero without lateral field."""
        if (row := self.line.mesh.row_of.get((wire.name, "y"))) is None:
            return 0.0, 0.0
        share, position = point_load(self.line, row, place), self._position(q)
        moving = self.passage.speed * (self._slopes(row, place) @ position) + share[self.free] @ v[: self.free.size]
        return float(share @ position), float(moving)

    def _irregularity(self, wire: Wire, place: float) -> tuple[float, float]:
        """Irregularity of a wire at a place and its slope; beyond its points the height of the nearest end."""
        if (irregularity := wire.irregularity) is None:
            return 0.0, 0.0
        points, heights = irregularity.position, irregularity.height
        spline = scipy.interpolate.CubicSpline(points, heights, bc_type=((1, 0.0), (1, 0.0)))
        inside = min(max(place, points[0]), points[-1])
        return float(spline(inside)), float(spline(inside, 1)) if inside == place else 0.0

    def contact_forces(self, state: FullState) -> Array:
        """Force between every strip and wire, (C, W) [N]."""
        return state.force[self.joints.stop :].reshape(len(self.strips), len(self.wires))

    def strip_heights(self, state: FullState) -> Array:
        """Height of every strip where the wires touch it; below the axis of the track without contact [m]."""
        contact = self.contact_forces(state)
        heads = state.heads.reshape(contact.shape)
        return np.array(
            [
                (force @ head) / force.sum() if force.any() else running.strip.shape[0] @ state.q[running.unknowns]
                for force, head, running in zip(contact, heads, self.strips, strict=True)
            ]
        )


def _apply_hertz(factor: Array, linear: Array) -> Array:
    """Forces X with X + s X^(2/3) = L, by the positive root of r^3 + s r^2 - L; X = L without Hertz's law.

    Args:
        factor: Factors s, (F,) [N^(1/3)].
        linear: Forces L of the linear parts, (F,) [N].
    """
    force = linear.copy()
    for n in np.flatnonzero((factor > 0) & (linear > 0)):
        force[n] = np.roots([1.0, factor[n], 0.0, -linear[n]]).real.max() ** 3
    return force


def _linearise_hertz(factor: Array, force: Array) -> tuple[Array, Array]:
    """Slope and constant part of X + s X^(2/3) at forces X: the tangent, L = slope X + constant."""
    root = np.cbrt(np.where(factor > 0, np.maximum(force, 1e-6), 1.0))
    return 1 + 2 / 3 * factor / root, factor * root**2 / 3


def simulate_full_steps(
    line: DiscretisedLine,
    passage: Passage,
    start: tuple[Deflection, Train],
    recording: Recording,
    load: tuple[Array, Array] | None = None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Simulate the steps of a recording, and fill it.

    Args:
        line: Discretised line.
        passage: Pantographs, speed and time step; without a pantograph for a free line.
        start: Line and pantographs at the start.
        recording: Recording of T steps.
        load: Unit force on the line in global order, and its size in each step, (unknowns,), (T,) [-, N].
        progress: Called from time to time with the completed share, 0 to 1.

    Raises:
        DidNotConverge: The set of forces at a bound does not settle in a step.
    """
    system, (_, train) = FullSystem(line, passage), start
    state, steps = system.start(*start), len(recording.contact)
    stations = line.mesh.position[recording.station]
    watched = [point_load(line, row, x)[system.free] for row, x in zip(recording.row, stations, strict=True)]
    for n in range(steps):
        force = np.zeros(system.size)
        if load is not None:
            force[: system.free.size] = load[1][n] * load[0][system.free]
        if (n + 1) * passage.time_step < passage.ramp:
            holding = (1 + np.cos(np.pi * (n + 1) * passage.time_step / passage.ramp)) / 2
            for running, held in zip(system.strips, train.held, strict=True):
                force[running.unknowns] -= holding * held * running.strip.shape[0]
        state = system.advance(state, force)
        recording.contact[n] = system.contact_forces(state).sum(axis=1)
        recording.height[n] = system.strip_heights(state)
        for u, share in enumerate(watched):
            recording.motion[n, u] = [share @ part[: system.free.size] for part in (state.q, state.v, state.a)]
        tension = state.force[: line.connectors.unilateral.size]
        recording.slack[n] = np.count_nonzero(line.connectors.unilateral & (tension == 0))
        if progress and (n + 1) % STEPS_PER_REPORT == 0:
            progress((n + 1) / steps)
