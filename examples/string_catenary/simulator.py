"""Small catenary simulator: two wires in finite differences, droppers that slacken, a pantograph of lumped masses.

The simulator does not use Pantocheck; it needs numpy only. Deflections w [m] are positive upwards and start from the
initial state of the line. The time integration is explicit (semi-implicit Euler). The largest stable time step follows
from the node with the largest ratio of stiffness to mass.
"""

import math
from dataclasses import dataclass

import numpy as np

GRAVITY = 9.81
RELAXATION_S, RELAXATION_DAMPING = 4.0, 3.0
"""Duration [s] and additional mass coefficient [1/s] of a simulation that brings the line to rest."""


@dataclass
class Points:
    """Positions on the grid, each between a left and a right node."""

    node: np.ndarray  # number of the left node
    weight: np.ndarray  # weight of the right node

    def interpolate(self, field):
        """Values of a field at the points, by linear interpolation between the nodes."""
        return (1 - self.weight) * field[self.node] + self.weight * field[self.node + 1]

    def distribute(self, field, values):
        """Add values at the points to a field, distributed to the nodes by the same weights."""
        np.add.at(field, self.node, (1 - self.weight) * values)
        np.add.at(field, self.node + 1, self.weight * values)


class Wire:
    """Tensioned beam, pinned at both ends, with n nodes at a distance h [m]."""

    def __init__(self, data, damping, n, h):
        self.tension, self.bending = data["tension_N"] / h, data["bending_stiffness_N_m2"] / h**3
        self.mass = np.full(n, data["mass_kg_m"] * h)
        self.alpha, self.beta = damping["mass_coefficient_1_s"], damping["stiffness_coefficient_s"]
        self.w, self.v = np.zeros(n), np.zeros(n)

    def largest_stiffness(self):
        """Largest stiffness of the finite differences [N/m]."""
        return 4 * self.tension + 16 * self.bending

    def second_difference(self, w):
        """Second difference of the deflections [m]; 0 at both ends."""
        second = np.zeros_like(w)
        second[1:-1] = w[:-2] - 2 * w[1:-1] + w[2:]
        return second

    def force(self, extra_damping):
        """Force of tension, bending and damping on each node [N]."""
        second = self.second_difference(self.w + self.beta * self.v)
        return (
            self.tension * second
            - self.bending * self.second_difference(second)
            - (self.alpha + extra_damping) * self.mass * self.v
        )

    def step(self, force, dt):
        """Advance velocity and deflection by one time step."""
        self.v += dt * force / self.mass
        self.v[0] = self.v[-1] = 0.0
        self.w += dt * self.v


class Line:
    """Contact wire, messenger wire, droppers, steady arms and messenger supports."""

    def __init__(self, data, derived, h):
        droppers, arms, supports = (derived[key] for key in ("droppers", "steady_arms", "messenger_supports"))
        damping, length = data["damping"], derived["contact_wire"]["end_m"]
        cells = round(length / h)
        self.h = length / cells
        self.contact = Wire(data["contact_wire"], damping["contact_wire"], cells + 1, self.h)
        self.messenger = Wire(data["messenger_wire"], damping["messenger_wire"], cells + 1, self.h)
        self.supports = np.array(arms["position_m"])
        self.arms, self.messenger_supports = self.locate(self.supports), self.locate(supports["position_m"])
        # The derived values of droppers have one list per span.
        x, half, height, self.stiffness = (
            np.concatenate([np.array(span) for span in droppers[key]])
            for key in ("position_m", "mass_kg", "contact_wire_height_m", "stiffness_N_m")
        )
        self.droppers, half = self.locate(x), half / 2
        self.droppers.distribute(self.contact.mass, half + droppers["lower_clamp_kg"])
        self.droppers.distribute(self.messenger.mass, half + droppers["upper_clamp_kg"])
        self.dropper_beta, self.arm_beta = (part["stiffness_coefficient_s"] for part in (droppers, arms))
        # A value of arms or supports is one number, or a list if they differ.
        self.arm_stiffness = np.array(arms["vertical_stiffness_N_m"])
        self.arms.distribute(self.contact.mass, np.broadcast_to(arms["mass_kg"], self.supports.shape))
        self.support_stiffness = np.array(supports["vertical_stiffness_N_m"])
        self.support_damping = np.array(supports["vertical_damper_N_s_m"])
        self.height, self.preload = self.solve_initial_state(height, derived)

    def locate(self, x):
        """Points of the grid at positions along the track [m]."""
        node = np.clip((np.asarray(x) / self.h).astype(int), 0, self.contact_nodes() - 2)
        return Points(node, np.asarray(x) / self.h - node)

    def contact_nodes(self):
        """Number of grid points of the contact wire."""
        return self.contact.w.size

    def solve_initial_state(self, height, derived):
        """Height of the contact wire under its weight [m] and tensions of the droppers [N].

        The height is prescribed at the anchors, at the droppers, and at steady arms that carry a share of the weight.
        """
        n, count = self.contact_nodes(), self.droppers.node.size
        carrying = np.array(derived["steady_arms"]["vertical_force_N"]) != 0
        supported = [self.droppers, Points(self.arms.node[carrying], self.arms.weight[carrying])]
        at_limits = np.array(derived["contact_wire"]["height_m"])
        node, weight = (np.concatenate([getattr(p, name) for p in supported]) for name in ("node", "weight"))
        constraint = np.zeros((node.size, n))
        constraint[np.arange(node.size), node], constraint[np.arange(node.size), node + 1] = 1 - weight, weight
        second = np.zeros((n, n))
        inner = np.arange(1, n - 1)
        second[inner, inner - 1], second[inner, inner], second[inner, inner + 1] = 1.0, -2.0, 1.0
        stiffness = self.contact.bending * second @ second - self.contact.tension * second
        stiffness[[0, -1]] = np.eye(n)[[0, -1]]
        load = -GRAVITY * self.contact.mass
        load[[0, -1]] = at_limits[[0, -1]]
        constraint[:, [0, -1]] = 0.0
        system = np.block([[stiffness, -constraint.T], [constraint, np.zeros((node.size, node.size))]])
        prescribed = np.concatenate([height, at_limits[1:-1][carrying]])
        solution = np.linalg.solve(system, np.concatenate([load, prescribed]))
        return solution[:n], solution[n : n + count]

    def stable_step(self, contact_stiffness):
        """Largest stable time step [s], with a margin."""
        points = (self.arm_stiffness, self.support_stiffness, contact_stiffness)
        point = self.stiffness.max() + max(np.max(stiffness) for stiffness in points)
        wires = (self.contact, self.messenger)
        return 0.5 / math.sqrt(max((wire.largest_stiffness() + 2 * point) / wire.mass.min() for wire in wires))

    def step(self, dt, contact_point, contact_force, extra_damping=0.0):
        """Advance both wires by one time step, with the contact force upwards at the contact point."""
        contact, messenger = self.contact, self.messenger
        contact_load, messenger_load = contact.force(extra_damping), messenger.force(extra_damping)
        stretch = self.droppers.interpolate(messenger.w) - self.droppers.interpolate(contact.w)
        rate = self.droppers.interpolate(messenger.v) - self.droppers.interpolate(contact.v)
        tension = np.maximum(0.0, self.preload + self.stiffness * (stretch + self.dropper_beta * rate))
        self.droppers.distribute(contact_load, tension - self.preload)
        self.droppers.distribute(messenger_load, self.preload - tension)
        uplift = self.arms.interpolate(contact.w) + self.arm_beta * self.arms.interpolate(contact.v)
        self.arms.distribute(contact_load, -self.arm_stiffness * uplift)
        supports = self.messenger_supports
        spring = self.support_stiffness * supports.interpolate(messenger.w)
        supports.distribute(messenger_load, -(spring + self.support_damping * supports.interpolate(messenger.v)))
        contact_point.distribute(contact_load, contact_force)
        contact.step(contact_load, dt)
        messenger.step(messenger_load, dt)


