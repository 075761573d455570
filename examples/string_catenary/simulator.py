"""A small catenary simulator: two wires in finite differences, droppers that slacken, a pantograph of lumped masses.

It knows nothing of Pantocheck and needs numpy alone. Deflections w are upwards about the initial state. Time stepping
is explicit (semi-implicit Euler), so the step follows from the stiffest point mass.
"""

import math
from dataclasses import dataclass

import numpy as np

GRAVITY = 9.81
RELAXATION_S, RELAXATION_DAMPING = 4.0, 3.0  # a line at rest is found by letting it swing out [s], [1/s]


@dataclass
class Points:
    """Places on the grid, each between two nodes with its weights."""

    node: np.ndarray
    weight: np.ndarray  # of the right-hand node

    def of(self, field):
        return (1 - self.weight) * field[self.node] + self.weight * field[self.node + 1]

    def add(self, force, at):
        np.add.at(force, self.node, (1 - self.weight) * at)
        np.add.at(force, self.node + 1, self.weight * at)


class Wire:
    """A tensioned beam, pinned at both ends, on n nodes at a distance h."""

    def __init__(self, data, damping, n, h):
        self.tension, self.bending = data["tension_N"] / h, data["bending_stiffness_N_m2"] / h**3
        self.mass = np.full(n, data["mass_kg_m"] * h)
        self.alpha, self.beta = damping["mass_coefficient_1_s"], damping["stiffness_coefficient_s"]
        self.w, self.v = np.zeros(n), np.zeros(n)

    def stiffest(self):
        return 4 * self.tension + 16 * self.bending

    def curvature(self, w):
        second = np.zeros_like(w)
        second[1:-1] = w[:-2] - 2 * w[1:-1] + w[2:]
        return second

    def force(self, extra_damping):
        second = self.curvature(self.w + self.beta * self.v)
        return (
            self.tension * second
            - self.bending * self.curvature(second)
            - (self.alpha + extra_damping) * self.mass * self.v
        )

    def step(self, force, dt):
        self.v += dt * force / self.mass
        self.v[0] = self.v[-1] = 0.0
        self.w += dt * self.v


class Line:
    """Contact wire and messenger wire with what hangs between and beside them."""

    def __init__(self, data, h):
        geometry, droppers = data["geometry"], data["droppers"]
        span, spans, damping = geometry["span_m"], geometry["spans"], data["damping"]
        cells = round(span * spans / h)
        self.h = span * spans / cells
        self.contact = Wire(data["contact_wire"], damping["contact_wire"], cells + 1, self.h)
        self.messenger = Wire(data["messenger_wire"], damping["messenger_wire"], cells + 1, self.h)
        self.supports = span * np.arange(1, spans)
        self.arms = self.messenger_supports = self.points(self.supports)
        x = np.concatenate([span * i + np.array(droppers["x_m"]) for i in range(spans)])
        self.droppers = self.points(x)
        self.stiffness, self.dropper_beta = droppers["stiffness_N_m"], damping["droppers"]["stiffness_coefficient_s"]
        half = (droppers["mass_kg"] or 0.0) / 2
        self.droppers.add(self.contact.mass, np.full(x.size, half + droppers["clamp_on_contact_kg"]))
        self.droppers.add(self.messenger.mass, np.full(x.size, half + droppers["clamp_on_messenger_kg"]))
        arm = data["steady_arm"]
        self.arm_stiffness, self.arm_beta = (
            arm["vertical_stiffness_N_m"],
            damping["steady_arms"]["stiffness_coefficient_s"],
        )
        claw = arm["mass_kg_m"] * (arm["length_m"] or 0.0) / 3 + arm["clamp_kg"]
        self.arms.add(self.contact.mass, np.full(self.supports.size, claw))
        self.support_stiffness = data["messenger_support"]["stiffness_N_m"]
        self.support_damping = data["messenger_support"]["damping_N_s_m"]
        sag = np.tile(droppers["presag_m"] or [0.0] * len(droppers["x_m"]), spans)
        self.height, self.preload = self.initial_state(-sag, arm["static_share"] == "level")

    def points(self, x):
        node = np.clip((np.asarray(x) / self.h).astype(int), 0, self.contact_nodes() - 2)
        return Points(node, np.asarray(x) / self.h - node)

    def contact_nodes(self):
        return self.contact.w.size

    def initial_state(self, height, arms_carry):
        """Height of the contact wire under its weight, prescribed at the droppers, and the droppers' tensions."""
        n, count = self.contact_nodes(), self.droppers.node.size
        held = [self.droppers, self.arms] if arms_carry else [self.droppers]
        node, weight = (np.concatenate([getattr(p, name) for p in held]) for name in ("node", "weight"))
        pull = np.zeros((node.size, n))
        pull[np.arange(node.size), node], pull[np.arange(node.size), node + 1] = 1 - weight, weight
        second = np.zeros((n, n))
        inner = np.arange(1, n - 1)
        second[inner, inner - 1], second[inner, inner], second[inner, inner + 1] = 1.0, -2.0, 1.0
        stiffness = self.contact.bending * second @ second - self.contact.tension * second
        stiffness[[0, -1]] = np.eye(n)[[0, -1]]
        load = -GRAVITY * self.contact.mass
        load[[0, -1]] = 0.0
        pull[:, [0, -1]] = 0.0
        system = np.block([[stiffness, -pull.T], [pull, np.zeros((node.size, node.size))]])
        prescribed = np.concatenate([height, np.zeros(node.size - count)])
        solution = np.linalg.solve(system, np.concatenate([load, prescribed]))
        return solution[:n], solution[n : n + count]

    def stable_step(self, contact_stiffness):
        point = self.stiffness + max(self.arm_stiffness, self.support_stiffness, contact_stiffness)
        wires = (self.contact, self.messenger)
        return 0.5 / math.sqrt(max((wire.stiffest() + 2 * point) / wire.mass.min() for wire in wires))

    def step(self, dt, at, push, extra_damping=0.0):
        """One time step with a force pushing the contact wire up at a place."""
        contact, messenger = self.contact, self.messenger
        on_contact, on_messenger = contact.force(extra_damping), messenger.force(extra_damping)
        stretch = self.droppers.of(messenger.w) - self.droppers.of(contact.w)
        rate = self.droppers.of(messenger.v) - self.droppers.of(contact.v)
        tension = np.maximum(0.0, self.preload + self.stiffness * (stretch + self.dropper_beta * rate))
        self.droppers.add(on_contact, tension - self.preload)
        self.droppers.add(on_messenger, self.preload - tension)
        arms = self.arms.of(contact.w) + self.arm_beta * self.arms.of(contact.v)
        self.arms.add(on_contact, -self.arm_stiffness * arms)
        supports = self.messenger_supports
        held = self.support_stiffness * supports.of(messenger.w) + self.support_damping * supports.of(messenger.v)
        supports.add(on_messenger, -held)
        at.add(on_contact, push)
        contact.step(on_contact, dt)
        messenger.step(on_messenger, dt)


