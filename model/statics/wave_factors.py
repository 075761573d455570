"""Waves on the wires: the factors by which a line is judged fit for a speed.

Definitions as in Kiessling, Puschmann, Schmieder and Schneider, Contact Lines for Electric Railways.
"""

import math
from collections.abc import Iterable

from pantocheck.model.catenary import Wire


def impedance(wires: Iterable[Wire]) -> float:
    """Wave impedance of parallel wires: the sum of sqrt(T m) [N s/m]."""
    return sum(math.sqrt(wire.tension * wire.mass_per_length) for wire in wires)


def doppler_factor(speed: float, wave_speed: float) -> float:
    """Doppler factor (c - v) / (c + v): how a wave sent ahead is stretched when it comes back to its train.

    Parameters
    ----------
    speed : float
        v of the train [m/s].
    wave_speed : float
        c of the contact wire [m/s].

    Returns
    -------
    float
        [-].
    """
    return (wave_speed - speed) / (wave_speed + speed)


def reflection_coefficient(contact_wires: Iterable[Wire], messenger_wires: Iterable[Wire]) -> float:
    """Share of a wave on the contact wire that a dropper reflects, were it rigid and without mass.

    Parameters
    ----------
    contact_wires, messenger_wires : Iterable[Wire]
        That the dropper joins.

    Returns
    -------
    float
        sqrt(T_m m_m) / (sqrt(T_m m_m) + sqrt(T_c m_c)) [-].
    """
    upper = impedance(messenger_wires)
    return upper / (upper + impedance(contact_wires))


def amplification_coefficient(reflection: float, doppler: float) -> float:
    """Factor by which a wave grows between train and dropper at every turn: reflection over Doppler factor [-]."""
    return reflection / doppler