def settle_line(line, x, force, dt):
    """Bring the line to rest under a constant force at a position; height of the contact wire there [m]."""
    point = line.locate([x])
    for _ in range(round(RELAXATION_S / dt)):
        line.step(dt, point, force, RELAXATION_DAMPING)
    line.contact.v[:] = line.messenger.v[:] = 0.0
    return float(point.interpolate(line.height + line.contact.w)[0])


def place_forces(train):
    """Constant force on every mass [N]: the uplift force, or its static and its aerodynamic part."""
    chain, applied = train["chain"], train.get("applied_forces")
    parts = [(chain["uplift_force_on"], train["uplift_force_N"])]
    if applied is not None:
        parts = [
            (chain["uplift_force_on"], applied["static_force_N"]),
            (applied["aerodynamic_force_on"], applied["aerodynamic_force_N"]),
        ]
    force = np.zeros(len(chain["masses_kg"]))
    for mass, part in parts:
        force[chain["names"].index(mass) if isinstance(mass, str) else mass - 1] += part
    return force


def simulate(case):
    """Simulate a case with one pantograph.

    Returns the positions of the supports [m] and a table with one row per time step: time [s], position [m], contact
    force [N], height of the contact wire [m], and its uplift at each support [m].
    """
    train, speed = case["pantographs"][0], case["speed_km_h"] / 3.6
    chain, contact_stiffness, uplift_force = train["chain"], train["contact"]["stiffness_N_m"], train["uplift_force_N"]
    derived = case["derived"]
    line = Line(case["line"], derived["line"], case["discretisation"]["element_m"])
    step = case["discretisation"]["time_step_s"]
    substeps = math.ceil(step / line.stable_step(contact_stiffness))
    dt = step / substeps
    start_height = settle_line(line, train["start_m"], uplift_force, dt)
    k, c, m = (np.array(chain[key]) for key in ("stiffness_N_m", "damping_N_s_m", "masses_kg"))
    uplift = place_forces(train)
    working_height = derived["train"]["pantographs"][0]["working_height_m"]
    z, v = np.zeros(m.size), np.zeros(m.size)
    z[-1] = start_height + uplift_force / contact_stiffness
    for i in range(m.size - 1, 0, -1):
        z[i - 1] = z[i] - (uplift[i:].sum() - uplift_force) / k[i]
    steps = round((train["end_m"] - train["start_m"]) / speed / step)
    history = np.zeros((steps, 4 + line.supports.size))
    contact_force = uplift_force
    for n in range(steps):
        for substep in range(substeps):
            x = train["start_m"] + speed * (n * step + (substep + 1) * dt)
            contact_point = line.locate([x])
            line.step(dt, contact_point, contact_force)
            z_below, v_below = np.concatenate([[working_height], z[:-1]]), np.concatenate([[0.0], v[:-1]])
            springs = k * (z - z_below) + c * (v - v_below)
            load = uplift - springs + np.append(springs[1:], 0.0)
            load[-1] -= contact_force
            v += dt * load / m
            z += dt * v
            wire_height = float(contact_point.interpolate(line.height + line.contact.w)[0])
            contact_force = contact_stiffness * max(0.0, z[-1] - wire_height)
        history[n] = [(n + 1) * step, x, contact_force, wire_height, *line.arms.interpolate(line.contact.w)]
    return line.supports, history
