"""Influence of the start on a section close behind it: a head that is released against an uplift force that rises.

    python -m verification.formulations.start_influence

Both starts end with the same forces, and both are in use: the reference simulator holds the head down on the displaced
frame and releases it; other codes let the uplift force rise, so that the frame moves up first. The same kernel computes
both, on lines that get one element after the other.
"""

from dataclasses import replace
from itertools import accumulate

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import (
    Catenary,
    DiscretisedLine,
    Dropper,
    Kind,
    MessengerSupport,
    Passage,
    PointMass,
    Rayleigh,
    SectionChange,
    SimulationError,
    SteadyArm,
    Wire,
    build_chain,
    discretise,
)
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import bind_arrays
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion

SPANS = (60.0, 55.0, 65.0, 50.0, 60.0, 45.0, 65.0, 55.0, 60.0, 50.0, 65.0, 60.0, 55.0, 60.0)
"""Unequal spans [m]."""
HEAD = build_chain(
    np.array([6.0, 9.0, 7.5]), np.array([160.0, 15500.0, 7000.0]), np.array([100.0, 0.1, 45.0]), 160.0, 0, 5e4
)
RAMP_S, SPEED, STEP, ELEMENT = 0.8, 300 / 3.6, 1e-3, 0.5
SECTION = (575.0, 755.0)
"""Section of the review that found the difference [m]."""


def build_line(spans: tuple[float, ...], irregular: float) -> Catenary:
    """Simple line with heights of the contact wire at droppers that scatter by up to `irregular` [m]."""
    limits = list(accumulate(spans, initial=0.0))
    scatter, droppers = np.random.default_rng(0), []
    for start, span in zip(limits, spans, strict=False):
        for x in np.linspace(4.5, span - 4.5, round((span - 9) / 6.2) + 1):
            sag = 4e-3 * span * (x - 4.5) * (span - 4.5 - x) / (span - 9) ** 2
            height = -sag + float(scatter.uniform(-1, 1)) * irregular
            droppers.append(Dropper(start + float(x), "messenger", "contact", 1e5, contact_wire_height=height))
    damping = {Kind.CONTACT_WIRE: Rayleigh(0.02, 1e-4), Kind.MESSENGER_WIRE: Rayleigh(0.02, 1e-4)}
    return Catenary(
        wires=(
            Wire("contact", Kind.CONTACT_WIRE, 0.0, limits[-1], 22e3, 1.35, 195.0),
            Wire("messenger", Kind.MESSENGER_WIRE, 0.0, limits[-1], 16e3, 1.08, 131.7),
        ),
        droppers=tuple(droppers),
        steady_arms=tuple(SteadyArm(x, "contact", 250.0, mass=0.5) for x in limits[1:-1]),
        messenger_supports=tuple(MessengerSupport(x, "messenger", 1.25, 5e5, 1e3) for x in limits[1:-1]),
        damping=damping,
    )


def simulate(line: DiscretisedLine, start: float, rising: bool) -> RealArray:
    """Contact force inside the section with one of the two starts at a position [m]."""
    steps = int((SECTION[1] - start) / SPEED / STEP) + 1
    kernel = build_kernel_arrays(line, STEP)
    way = Passage((HEAD,), (start,), SPEED, steps * STEP, STEP, ramp=RAMP_S)
    motion, train = start_motion(line, kernel, way)
    if rising:
        height = float(HEAD.head @ train.z[0, 0])
        train.z[0, 0, :], train.held[0] = height, 0.0
        carried = float(HEAD.stiffness[0].sum()) * height
    work, force = build_workspace(kernel, train), np.zeros(steps)
    advance = bind_arrays(step, kernel, motion, train, work)
    for n in range(steps):
        if rising:
            share = (1 - np.cos(np.pi * min((n + 1) * STEP / RAMP_S, 1.0))) / 2
            train.force[0, 0] = carried + share * (HEAD.static_force - carried)
        if not advance():
            raise SimulationError("the forces of a time step did not converge")
        force[n] = train.contact.sum()
    position = start + SPEED * STEP * np.arange(1, steps + 1)
    return np.asarray(force[(position >= SECTION[0]) & (position < SECTION[1])])


def compare_starts(line: DiscretisedLine, start: float) -> tuple[float, float, float]:
    """Released head against rising force: change of the RMS in 0-20 and 5-20 Hz [%], and RMS of the difference [N]."""
    released, rising = (simulate(line, start, is_rising) for is_rising in (False, True))
    change = [100 * (band(released, low) / band(rising, low) - 1) for low in (0.0, 5.0)]
    return change[0], change[1], float(np.sqrt(np.mean((released - rising) ** 2)))


def band(force: RealArray, low: float) -> float:
    """RMS from a frequency to 20 Hz [N]."""
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, STEP)
    return float(np.sqrt(power[(frequency > low) & (frequency <= 20.0)].sum()))


def main() -> None:
    """Print a row per line and start."""
    unequal = build_line(SPANS, 0.0)
    heights = build_line(SPANS, 2e-3)
    masses = replace(heights, point_masses=(PointMass(602.0, "contact", 6.0), PointMass(700.0, "messenger", 10.0)))
    worn = replace(masses.wires[0], section_changes=(SectionChange(620.0, 690.0, -0.27, -98.4),))
    all_elements = replace(masses, wires=(worn, masses.wires[1]))
    rows = {"equal spans": build_line((57.5,) * 14, 0.0), "unequal spans": unequal, "and heights": heights}
    rows |= {"and masses": masses, "and wear": all_elements}
    places = [(name, catenary, 480.0) for name, catenary in rows.items()]
    for name, catenary, start in (*places, ("all of them", all_elements, 300.0), ("all of them", all_elements, 115.0)):
        wide, narrow, difference = compare_starts(discretise(catenary, ELEMENT), start)
        print(f"| {name} | {start:g} | {wide:+.2f} % | {narrow:+.2f} % | {difference:.1f} N |", flush=True)


if __name__ == "__main__":
    main()
