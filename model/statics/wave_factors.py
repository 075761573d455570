"""Wave propagation factors of a line: Doppler factor, reflection and amplification coefficient.

Definitions as in Kiessling, Puschmann, Schmieder and Schneider, Contact Lines for Electric Railways.
"""

import math
from collections.abc import Iterable

from pantocheck.model.description.catenary import Wire


def impedance(wires: Iterable[Wire]) -> float:
    """Wave impedance of parallel wires: the sum of sqrt(T m) [N s/m]."""
    return sum(math.sqrt(wire.tension * wire.mass_per_length) for wire in wires)


def doppler_factor(speed: float, wave_speed: float) -> float:
    """Doppler factor (c - v) / (c + v): frequency ratio between a wave sent ahead and its reflection at the train.

    Args:
        speed: Speed v of the train [m/s].
        wave_speed: Wave speed c of the contact wire [m/s].
    """
    return (wave_speed - speed) / (wave_speed + speed)


def reflection_coefficient(contact_wires: Iterable[Wire], messenger_wires: Iterable[Wire]) -> float:
    """Share of a wave on the contact wire that a rigid, massless dropper reflects.

    Args:
        contact_wires, messenger_wires: Wires that the dropper connects.

    Returns:
        Coefficient sqrt(T_m m_m) / (sqrt(T_m m_m) + sqrt(T_c m_c)) [-].
    """
    upper = impedance(messenger_wires)
    return upper / (upper + impedance(contact_wires))


def amplification_coefficient(reflection: float, doppler: float) -> float:
    """Growth of a wave with every reflection between train and dropper: reflection over Doppler factor [-]."""
    return reflection / doppler
