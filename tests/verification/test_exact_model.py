"""The geometrically exact model against closed forms: pendulum, energy, catenary, taut string."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk

from verification.formulations.exact_forces import (
    allocate_scratch,
    cubic_shares,
    natural_frequencies,
    point_elasticity,
    sum_forces,
)
from verification.formulations.exact_line import Array, Bars, ExactLine, Wires, no_bars, no_springs, no_strings
from verification.formulations.exact_passage import ExactMotion, advance, no_pantograph, relax

pytestmark = pytest.mark.thorough  # numba compiles the model, which no other code uses

GRAVITY = 9.81
SPAN, TENSION, MASS, AXIAL_STIFFNESS, BENDING_STIFFNESS = 50.0, 16e3, 1.08, 13.8e6, 131.7


def build_cable(
    points: int, length: float, axial_stiffness: float, bending: float = 0.0, damping: float = 0.0
) -> tuple[ExactLine, Array]:
    """Cable with both ends held on the x axis, `SPAN` apart, with an unstretched length [m], and straight positions."""
    h = SPAN / (points - 1)
    position = np.zeros((3, points))
    position[0] = np.linspace(0.0, SPAN, points)
    free = np.ones_like(position)
    free[:, [0, -1]] = 0.0
    wires = Wires(
        first=np.array([0]), last=np.array([points - 1]), axial_stiffness=np.array([axial_stiffness]),
        bending_stiffness=np.array([bending]), tension=np.array([TENSION]), spacing=np.array([h]),
        stiffness_coefficient=np.array([damping]),
    )  # fmt: skip
    mass = np.full(points, MASS * h)
    unstretched = np.full(points, length / (points - 1))
    parts = (wires, no_bars(), no_springs(), no_strings())
    return ExactLine(mass, np.zeros(points), free, unstretched, 0.0, *parts), position


def build_pendulum(bars: int) -> tuple[ExactLine, Array]:
    """Massless bars of 1 m and 1e6 N/m in a row, with masses of 1 kg; the first point is held."""
    position = np.zeros((3, bars + 1))
    position[0] = np.arange(bars + 1.0)
    free = np.ones_like(position)
    free[:, 0] = 0.0
    ends = np.stack([np.arange(bars), np.arange(1, bars + 1)], axis=1)
    ones, zeros = np.ones(bars), np.zeros(bars)
    rods = Bars(ends, 1e6 * ones, ones, zeros, zeros, np.zeros(bars, dtype=np.bool_))
    none = np.zeros(0, dtype=np.int64)
    wires = Wires(none, none, *(np.zeros(0) for _ in range(5)))
    parts = (wires, rods, no_springs(), no_strings())
    return ExactLine(np.ones(bars + 1), np.zeros(bars + 1), free, np.ones(bars + 1), GRAVITY, *parts), position


def start(position: Array, velocity: Array | None = None) -> ExactMotion:
    """Motion of a line without a pantograph."""
    rates = np.zeros_like(position) if velocity is None else velocity
    return ExactMotion(position.copy(), rates.copy(), np.zeros(1), np.zeros(1))


def track(line: ExactLine, motion: ExactMotion, dt: float, steps: int) -> tuple[Array, Array]:
    """Positions, and velocities at full steps, of every step."""
    force, scratch = np.zeros_like(motion.position), allocate_scratch(line.mass.size)
    positions, velocities = [], []
    for _ in range(steps):
        positions.append(motion.position.copy())
        before = motion.velocity.copy()
        advance(line, no_pantograph(), motion, dt, 0.0, 0.0, force, scratch)
        velocities.append((before + motion.velocity) / 2)
    return np.array(positions), np.array(velocities)


@pytest.mark.thorough
def test_bar_rotates_as_a_pendulum() -> None:
    """Released from the horizontal, a pendulum needs K(sin^2 45 deg) sqrt(L/g) to its lowest point."""
    # The bar stretches by 3 m g / k = 3e-5 at most, the step is 1/60 of the period of this stretching: 1e-4 is allowed.
    line, position = build_pendulum(1)
    dt = 1e-4
    positions, _ = track(line, start(position), dt, 7000)
    lowest = dt * np.flatnonzero(positions[:, 0, 1] < 0)[0]
    assert lowest == pytest.approx(ellipk(0.5) / np.sqrt(GRAVITY), rel=1e-3)
    assert np.linalg.norm(positions[:, :, 1], axis=1) == pytest.approx(np.ones(7000), abs=1e-4)


@pytest.mark.thorough
def test_double_pendulum_keeps_its_energy() -> None:
    """Large rotations in space: central differences keep the energy to (w dt)^2 / 24, here 1e-3 of the elastic part."""
    line, position = build_pendulum(2)
    velocity = np.zeros_like(position)
    velocity[1, 2] = 2.0
    positions, velocities = track(line, start(position, velocity), 1e-4, 20000)
    lengths = np.linalg.norm(np.diff(positions, axis=2), axis=1)
    kinetic = (velocities**2).sum(axis=(1, 2)) / 2
    energy = kinetic + GRAVITY * positions[:, 2].sum(axis=1) + 1e6 * ((lengths - 1) ** 2).sum(axis=1) / 2
    assert np.ptp(kinetic) > 10.0
    assert np.ptp(energy[1:]) < 2e-3 * np.ptp(kinetic)


@pytest.mark.thorough
def test_plucked_wire_keeps_its_energy_and_damping_takes_it() -> None:
    """A wire plucked by 0.5 m, in z and y: without damping the energy stays, with damping it decreases."""
    spread: dict[float, tuple[float, float, float]] = {}
    for damping in (0.0, 1e-3):
        line, position = build_cable(101, SPAN * (1 - TENSION / AXIAL_STIFFNESS), AXIAL_STIFFNESS, 131.7, damping)
        position[2] = 0.5 * np.sin(np.pi * position[0] / SPAN)
        position[1] = 0.2 * np.sin(2 * np.pi * position[0] / SPAN)
        positions, velocities = track(line, start(position), 5e-5, 12000)
        lengths = np.linalg.norm(np.diff(positions, axis=2), axis=1)
        bent = np.diff(positions, 2, axis=2)
        h = SPAN / 100
        kinetic = MASS * h * (velocities**2).sum(axis=(1, 2)) / 2
        strain = lengths / line.unstretched[0] - 1
        elastic = AXIAL_STIFFNESS * line.unstretched[0] * (strain**2).sum(axis=1) / 2
        bending = 131.7 / (2 * h**3) * (bent**2).sum(axis=(1, 2))
        energy = (kinetic + elastic + bending)[1:]
        spread[damping] = (energy.max() - energy.min(), energy[0] - energy[-1], np.ptp(kinetic))
    conserved, _, moved = spread[0.0]
    assert conserved < 5e-3 * moved
    assert spread[1e-3][1] > 2 * conserved


@pytest.mark.thorough
def test_cable_hangs_in_a_catenary() -> None:
    """Deep sag of a tenth of the span; a chain of 100 links deviates from the catenary by (1 / 100)^2 of 5 m."""
    # The tension m g a cosh(x / a) of the catenary stretches the cable; the stretch of 3 mm would add 5 mm to the sag.
    parameter = brentq(lambda a: a * (np.cosh(SPAN / (2 * a)) - 1) - SPAN / 10, 10.0, 200.0)
    length = 2 * parameter * np.sinh(SPAN / (2 * parameter))
    stretch = MASS * GRAVITY * parameter / 2 * (SPAN + parameter * np.sinh(SPAN / parameter)) / AXIAL_STIFFNESS
    line, position = build_cable(101, length - stretch, AXIAL_STIFFNESS)
    line = line._replace(gravity=GRAVITY)
    position[2] = -(SPAN / 10) * np.sin(np.pi * position[0] / SPAN)
    motion = start(position)
    relax(line, no_pantograph(), motion, 1e-4, 0.0, 10.0, 3.0)
    x, sag = motion.position[0], -motion.position[2]
    expected = parameter * (np.cosh(SPAN / (2 * parameter)) - np.cosh((x - SPAN / 2) / parameter))
    assert sag == pytest.approx(expected, abs=1e-3)


def test_frequencies_and_elasticity_of_a_taut_string() -> None:
    """Lumped masses at distance h lower the frequency of wave number k by (k h)^2 / 24: 5e-4 for mode 3 here."""
    line, position = build_cable(101, SPAN * (1 - TENSION / AXIAL_STIFFNESS), AXIAL_STIFFNESS, BENDING_STIFFNESS)
    line = line._replace(unstretched=np.full(101, SPAN / 100 / (1 + TENSION / AXIAL_STIFFNESS)))
    k = np.arange(1, 4) * np.pi / SPAN
    across = np.sqrt((TENSION * k**2 + BENDING_STIFFNESS * k**4) / MASS) / (2 * np.pi)
    along = np.sqrt(AXIAL_STIFFNESS / MASS) * k / (2 * np.pi)
    assert natural_frequencies(line, position, 3, axes=(2,)) == pytest.approx(across, rel=5e-4)
    # The elastic stretch makes the rod stiffer per unstretched length by T / EA = 1.2e-3.
    assert natural_frequencies(line, position, 3, axes=(0,)) == pytest.approx(along, rel=2e-3)
    # In the middle L / 4 T; points of a chain deflect as those of a string.
    line, position = build_cable(101, SPAN / (1 + TENSION / AXIAL_STIFFNESS), AXIAL_STIFFNESS)
    assert point_elasticity(line, position, np.array([50])) == pytest.approx([SPAN / (4 * TENSION)], rel=1e-3)


def test_slack_dropper_carries_no_force_and_contact_shares_reproduce_a_cubic() -> None:
    line, position = build_pendulum(1)
    rope = line._replace(bars=line.bars._replace(unilateral=np.array([True])), gravity=0.0)
    force = np.zeros_like(position)
    for stretch, tension in ((0.01, 1e4), (-0.01, 0.0)):
        moved = position.copy()
        moved[0, 1] += stretch
        sum_forces(rope, moved, np.zeros_like(position), force, allocate_scratch(2))
        assert force[0] == pytest.approx([tension, -tension])
    # Four points determine a cubic; its value between them is exact.
    places = np.arange(-1.0, 3.0)
    for s in (0.0, 0.3, 1.0):
        assert np.dot(cubic_shares(s), places**3 - 2 * places + 1) == pytest.approx(s**3 - 2 * s + 1)
