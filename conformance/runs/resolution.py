"""Warnings on a run of the reference simulator: resolution of bands, active window, effects that are left out.

Time. Average acceleration changes the period of a vibration of frequency f by (2 pi f dt)^2 / 12 (Newmark's method with
beta = 1/4; Bathe, Finite Element Procedures). The mass correction removes this error from the wires, but not from the
pantograph.

Elements. The local stiffness of the wire varies along an element. A pantograph of speed v meets v / h elements per
second: the contact force gets content around this frequency, with side bands as wide as the motion of the pantograph,
20 Hz. The lower side band must lie above the band. The filter of the band up to 20 Hz passes content up to 30 Hz; the
band 20-50 Hz has sharp edges.
"""

import math
from functools import cache
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import QuantityName
from pantocheck.conformance.core.sourced_table import InputTable, Positive
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.supported_frequency import SupportedFrequency
from pantocheck.model import DiscretisedLine
from pantocheck.model.discretisation.discretised_line import max_wave_speed

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


def list_mesh_frequencies(case: Case, discretisation: Discretisation) -> tuple[SupportedFrequency, ...]:
    """Highest frequencies that elements and time step of a run support, by the rules of `resolution_warnings`."""
    h, dt, margin = discretisation.element_m, discretisation.time_step_s, LOWEST_PASSING_HZ[50.0] - 50.0
    return (
        SupportedFrequency(
            part="elements",
            frequency_Hz=float(f"{max(case.speed / h - margin, 0.0):.4g}"),
            basis=f"elements passed per second, minus the band of the motion of the pantograph, {margin:g} Hz",
        ),
        SupportedFrequency(
            part="time step",
            frequency_Hz=float(f"{longest_time_step(1.0) / dt:.4g}"),
            basis=f"change of the period by {100 * LARGEST_PERIOD_ERROR:g} %",
        ),
    )


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


# Active window of a passage: warning where waves that its edges reflect return to a pantograph.
def smallest_reach(wave_speed: float, speed: float, duration: float) -> float:
    """Smallest half-width of an active window from whose edges no wave returns before the end of a run.

    A wave of speed c needs the time R / (c - v) to get R ahead of a pantograph of speed v, and R / (c + v) to return
    from there; behind the pantograph the two are exchanged.

    Args:
        wave_speed: Speed of the fastest wave [m/s].
        speed: Speed of the pantographs [m/s].
        duration: Simulated time [s].

    Returns:
        Half-width [m]; infinite for a train faster than the waves.
    """
    c, v = wave_speed, speed
    return duration * (c * c - v * v) / (2 * c) if v < c else math.inf


def window_warnings(case: Case, line: DiscretisedLine, discretisation: Discretisation) -> tuple[str, ...]:
    """Warn of an active window (`reach_m`) from whose edges waves return; none without a limited window.

    Args:
        case: Case with a speed.
        line: Line of the case.
        discretisation: Discretisation with the half-width of the window.
    """
    reach, length = discretisation.reach_m, float(line.mesh.position[-1] - line.mesh.position[0])
    smallest = smallest_reach(max_wave_speed(line), case.speed, (case.end - case.start) / case.speed)
    if reach is None or reach >= min(smallest, length):
        return ()
    return (
        f"active window: its edges, {reach:g} m from the train, reflect waves that return before the end of the run "
        f"and change the contact force. Leave out reach_m, or set it to at least {math.ceil(min(smallest, length))}",
    )


# Model uncertainty of the reference simulator: sizes of effects that its equations leave out, from the library.
FILE = "model_uncertainty.toml"
"""File of the library."""

Sizes = Annotated[dict[QuantityName, Positive], Field(default_factory=dict)]


class Effect(InputTable):
    """Effect that the equations leave out, and its size on one line."""

    along_track: Literal["free", "fixed"] | None = None
    """Lines that it concerns: fixed: those with a fixed messenger_support; default: all lines."""
    effect: Annotated[str, Field(max_length=200)]
    """Equation of the simulator and effect that it leaves out."""
    compared: Annotated[str, Field(max_length=200)]
    """Line, speed and mesh of the comparison."""
    source: str
    """Source of the sizes: a key of sources.toml, or free text."""
    relative_pct: Sizes
    """Size of the effect on quantities, relative to the value [%]."""
    absolute: Sizes
    """Size of the effect on quantities, in their units."""

    @property
    def sentence(self) -> str:
        """Sizes in one sentence for the reader of a report."""
        labels = {name: quantity.label for name, quantity in QUANTITIES.items()}
        sizes = [f"{labels[name]}: {size:g} %" for name, size in self.relative_pct.items()]
        sizes += [f"{labels[name]}: {size:g} {QUANTITIES[name].unit}" for name, size in self.absolute.items()]
        return f"{self.effect} ({self.compared}). {'; '.join(sizes)}. Source: {source_text(self.source)}."


class ModelUncertaintyFile(InputTable):
    """Content of the file of model uncertainties."""

    effect: Annotated[tuple[Effect, ...], Field(strict=False)]
    """Effects that the equations leave out."""


@cache
def read_effects() -> tuple[Effect, ...]:
    """Effects of the library."""
    return read_model(library_folder() / FILE, ModelUncertaintyFile, "model uncertainty").effect


def list_model_uncertainty(case: Case) -> tuple[str, ...]:
    """Sentences on the effects that the reference simulator leaves out in a passage of a case."""
    along_track = "fixed" if case.line.supports_fixed_along_track else "free"
    return tuple(effect.sentence for effect in read_effects() if effect.along_track in (None, along_track))
