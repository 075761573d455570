"""Pantographs that another program moves, coupled to the line in every time step.

          line: one step of all its forces        other program: one step under a held force
  z = z_r - Y (F - F_r)  ->  force F at the end  ->  mean of F before and after  ->  height z_r

The line sees such a pantograph as the affine map of its step: the height of each strip at the end, by the force at the
end. The map is exact for a linear program. With state rollback, the step of both is repeated until the heights of both
agree, which is the implicit step of the line. Without, the map is predicted, and the program advances once: heights
are extrapolated by the mass that its head has within a step, so that the coupling is stable although it is explicit
(interface Jacobians: Sicklinger et al. 2014, doi:10.1002/nme.4637).

The force is held at its mean over the step. Average acceleration does the same to a built-in pantograph, so that a
program with the midpoint rule gives its motion. Both sides see the same work if their heights agree; their difference
is energy that the coupling makes (residual energy: Sadjina et al. 2017, doi:10.1007/s00366-016-0492-8).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import DidNotConverge, ImpossiblePassage
from pantocheck.model.description.pantograph import ContactStrip, Pantograph, equilibrium
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_workspace
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.passage import Coupling, ForeignPantograph
from pantocheck.model.dynamics.recording import Recording, bind_single_steps, refuse_divergence
from pantocheck.model.dynamics.train import Train

HEIGHT_TOLERANCE = 1e-9
"""Largest difference of the heights of both sides after an iterated step [m]: 5e-5 N on a contact of 50 kN/m."""
LARGEST_DIFFERENCE = 1e-6
"""Largest difference that a program with coarse numbers may leave after `ATTEMPTS_PER_STEP` [m]."""
ATTEMPTS_PER_STEP = 25
PROBE = 1.0
"""Additional force that measures the admittance of a strip [N]."""
HOLDING_STEPS, REST_STEPS, LONGEST_HOLDING = 400, 250, 20_000
"""Steps over which a head is brought to its start, steps at rest before the passage, and largest number of steps."""
FORCE_SHARE = 0.02
"""Largest difference of the force at rest from that of the linear model [-]."""
REST_FORCE = 2e-3
"""Largest change of the holding force in `REST_STEPS` [N]."""


def build_interface(pantograph: Pantograph) -> Pantograph:
    """Pantograph whose unknowns are the heights of its strips, with the contacts and the static force of another."""
    size, shares = len(pantograph.strips), pantograph.strip_shares
    strips = tuple(
        ContactStrip(strip.offset, unit[None]) for strip, unit in zip(pantograph.strips, np.eye(size), strict=True)
    )
    return replace(
        pantograph,
        mass=np.eye(size),
        damping=np.zeros((size, size)),
        stiffness=np.zeros((size, size)),
        head=np.full(size, 1 / size),
        force=pantograph.static_force * shares,
        own_strips=strips,
        joints=(),
    )


@dataclass
class Interface:
    """Interface of one pantograph of the train and its program, with the last steps."""

    program: ForeignPantograph
    number: int
    """Pantograph of the train, from 0."""
    strips: slice
    """Its strips in the train."""
    height: Array
    """Heights of the strips at the end of the last step, (strips,) [m]."""
    force: Array
    """Forces on them there, downwards, (strips,) [N]."""
    admittance: Array
    """Fall of each height in a step per force held over it, (strips, strips) [m/N]."""
    velocity: Array = field(init=False)
    """Velocity of each strip, by the trapezoidal rule of its heights, (strips,) [m/s]."""
    before: Array = field(init=False)
    """Heights one step before, (strips,) [m]."""
    held: Array = field(init=False)
    """Forces held over the last step, (strips,) [N]."""
    curvature: list[Array] = field(init=False)
    """Second differences of the heights without the held forces, in the last two steps, (strips,) each [m]."""
    coupling: Coupling = field(default_factory=Coupling)

    def __post_init__(self) -> None:
        self.velocity, self.before, self.held = np.zeros_like(self.height), self.height, self.force
        self.curvature = [2 * self.admittance @ self.force] * 2

    def predict(self) -> Array:
        """Height at the end of the next step under the force of the last one; the free head is extrapolated."""
        free = 2 * self.curvature[-1] - self.curvature[-2]
        return 2 * self.height - self.before + free - self.admittance @ (self.held + self.force)

    def load(self, train: Train, time_step: float, height: Array, force: Array) -> None:
        """Give the train the map of the next step: heights under a force at its end, and their change with it."""
        n, p = height.size, self.number
        predicted = height + self.admittance @ force / 2
        train.inverse[p, :n, :n] = self.admittance * 2 / time_step**2
        train.damping[p], train.stiffness[p], train.force[p], train.z[:, p] = 0.0, 0.0, 0.0, 0.0
        train.z[1, p, :n] = 2 / time_step * (predicted - self.height) - self.velocity
        train.z[0, p, :n] = predicted - time_step * train.z[1, p, :n]

    def pressing(self, train: Train) -> Array:
        """Force on each strip at the end of a step, with that of a ramp, (strips,) [N]."""
        held, elapsed, ramp = 0.0, train.elapsed[0], train.ramp[0]
        if elapsed < ramp:
            held = (1 + math.cos(math.pi * elapsed / ramp)) / 2
        return np.asarray(train.contact[self.strips].sum(axis=1) + held * train.held[self.strips])

    def attempt(self, force: Array) -> Array:
        """Height of each strip after a step of the program that ends with a force on each strip, (strips,) [m]."""
        return self.program.attempt((self.force + force) / 2)

    def seen_height(self, train: Train) -> Array:
        """Height of each strip that the line has seen at the end of a step, (strips,) [m]."""
        return np.array(train.z[0, self.number, : self.height.size])

    def accept(self, time_step: float, height: Array, force: Array, line_height: Array, attempts: int) -> None:
        """Keep a step: heights of the program, forces, and heights that the line has seen."""
        self.program.accept()
        mean, rise = (self.force + force) / 2, height - self.height
        free = height - 2 * self.height + self.before + self.admittance @ (self.held + mean)
        self.curvature = [self.curvature[-1], free]
        self.before, self.height, self.force, self.held = self.height, height, force, mean
        self.velocity = 2 / time_step * rise - self.velocity
        self.coupling = self.coupling.add(mean, rise, line_height - height, attempts)


def start_interfaces(
    programs: Sequence[ForeignPantograph | None], pantographs: Sequence[Pantograph], train: Train, time_step: float
) -> list[Interface]:
    """Bring every program to rest with its head at the start of a train; their admittances are measured first.

    Raises:
        ImpossiblePassage: A program presses with another force than the pantograph that it stands for.
    """
    interfaces = []
    for number, (program, pantograph) in enumerate(zip(programs, pantographs, strict=True)):
        if program is None:
            continue
        strips = slice(*train.first_strip[number : number + 2])
        size = strips.stop - strips.start
        height, force = train.z[0, number, :size].copy(), train.force[number, :size].copy()
        admittance = measure_admittance(program, force)
        resting = hold_head(program, height, force, admittance, time_step)
        expected = float(equilibrium(pantograph, height)[1].sum())
        accepted = FORCE_SHARE * expected + sum(max(-joint.lower, 0.0) for joint in pantograph.joints)
        if not abs(resting.sum() - expected) <= accepted:
            raise ImpossiblePassage(
                f"pantograph {number + 1} is held with {resting.sum():.2f} N at its start by its program, and with"
                f" {expected:.2f} N by its linear model; the forces must agree within {accepted:.2f} N"
            )
        train.held[strips] = resting if train.ramp[0] > 0 else 0.0
        interfaces.append(Interface(program, number, strips, height, resting, admittance))
    return interfaces


def measure_admittance(program: ForeignPantograph, force: Array) -> Array:
    """Fall of every strip in the first step per force on each of them, (strips, strips) [m/N].

    Raises:
        ImpossiblePassage: A strip rises under a force that presses it down, or does not move.
    """
    program.restart()
    heights, columns = program.attempt(force), []
    for unit in np.eye(force.size):
        program.restart()
        columns.append(heights - program.attempt(force + PROBE * unit))
    program.restart()
    admittance = np.array(columns).T / PROBE
    for strip, fall in enumerate(np.diag(admittance), 1):
        if not fall > 0:
            raise ImpossiblePassage(
                f"strip {strip} of a foreign pantograph falls by {fall:.3g} m in a step under an additional force of"
                f" {PROBE:g} N downwards; a positive number is needed: check the sign of its force, and whether its"
                " height answers within the step"
            )
    return admittance


def hold_head(program: ForeignPantograph, height: Array, force: Array, admittance: Array, time_step: float) -> Array:
    """Hold the strips at a height until a program is at rest; forces that hold them there, (strips,) [N].

    A spring and a damper on the mass that a strip has within a step lead it from its first height; the integral of the
    rest of the distance ends there without an error.

    Raises:
        DidNotConverge: The program does not come to rest.
    """
    stiffness = 5e-3 / np.diag(admittance)  # a tenth of a radian per step
    integral, changes = force.astype(float), np.inf
    first = before = last = program.attempt(force)
    recent: list[Array] = []
    for step in range(LONGEST_HOLDING):
        program.accept()
        share = (1 - math.cos(math.pi * min(step / HOLDING_STEPS, 1.0))) / 2
        distance = last - (first + share * (height - first))
        integral = integral + 0.02 * stiffness * distance
        pressing = integral + stiffness * (distance + 20 * (last - before))
        before, last = last, program.attempt(pressing)
        recent = [*recent[1 - REST_STEPS :], pressing]
        if step > HOLDING_STEPS + REST_STEPS and step % 50 == 0:
            changes = np.ptp(recent, axis=0).max()
            if not math.isfinite(changes):
                break
            if changes < REST_FORCE and np.abs(last - height).max() < 1e-7:
                program.accept()
                return np.asarray(pressing)
    raise DidNotConverge(
        "a foreign pantograph whose head is held does not come to rest within"
        f" {LONGEST_HOLDING * time_step:g} s: the force changes by {changes:.3g} N in {REST_STEPS * time_step:g} s"
    )


def couple_steps(
    kernel: KernelArrays,
    motion: Motion,
    train: Train,
    interfaces: Sequence[Interface],
    recording: Recording,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Advance line, train and programs by the steps of a recording, and fill it; see `recording.simulate_steps`."""
    work, steps, dt = build_workspace(kernel, train), len(recording.contact), kernel.time_step
    advance_once = bind_single_steps(kernel, motion, train, work, recording)
    moved: list[Array | Indices] = [motion.w, motion.r, motion.force, motion.active]
    moved += [train.position, train.elapsed, train.z, train.contact, train.joint_force]
    kept = [array.copy() for array in moved]
    repeated = [k for k, interface in enumerate(interfaces) if interface.program.can_repeat]
    for n in range(steps):
        for copy, array in zip(kept, moved, strict=True):
            copy[...] = array
        maps = [(interface.predict(), interface.force) for interface in interfaces]
        for attempt in range(1, ATTEMPTS_PER_STEP + 1):
            for interface, (height, force) in zip(interfaces, maps, strict=True):
                interface.load(train, dt, height, force)
            advance_once(n)
            forces = [interface.pressing(train) for interface in interfaces]
            heights = {k: interfaces[k].attempt(forces[k]) for k in repeated}
            seen = [interface.seen_height(train) for interface in interfaces]
            worst = max((float(np.abs(heights[k] - seen[k]).max()) for k in repeated), default=0.0)
            if worst < HEIGHT_TOLERANCE or (attempt == ATTEMPTS_PER_STEP and worst < LARGEST_DIFFERENCE):
                break
            if attempt == ATTEMPTS_PER_STEP or not math.isfinite(worst):
                refuse_divergence(n, dt)
            for k in repeated:
                maps[k] = (heights[k], forces[k])
            for copy, array in zip(kept, moved, strict=True):
                array[...] = copy
        for k, interface in enumerate(interfaces):
            height = heights[k] if k in heights else interface.attempt(forces[k])
            interface.accept(dt, height, forces[k], seen[k], attempt)
        if progress and (n + 1) % 500 == 0:
            progress((n + 1) / steps)
