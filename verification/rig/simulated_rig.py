"""Simulated rig: an actuator with a delay, a force sensor, and a pantograph that presses against them.

`python -m verification.rig.simulated_rig CASE [--port PORT] [--delay MS] [--head-mass FACTOR]` answers over UDP until a
run ends. The pantograph is the chain of the case with changes. A stiff spring is the force sensor between its head and
the actuator, so that force and motion follow from the equations of motion, not from the model that the suite inverts.
"""

import argparse
import socket
from collections import deque
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.app.commands.options import choose_train_case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.runs.rig_link import RigCommand, RigPhase, RigSample, pack_sample, read_command
from pantocheck.conformance.runs.rig_loop import prefer_loop
from pantocheck.conformance.runs.rig_run import build_stepped_passage
from pantocheck.model.description.pantograph import Pantograph, equilibrium

SENSOR_N_M, SENSOR_N_S_M = 1e7, 3e3
"""Stiffness and damping of the force sensor [N/m, N s/m]: the head moves by 20 um under 200 N."""
SUBSTEP_S = 0.25e-3
ACTUATOR_HZ = 100.0
"""Natural frequency of the actuator of the rig that is served [Hz]."""
OWN_WATCHDOG_S = 1.0
"""Time without a command after which the rig ends [s]; that of a real one is some milliseconds."""


@dataclass(frozen=True)
class RigFaults:
    """Properties of a simulated rig."""

    delay_s: float = 0.0
    """From the arrival of a command to its motion."""
    actuator_Hz: float = np.inf
    """Natural frequency of the actuator, with a damping ratio of 0.7."""
    noise_m: float = 0.0
    noise_N: float = 0.0
    """Standard deviation of the noise of height and force."""
    friction_N: float = 0.0
    """Coulomb friction at the first mass of the chain."""


class Path(NamedTuple):
    """Cubic path of the actuator from one command to the next; later it goes on with the last speed."""

    begin: float
    length: float
    """Time of its start, and time to its end [s]."""
    first: tuple[float, float]
    last: tuple[float, float]
    """Height and speed at begin and end [m, m/s]."""

    def at(self, time: float) -> tuple[float, float]:
        """Height and speed at a time."""
        t, (x, v), (y, w), left = self.length, self.first, self.last, time - self.begin
        if left >= t:
            return y + (left - t) * w, w
        s, slope = left / t, (y - x) / t
        b, c = 3 * slope - 2 * v - w, v + w - 2 * slope
        return x + left * (v + s * (b + s * c)), v + s * (2 * b + 3 * s * c)


class SimulatedRig:
    """Rig that rests with its head at a distance from the height at the start of the passage.

    Args:
        pantograph: Pantograph on the rig.
        origin: Height of the head at the start of the passage [m].
        time_step: Time between two commands [s].
        begin: Distance of the head from it [m].
        faults: Properties.
    """

    def __init__(
        self,
        pantograph: Pantograph,
        origin: float,
        time_step: float,
        begin: float = 0.0,
        faults: RigFaults | None = None,
    ) -> None:
        self.faults, self._step, self.time = faults or RigFaults(), time_step, 0.0
        self._random = np.random.default_rng(36)
        self._pantograph, self._head = pantograph, pantograph.head
        h, sensor = SUBSTEP_S, np.outer(pantograph.head, pantograph.head)
        self._damping = pantograph.damping + SENSOR_N_S_M * sensor
        self._stiffness = pantograph.stiffness + SENSOR_N_M * sensor
        self._inverse = np.linalg.inv(pantograph.mass + h / 2 * self._damping + h**2 / 4 * self._stiffness)
        z, force = equilibrium(pantograph, origin + begin)
        self._z: RealArray = z
        self._v = self._a = np.zeros_like(z)
        self._place, self._speed = origin + begin - float(force.sum()) / SENSOR_N_M, 0.0
        self._rest = self._place - begin
        self._path = Path(0.0, 1.0, (self._place, 0.0), (self._place, 0.0))
        self._waiting: deque[tuple[float, RigCommand]] = deque()
        self._force = float(force.sum())
        self.number = self.fault = 0

    def take(self, command: RigCommand) -> None:
        """Take a command at its time, which is its number times the step."""
        self.advance(command.number * self._step)
        self._waiting.append((self.time + self.faults.delay_s, command))

    def advance(self, time: float) -> None:
        """Advance to a time [s]."""
        h = SUBSTEP_S
        while self.time + h / 2 < time:
            while self._waiting and self._waiting[0][0] <= self.time + h / 2:
                command = self._waiting.popleft()[1]
                self.number = command.number
                if RigPhase.APPROACH <= command.phase <= RigPhase.STOP:
                    last = (self._rest + command.height, command.velocity)
                    self._path = Path(self.time, self._step, self._path.at(self.time), last)
            self.time += h
            self._move(h)

    def _move(self, h: float) -> None:
        """Substep of the actuator, then of the pantograph."""
        goal, w = self._path.at(self.time), 2 * np.pi * self.faults.actuator_Hz
        if np.isfinite(w):
            self._speed += h * (w * w * (goal[0] - self._place) + 1.4 * w * (goal[1] - self._speed))
            self._place += h * self._speed
        else:
            self._place, self._speed = goal
        z = self._z + h * self._v + h**2 / 4 * self._a
        v = self._v + h / 2 * self._a
        drive = SENSOR_N_M * self._place + SENSOR_N_S_M * self._speed
        load = self._pantograph.force + self._head * drive - self._damping @ v - self._stiffness @ z
        load[0] -= self.faults.friction_N * np.tanh(self._v[0] / 1e-3)
        self._a = self._inverse @ load
        self._z, self._v = z + h**2 / 4 * self._a, v + h / 2 * self._a
        self._force = SENSOR_N_M * (self._head @ self._z - self._place) + SENSOR_N_S_M * (
            self._head @ self._v - self._speed
        )

    def sample(self) -> RigSample:
        """Sample at the present time."""
        noise = self._random.standard_normal(2) * (self.faults.noise_m, self.faults.noise_N)
        height = self._place - self._rest + noise[0]
        return RigSample(self.fault, self.number, self.time, float(height), float(self._force + noise[1]))