def relaxed(line, x, force, dt):
    """Let the line come to rest under a force; the height of the contact wire there."""
    at = line.points([x])
    for _ in range(round(RELAXATION_S / dt)):
        line.step(dt, at, force, RELAXATION_DAMPING)
    line.contact.v[:] = line.messenger.v[:] = 0.0
    return float(at.of(line.height + line.contact.w)[0])


def simulate(case):
    """Run a case with one pantograph; time, position, contact force, contact height, uplift at the supports."""
    train, speed = case["pantographs"][0], case["speed_km_h"] / 3.6
    chain, contact_stiffness, force = train["chain"], train["contact"]["stiffness_N_m"], train["uplift_force_N"]
    line = Line(case["line"], case["discretisation"]["element_m"])
    step = case["discretisation"]["time_step_s"]
    substeps = math.ceil(step / line.stable_step(contact_stiffness))
    dt, span = step / substeps, case["line"]["geometry"]["span_m"]
    middle = relaxed(line, train["start_m"] + span / 2, force, dt)
    at_rest = relaxed(line, train["start_m"], force, dt)
    k, c, m = (np.array(chain[key]) for key in ("stiffness_N_m", "damping_N_s_m", "masses_kg"))
    on = chain["uplift_force_on"]
    uplift = np.zeros(m.size)
    uplift[chain["names"].index(on) if isinstance(on, str) else on - 1] = force
    working = (middle + at_rest) / 2 + force / contact_stiffness
    z, v = np.zeros(m.size), np.zeros(m.size)
    z[-1] = at_rest + force / contact_stiffness
    for i in range(m.size - 1, 0, -1):
        z[i - 1] = z[i] - (uplift[i:].sum() - force) / k[i]
    steps = round((train["end_m"] - train["start_m"]) / speed / step)
    history = np.zeros((steps, 4 + line.supports.size))
    pressed = force
    for n in range(steps):
        for sub in range(substeps):
            x = train["start_m"] + speed * (n * step + (sub + 1) * dt)
            at = line.points([x])
            line.step(dt, at, pressed)
            below, below_v = np.concatenate([[working], z[:-1]]), np.concatenate([[0.0], v[:-1]])
            springs = k * (z - below) + c * (v - below_v)
            load = uplift - springs + np.append(springs[1:], 0.0)
            load[-1] -= pressed
            v += dt * load / m
            z += dt * v
            wire = float(at.of(line.height + line.contact.w)[0])
            pressed = contact_stiffness * max(0.0, z[-1] - wire)
        history[n] = [(n + 1) * step, x, pressed, wire, *line.arms.of(line.contact.w)]
    return line.supports, history
