"""Resolution of a frequency band by elements and time step of the reference simulator.

Time. Average acceleration changes the period of a vibration of frequency f by (2 pi f dt)^2 / 12 (Newmark's method with
beta = 1/4; Bathe, Finite Element Procedures). The mass correction removes this error from the wires, but not from the
pantograph.

Elements. The local stiffness of the wire varies along an element. A pantograph of speed v meets v / h elements per
second: the contact force gets content around this frequency, with side bands as wide as the motion of the pantograph,
20 Hz. The lower side band must lie above the band. The filter of the band up to 20 Hz passes content up to 30 Hz; the
band 20-50 Hz has sharp edges.
"""

import math

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE

LARGEST_PERIOD_ERROR = 0.01
"""Largest relative error of the period at the upper edge of a band: 18 steps per period."""

LOWEST_PASSING_HZ = {20.0: 50.0, 50.0: 70.0}
"""Smallest frequency at which a pantograph passes elements, by the upper edge of a reported band [Hz]."""


def period_error(frequency: float, time_step: float) -> float:
    """Relative change of the period of a vibration of a frequency [Hz] by average acceleration, time step in [s]."""
    return (2 * math.pi * frequency * time_step) ** 2 / 12


def longest_time_step(frequency: float) -> float:
    """Longest time step [s] with an accepted change of the period at a frequency [Hz]."""
    return math.sqrt(12 * LARGEST_PERIOD_ERROR) / (2 * math.pi * frequency)


def longest_element(speed: float, frequency: float) -> float:
    """Longest element [m] for a band up to 20 or 50 Hz at a speed [m/s]."""
    return speed / LOWEST_PASSING_HZ[frequency]


def resolution_warnings(case: Case, discretisation: Discretisation) -> tuple[str, ...]:
    """Warnings on elements and a time step that are too coarse for a reported band, with the largest suitable value.

    Args:
        case: Case with a speed.
        discretisation: Element length and time step of the reported run.
    """
    warnings = []
    h, dt = discretisation.element_m, discretisation.time_step_s
    for edge, passing in LOWEST_PASSING_HZ.items():
        if edge > HIGHEST_SHARE_OF_RATE / dt:
            continue  # quantities of this band are not available
        longest_dt, longest_h = longest_time_step(edge), longest_element(case.speed, edge)
        if dt > longest_dt:
            warnings.append(
                f"time step: {1e3 * dt:g} ms changes the period at {edge:g} Hz by "
                f"{100 * period_error(edge, dt):.2g} %: quantities up to {edge:g} Hz are not accurate. "
                f"Set time_step_s to at most {_round_down(longest_dt)}"
            )
        if h > longest_h:
            warnings.append(
                f"element length: a pantograph passes {case.speed / h:.3g} elements of {h:g} m per second; quantities "
                f"up to {edge:g} Hz need {passing:g}. Set element_m to at most {_round_down(longest_h)}"
            )
    return tuple(warnings)


def _round_down(value: float) -> str:
    """A positive value with two significant digits, not above it, so that the remedy of a warning removes it."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.floor(value / digit) * digit:.2g}"
