"""Closed forms of tensioned wires, independent of the finite elements."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model.description.catenary import GRAVITY


def wire_sag(x: RealArray, length: float, tension: float, mass: float, bending_stiffness: float) -> RealArray:
    """Deflection of a pinned tensioned beam under its weight [m].

    Args:
        x: Positions, (n,) [m].
        length, tension, mass, bending_stiffness: Length [m], tension T [N], mass per length [kg/m] and bending
            stiffness EI [N m2].

    Returns:
        Deflection of the solution of EI w'''' - T w'' = -m g, (n,); the cosh term is the bending near the ends.
    """
    weight, decay = mass * GRAVITY, np.sqrt(tension / bending_stiffness)
    ends = np.cosh(decay * (x - length / 2)) / np.cosh(decay * length / 2)
    parabola = -weight * x * (length - x) / (2 * tension)
    return np.asarray(parabola + weight * bending_stiffness / tension**2 * (1 - ends))


def point_flexibility(x: RealArray, length: float, tension: float, bending_stiffness: float) -> RealArray:
    """Deflection per force at the force on a pinned tensioned beam [m/N]; parameters as in `wire_sag`."""
    decay = np.sqrt(tension / bending_stiffness)
    # sinh(a) sinh(b) / sinh(a + b) without overflow.
    rounding = (1 - np.exp(-2 * decay * x)) * (1 - np.exp(-2 * decay * (length - x))) / 2
    return np.asarray((x * (length - x) / length - rounding / decay / (1 - np.exp(-2 * decay * length))) / tension)


def moving_load_deflection(times: RealArray, speed: float, wire: tuple[float, float, float, float]) -> RealArray:
    """Deflection under a constant unit force that moves along a pinned beam and enters at one end at t = 0.

    Args:
        times: Times, (n,) [s].
        speed: Speed of the force [m/s].
        wire: Length [m], tension [N], mass per length [kg/m] and bending stiffness [N m2].

    Returns:
        Deflection per force, (n,) [m/N], summed over 4000 modes (Fryba, Vibration of solids and structures, chapter 1).
    """
    length, tension, mass, bending_stiffness = wire
    k = np.arange(1, 4001) * np.pi / length
    natural, driving = np.sqrt((tension * k**2 + bending_stiffness * k**4) / mass), k * speed
    amplitude = 2 / (mass * length) / (natural**2 - driving**2)
    return np.array(
        [
            np.sum(amplitude * (np.sin(driving * t) - driving / natural * np.sin(natural * t)) * np.sin(driving * t))
            for t in times
        ]
    )


def travelling_pulse(
    x: RealArray, pulse: tuple[float, float], wire: tuple[float, float, float], times: RealArray
) -> RealArray:
    """Pulse of 10 mm that travels to the right on a long wire, each wave with its own speed.

    Args:
        x: Equally spaced positions, (n,); the pulse stays away from their ends [m].
        pulse: Centre at t = 0 and standard deviation of the pulse [m, m].
        wire: Tension [N], mass per length [kg/m] and bending stiffness [N m2].
        times: Times, (t,) [s].

    Returns:
        Deflection, velocity and acceleration, (t, 3, 2, n); value and slope of each.
    """
    (centre, width), (tension, mass, bending_stiffness) = pulse, wire
    k = 2 * np.pi * np.fft.rfftfreq(x.size - 1, x[1] - x[0])
    spectrum = np.fft.rfft(0.01 * np.exp(-(((x[:-1] - centre) / width) ** 2) / 2))
    omega = np.sqrt((tension * k**2 + bending_stiffness * k**4) / mass)
    fields = [
        [
            [
                np.fft.irfft(spectrum * (1j * k) ** slope * (-1j * omega) ** rate * np.exp(-1j * omega * t))
                for slope in (0, 1)
            ]
            for rate in range(3)
        ]
        for t in times
    ]
    periodic = np.asarray(fields)
    return np.concatenate([periodic, periodic[..., :1]], axis=-1)
