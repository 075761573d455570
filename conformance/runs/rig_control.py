"""Control of a rig: a line whose wire moves an actuator under a real pantograph, phase by phase and within limits.

                   line with the linear model of the pantograph
    correction -> added force on its head    -> height, velocity -> actuator
        ^                                                            |  delay
        +-- low-pass( measured force - force of the model )  <-------+-- measured height and force

The linear model predicts the pantograph without delay (Smith 1957). The rig corrects it: under the measured motion of
the head, the model exerts another force than the rig, and this difference acts on the head of the model. A delay
therefore acts on the difference alone; it has no effect if the model is exact. Both forces belong to one sample, so
that the delay need not be known.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

from pantocheck.conformance.runs.rig_link import RigCommand, RigPhase, RigSample
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.dynamics.moved_head import MovedHead
from pantocheck.model.dynamics.stepped_passage import HeadState, SteppedPassage

HOLD_S, MEAN_S, BLEND_S = 3.0, 1.0, 1.0
"""Time at rest before a passage, time at its end over which the force is averaged, and time in which the correction
comes in [s]."""
STOP_S, END_S, BRAKE_S = 0.5, 0.1, 0.02
"""Time of the commands after a stop and after the end, and time constant of the brake [s]."""
APPROACH_M_S, APPROACH_RAD_S = 0.05, 10.0
"""Speed and natural frequency of the approach [m/s, rad/s]."""
STATIC_FORCE_SHARE = 0.2
"""Largest difference of the force at rest from the static force of the case [-]."""


class RigLimits(NamedTuple):
    """Limits of a run; beyond one of them it stops."""

    force: float
    """Largest measured force [N]."""
    travel: float
    """Largest distance of the head from its height at the start, commanded and measured [m]."""
    speed: float
    """Largest commanded speed [m/s]."""
    correction: float
    """Largest correction of the force of the model [N]."""
    watchdog: float
    """Longest time without a sample, largest age of the command that acts, and largest lateness of a step [s]."""
    connection: float
    """Longest time until the first sample [s]."""


class RigRow(NamedTuple):
    """Row of the log; NaN: unknown."""

    time: float
    phase: int
    height: float
    velocity: float
    line_force: float
    correction: float
    measured_height: float
    measured_force: float
    delay: float
    """Age of the command that acted at the last sample [s]."""


class LowPass:
    """Butterworth filter of second order, by the bilinear transform.

    Args:
        cutoff: Cut-off [Hz].
        time_step: Time between two samples [s].
    """

    def __init__(self, cutoff: float, time_step: float) -> None:
        k = math.tan(math.pi * cutoff * time_step)
        gain = 1 / (1 + math.sqrt(2) * k + k * k)
        self._b, self._a = k * k * gain, (2 * (k * k - 1) * gain, (1 - math.sqrt(2) * k + k * k) * gain)
        self._state = [0.0, 0.0]

    def apply(self, x: float) -> float:
        """Filter one sample."""
        y = self._b * x + self._state[0]
        self._state = [2 * self._b * x - self._a[0] * y + self._state[1], self._b * x - self._a[1] * y]
        return y


class RigCorrection:
    """Difference of the forces of rig and model under the measured motion of the head, from rest.

    Args:
        line: Passage of the linear model.
        cutoff: Cut-off of the difference [Hz].
        longest_gap: Largest time between two samples that is filled [s].
        first: First sample.
    """

    def __init__(self, line: SteppedPassage, cutoff: float, longest_gap: float, first: RigSample) -> None:
        self.force, self._dt, self._gap = 0.0, line.passage.time_step, longest_gap
        self._origin, self._last, self._measured = line.start_height, first, first.force
        self._head = MovedHead(line.passage.pantographs[0], self._origin + first.height, self._dt)
        self._filter = LowPass(cutoff, self._dt)

    def add(self, sample: RigSample) -> None:
        """Take the next sample: its values at whole steps on the clock of the rig, linear since the last sample."""
        last, self._last = self._last, sample
        end, span = math.ceil(sample.time / self._dt), sample.time - last.time
        first = max(math.ceil(last.time / self._dt), end - math.ceil(self._gap / self._dt))
        for n in range(first, end):
            share = (n * self._dt - last.time) / span
            height, force = (a + share * (b - a) for a, b in zip(last[3:], sample[3:], strict=True))
            # The force of the model belongs to the value before.
            self.force = self._filter.apply(self._measured - self._head.follow(self._origin + height))
            self._measured = force


class RigControl:
    """Commands of a run, one per step.

    Args:
        line: Passage of the linear model.
        limits: Limits.
        cutoff: Cut-off of the correction [Hz].
        passages: Number of passages.
    """

    def __init__(self, line: SteppedPassage, limits: RigLimits, cutoff: float, passages: int) -> None:
        self.line, self.limits, self.cutoff, self.left = line, limits, cutoff, passages
        self.dt = line.passage.time_step
        self.phase, self.reason, self.finished = RigPhase.CONNECT, "", False
        self.number = self.refused = self.samples = 0
        self._begin = 0
        """Number of the first command of the phase."""
        self._height = self._velocity = self._target = self._line_force = 0.0
        self._last: RigSample | None = None
        self._heard, self._delay, self._resting_force = 0, math.nan, 0.0
        self._rig: RigCorrection | None = None
        self._head = HeadState(0.0, 0.0, line.start_force)

    def advance(self, samples: Iterable[RigSample | None], lateness: float) -> RigCommand:
        """Command of the next step.

        Args:
            samples: Samples since the last step; None: a message that is none.
            lateness: Time from the planned start of the step to its start [s].
        """
        self.number += 1
        for sample in samples:
            self._receive(sample)
        fault = self._find_fault(lateness)
        if fault and self.phase < RigPhase.STOP:
            self._stop(fault)
        actions = {
            RigPhase.CONNECT: self._connect,
            RigPhase.APPROACH: self._approach,
            RigPhase.HOLD: self._hold,
            RigPhase.PASSAGE: self._pass,
            RigPhase.STOP: self._brake,
            RigPhase.END: self._end,
        }
        actions[self.phase]()
        return RigCommand(self.phase, self.number, self._height, self._velocity)

    def row(self) -> RigRow:
        """Row of the log after a step."""
        height, force = (math.nan, math.nan) if self._last is None else self._last[3:]
        motion = (self._height, self._velocity, self._line_force, self._rig.force if self._rig else math.nan)
        return RigRow(self.number * self.dt, int(self.phase), *motion, height, force, self._delay)

    @property
    def _elapsed(self) -> float:
        """Time since the start of the phase [s]."""
        return (self.number - self._begin) * self.dt

    def _enter(self, phase: RigPhase) -> None:
        self.phase, self._begin = phase, self.number

    def _stop(self, reason: str) -> None:
        self.reason = f"{reason}, in phase {self.phase.name.lower()} at {self.number * self.dt:.3f} s"
        self._enter(RigPhase.STOP)

    def _find_fault(self, lateness: float) -> str:
        """First limit that is exceeded; empty: none."""
        limits, silence = self.limits, (self.number - self._heard) * self.dt
        if self._last is None:
            return f"no sample within {limits.connection:g} s" if silence > limits.connection else ""
        faults = (
            (self._last.fault != 0, f"the rig reports the fault {self._last.fault}"),
            (silence > limits.watchdog, f"no sample for {1000 * silence:.0f} ms"),
            (self._delay > limits.watchdog, f"the rig obeys a command of {1000 * self._delay:.0f} ms ago"),
            (lateness > limits.watchdog, f"a step began {1000 * lateness:.0f} ms late"),
            (self._last.force > limits.force, f"the measured force is {self._last.force:.1f} N"),
            (abs(self._last.height) > limits.travel, f"the measured height is {1000 * self._last.height:.1f} mm"),
        )
        moving = faults if self.phase > RigPhase.APPROACH else faults[:-1]
        return next((text for exceeded, text in moving if exceeded), "")

    def _receive(self, sample: RigSample | None) -> None:
        """Take a sample; one that is not a message, is older than the last one, or of a command to come is refused."""
        last = self._last
        if sample is None or sample.number > self.number or (last is not None and sample.time <= last.time):
            self.refused += 1
            return
        self.samples += 1
        self._last, self._heard = sample, self.number
        if sample.number > 0:
            self._delay = (self.number - sample.number) * self.dt
        if self._rig is not None:
            self._rig.add(sample)

    def _connect(self) -> None:
        """Wait for the first sample that obeys a command; the head stays."""
        if self._last is not None:
            self._height = self._target = self._last.height
            if self._last.number > 0:
                self._enter(RigPhase.APPROACH)

    def _approach(self) -> None:
        """Bring the head to the height at the start, or near it after a passage."""
        step = APPROACH_M_S * self.dt
        self._target -= math.copysign(min(step, abs(self._target)), self._target)
        w = APPROACH_RAD_S
        self._velocity += self.dt * (w * w * (self._target - self._height) - 2 * w * self._velocity)
        self._height += self.dt * self._velocity
        if self._target == 0 and abs(self._height) < 1e-6 and abs(self._velocity) < 1e-5:
            self._height = self._velocity = 0.0
            self._enter(RigPhase.HOLD if self.left else RigPhase.END)
            self._resting_force = 0.0

    def _hold(self) -> None:
        """Rest at the height at the start; the measured force must be near the static force of the case."""
        if self._last is None:
            return
        if self._elapsed > HOLD_S - MEAN_S:
            self._resting_force += self._last.force * self.dt / MEAN_S
        if self._rig is None and self._elapsed > HOLD_S / 3:
            self._rig = RigCorrection(self.line, self.cutoff, self.limits.watchdog, self._last)
        if self._elapsed >= HOLD_S:
            static = self.line.start_force
            if abs(self._resting_force - static) > STATIC_FORCE_SHARE * static:
                self._stop(f"the mean force at rest is {self._resting_force:.1f} N, and {static:.1f} N in the case")
                return
            self.line.restart()
            self._enter(RigPhase.PASSAGE)

    def _pass(self) -> None:
        """Step of the line."""
        blend = (1 - math.cos(math.pi * min(self._elapsed / BLEND_S, 1.0))) / 2
        added = blend * self._rig.force if self._rig else 0.0
        if fault := self._find_excess(added):
            self._stop(fault)
            self._brake()
            return
        self._height, self._velocity, self._line_force = self._head
        if self.line.step == self.line.steps:
            self.left -= 1
            self._target = self._height
            self._rig = None
            self._enter(RigPhase.APPROACH)

    def _find_excess(self, added: float) -> str:
        """Advance the line; limit that its head or the correction exceeds, empty: none."""
        if not abs(added) <= self.limits.correction:
            return f"the correction is {added:.1f} N: the pantograph of the rig is not that of the case"
        try:
            self._head = self.line.advance(added)
        except SimulationError as error:
            return f"{error}"
        if not abs(self._head.height) <= self.limits.travel:
            return f"the height of the line is {1000 * self._head.height:.1f} mm"
        if not abs(self._head.velocity) <= self.limits.speed:
            return f"the head of the line moves with {self._head.velocity:.2f} m/s"
        return ""

    def interrupt(self) -> None:
        """Stop as for a limit."""
        if self.phase < RigPhase.STOP:
            self._stop("the run was interrupted")

    def _brake(self) -> None:
        """Bring the head to rest within the travel; the rig holds it, or lowers it, from then on."""
        self._velocity *= math.exp(-self.dt / BRAKE_S)
        moved = self._height + self.dt * self._velocity
        self._height = min(max(moved, -self.limits.travel), self.limits.travel)
        self.finished = self._elapsed >= STOP_S

    def _end(self) -> None:
        self.finished = self._elapsed >= END_S
