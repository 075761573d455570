"""Independent implementation of the time step: full matrices, solved for every set of slack and touching parts.

Average acceleration with the corrected mass. The unknowns are the accelerations a of the line and of the pantographs;
displacement and velocity follow from them. The balance of forces is piecewise linear, with kinks where a dropper
slackens or a head loses the wire, so that Newton's method on the active set is exact after a few solutions.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve

from helpers.lines import Array, without_connectors
from pantocheck.model import Passage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.motion import Layout, Motion, end_of_step
from pantocheck.model.dynamics.train import Train
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    contact_stiffness,
    correct_mass,
    point_load,
    stretch_directions,
)


@dataclass
class State:
    """Stacked displacement, velocity and acceleration of line and pantographs, and the forces; changed by `advance`."""

    q: Array
    v: Array
    a: Array
    tension: Array
    contact: Array
    joint: Array
    time: float = 0.0


class PlainNewmark:
    """Line and pantographs as one system with dense matrices.

    Args:
        line: Discretised line.
        passage: Pantographs, speed and time step.
    """

    def __init__(self, line: DiscretisedLine, passage: Passage) -> None:
        matrices = assemble_matrices(without_connectors(line))
        self.line, self.passage = line, passage
        self.free = matrices.free
        pantographs = passage.pantographs
        sizes = [p.head.size for p in pantographs]
        starts = self.free.size + np.concatenate([[0], np.cumsum(sizes)]).astype(int)
        self.pantograph_slices = [slice(first, last) for first, last in pairwise(starts)]
        self.M, self.C, self.K = (np.zeros((starts[-1], starts[-1])) for _ in range(3))
        inner = slice(0, self.free.size)
        self.M[inner, inner] = correct_mass(line, passage.time_step).toarray()
        self.C[inner, inner] = matrices.damping.toarray()
        stretches = stretch_directions(line)[self.free].toarray()
        self.K[inner, inner] = matrices.stiffness.toarray() + (stretches * line.stretches.stiffness) @ stretches.T
        self.force = np.zeros(starts[-1])
        for block, p in zip(self.pantograph_slices, pantographs, strict=True):
            self.M[block, block], self.C[block, block], self.K[block, block] = p.mass, p.damping, p.stiffness
            self.force[block] = p.force
        self.strips = [(p, strip) for p, pantograph in enumerate(pantographs) for strip in pantograph.strips]
        self.starts = [passage.start[p] + strip.offset for p, strip in self.strips]
        self.joints = [joint for p in pantographs for joint in p.joints]
        self.joint_closing = np.zeros((starts[-1], len(self.joints)))
        owners = [block for block, p in zip(self.pantograph_slices, pantographs, strict=True) for _ in p.joints]
        for j, (block, joint) in enumerate(zip(owners, self.joints, strict=True)):
            self.joint_closing[block, j] = joint.direction
        self.elongation = np.zeros((starts[-1], line.connectors.station.size))
        self.elongation[inner] = connector_directions(line)[self.free].toarray()
        self.rest = line.state.deflection.ravel()[bandwidth_order(line)]

    def copy_state(self, motion: Motion, train: Train) -> State:
        """Copy the initial state of the kernel."""
        place = bandwidth_order(self.line)[self.free]
        layout = Layout(self.line.mesh.position.size, motion.w.shape[2])
        w, r = end_of_step(motion, layout, self.passage.time_step)
        fields = [
            np.concatenate(
                [
                    np.stack([w[i], r[i]], axis=-1).ravel()[place],
                    *(train.z[i, p, : pan.head.size] for p, pan in enumerate(self.passage.pantographs)),
                ]
            )
            for i in range(3)
        ]
        return State(
            *fields,
            motion.force[: self.line.connectors.station.size].copy(),
            train.contact.ravel(),
            train.joint_force.copy(),
        )

    def advance(self, state: State) -> None:
        """Advance by one time step, in place."""
        dt, line = self.passage.time_step, self.line.connectors
        state.time += dt
        q0 = state.q + dt * state.v + dt**2 / 4 * state.a
        v0 = state.v + dt / 2 * state.a
        closing, rest_height = self._closing(state.time, q0)
        bars, joints = self.elongation, self.joint_closing
        places = [x + self.passage.speed * state.time for x in self.starts]
        stiff = np.array(
            [
                contact_stiffness(self.line, row, place, self.passage.pantographs[p].contact_stiffness)
                if covers
                else 0.0
                for (p, _), place in zip(self.strips, places, strict=True)
                for row, covers in self._contact_wires(place)
            ]
        )
        names = ("stiffness", "damping", "gap", "lower", "upper")
        kj, cj, gap, lower, upper = (np.array([getattr(joint, name) for joint in self.joints]) for name in names)
        damper, climb = self._contact_dampers(closing, stiff, places), self._climb_rates(q0, v0, places)
        taut = ~line.unilateral | (state.tension > 0)
        touching = (state.contact > 0) & (stiff > 0)
        bound = np.where(state.joint <= lower, lower, np.where(state.joint >= upper, upper, np.nan))
        for _ in range(100):
            free = np.isnan(bound)
            k, c, kc, cc = line.stiffness * taut, line.damping * taut, stiff * touching, damper * touching
            K = self.K + (bars * k) @ bars.T + (closing * kc) @ closing.T + (joints * kj * free) @ joints.T
            C = self.C + (bars * c) @ bars.T + (closing * cc) @ closing.T + (joints * cj * free) @ joints.T
            # The tension of a taut dropper changes from the preload; a slack dropper removes its whole preload.
            constant = self.force + bars @ (line.preload * ~taut) + closing @ (kc * rest_height + cc * climb)
            constant += joints @ np.where(free, kj * gap, -np.nan_to_num(bound))
            a = solve(self.M + dt / 2 * C + dt**2 / 4 * K, constant - K @ q0 - C @ v0, assume_a="pos")
            q, v = q0 + dt**2 / 4 * a, v0 + dt / 2 * a
            tension = line.preload + line.stiffness * (bars.T @ q) + line.damping * (bars.T @ v)
            contact = stiff * (closing.T @ q - rest_height) + damper * (closing.T @ v - climb)
            now_taut, now_touching = ~line.unilateral | (tension > 0), contact > 0
            joint = kj * (joints.T @ q - gap) + cj * (joints.T @ v)
            # A force leaves a bound for the interior first: from bound to bound, Newton's method would jump to and fro.
            low, high = (joint < lower) & (bound != upper), (joint > upper) & (bound != lower)
            now_bound = np.where(low, lower, np.where(high, upper, np.nan))
            settled = np.array_equal(now_taut, taut) and np.array_equal(now_touching, touching)
            if settled and np.array_equal(now_bound, bound, equal_nan=True):
                state.q, state.v, state.a = q, v, a
                state.tension, state.contact = tension * taut, contact * touching
                state.joint = np.clip(joint, lower, upper)
                return
            taut, touching, bound = now_taut, now_touching, now_bound
        raise ArithmeticError("the active set does not settle")

    def _contact_dampers(self, closing: Array, stiff: Array, places: list[float]) -> Array:
        """Damper of every contact; without a penalty critical damping of head, wire and residual flexibility."""
        dt, dampers = self.passage.time_step, []
        effective = self.M + dt / 2 * self.C + dt**2 / 4 * self.K
        wires = len(self.line.catenary.contact_wires)
        for n, (column, k) in enumerate(zip(closing.T, stiff, strict=True)):
            pantograph = self.passage.pantographs[self.strips[n // wires][0]]
            if np.isinf(pantograph.contact_stiffness) and k > 0:
                dampers.append(2 * np.sqrt(k / (column @ solve(effective, column, assume_a="pos"))))
            else:
                dampers.append((k / pantograph.contact_stiffness) ** 2 * pantograph.contact_damping)
        return np.array(dampers)

    def _climb_rates(self, q: Array, v: Array, places: list[float]) -> Array:
        """Rate at which a contact point rises because it moves along the slope of the wire at rest and of q.

        A strip whose height depends on the lateral position of the wire also sinks or rises as that position changes.
        """
        rates, height = [], self.rest.copy()
        height[self.free] += q[: self.free.size]
        for (p, strip), place in zip(self.strips, places, strict=True):
            for wire, (row, covers) in enumerate(self._contact_wires(place)):
                rate = self.passage.speed * (self._slopes(row, place) @ height) if covers else 0.0
                if covers and len(strip.shape) > 1:
                    lateral = self._lateral_row(wire)
                    y, moving = self._lateral_position(wire, place, q), 0.0
                    if lateral is not None:
                        share = point_load(self.line, lateral, place)[self.free]
                        moving = self.passage.speed * (self._slopes(lateral, place) @ height)
                        moving += share @ v[: self.free.size]
                    change = sum(n * y ** (n - 1) * strip.shape[n] for n in range(1, len(strip.shape)))
                    rate -= moving * (change @ q[self.pantograph_slices[p]])
                rates.append(rate)
        return np.array(rates)

    def _slopes(self, row: int, place: float) -> Array:
        """Slope of a row at a place per unknown of the line."""
        e, h, s = find_element(self.line.mesh.position, place)
        middle = point_load(self.line, row, float(self.line.mesh.position[e : e + 2].mean()))
        slopes = np.zeros(middle.size)
        slopes[np.flatnonzero(middle)] = [
            -6 * s * (1 - s) / h, (1 - s) * (1 - 3 * s), 6 * s * (1 - s) / h, s * (3 * s - 2),
        ]  # fmt: skip
        return slopes

    def _lateral_row(self, wire: int) -> int | None:
        """Row of the lateral motion of a contact wire."""
        return self.line.mesh.row_of.get((self.line.catenary.contact_wires[wire].name, "y"))

    def _lateral_position(self, wire: int, place: float, q: Array) -> float:
        """Lateral position of a contact wire at a place; zero without lateral field."""
        if (row := self._lateral_row(wire)) is None:
            return 0.0
        share, position = point_load(self.line, row, place), self.rest.copy()
        position[self.free] += q[: self.free.size]
        return float(share @ position)

    def _closing(self, time: float, q: Array) -> tuple[Array, Array]:
        """Overlap of each strip and wire per unknown, and the height of the wire at rest, at a time."""
        wires = len(self.line.catenary.contact_wires)
        size = len(self.strips) * wires
        closing, height = np.zeros((self.M.shape[0], size)), np.zeros(size)
        for c, (p, strip) in enumerate(self.strips):
            place = self.starts[c] + self.passage.speed * time
            for wire, (row, covers) in enumerate(self._contact_wires(place)):
                if covers:
                    n, share = c * wires + wire, point_load(self.line, row, place)
                    y = self._lateral_position(wire, place, q) if len(strip.shape) > 1 else 0.0
                    closing[: self.free.size, n] = -share[self.free]
                    closing[self.pantograph_slices[p], n] = y ** np.arange(len(strip.shape)) @ strip.shape
                    height[n] = share @ self.rest + self._irregularity(wire, place)
        return closing, height

    def _contact_wires(self, place: float) -> list[tuple[int, bool]]:
        """Row of every contact wire, and whether the wire covers a place."""
        return [
            (self.line.mesh.row_of[wire.name, "z"], wire.start < place <= wire.end)
            for wire in self.line.catenary.contact_wires
        ]

    def _irregularity(self, wire: int, place: float) -> float:
        """Irregularity of a contact wire at a place; beyond its points the height of the nearest end."""
        irregularity = self.line.catenary.contact_wires[wire].irregularity
        if irregularity is None:
            return 0.0
        spline = CubicSpline(irregularity.position, irregularity.height, bc_type=((1, 0.0), (1, 0.0)))
        return float(spline(min(max(place, irregularity.position[0]), irregularity.position[-1])))