class DirectLink:
    """Exchange with a simulated rig in the same process, in simulated time: one sample per command."""

    def __init__(self, rig: SimulatedRig) -> None:
        self.rig, self.samples = rig, list[RigSample | None]()

    def send(self, command: RigCommand) -> None:
        """Send a command; its sample can be received."""
        self.rig.take(command)
        self.samples.append(self.rig.sample())

    def receive(self) -> list[RigSample | None]:
        """Samples since the last call."""
        found, self.samples = self.samples, []
        return found


class SimulatedClock:
    """Clock that a wait moves."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        """Time [s]."""
        return self.time

    def wait(self, until: float) -> None:
        """Move on to a time [s]."""
        self.time = max(self.time, until)


def change_head(pantograph: Pantograph, mass: float = 1.0, stiffness: float = 1.0) -> Pantograph:
    """Chain with another mass of its head, and other springs and dampers; its force at rest remains."""
    matrix = pantograph.mass.copy()
    matrix[-1, -1] *= mass
    changed = replace(pantograph, mass=matrix, stiffness=stiffness * pantograph.stiffness)
    return replace(changed, damping=stiffness * pantograph.damping)


def serve(rig: SimulatedRig, port: int) -> None:
    """Answer commands over UDP with samples, until a run ends.

    The clock of the rig are the numbers of the commands: a drive has real time, this process has not.
    """
    link, phase = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), RigPhase.CONNECT
    link.bind(("127.0.0.1", port))
    with link:
        while True:
            try:
                message, address = link.recvfrom(1024)
            except TimeoutError:
                print(f"no command for {OWN_WATCHDOG_S:g} s after the phase {phase.name.lower()}", flush=True)
                return
            link.settimeout(OWN_WATCHDOG_S)
            if (command := read_command(message)) is not None:
                phase = command.phase
                rig.take(command)
                link.sendto(pack_sample(rig.sample()), address)


def main() -> None:
    """Serve one run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("--port", type=int, default=5318)
    parser.add_argument("--step", type=float, default=1e-3)
    parser.add_argument("--delay", type=float, default=2.0, help="[ms]")
    parser.add_argument("--head-mass", type=float, default=1.0)
    given = parser.parse_args()
    passage = build_stepped_passage(choose_train_case(given.case, ()), given.step)
    pantograph = change_head(passage.passage.pantographs[0], given.head_mass)
    faults = RigFaults(delay_s=given.delay / 1000, actuator_Hz=ACTUATOR_HZ)
    with prefer_loop():
        serve(SimulatedRig(pantograph, passage.start_height, given.step, -0.05, faults), given.port)


if __name__ == "__main__":
    main()
