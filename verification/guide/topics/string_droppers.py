"""Topic: dropper lengths, for strings in closed form and with the bending of the wires."""

import numpy as np

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.model import Catenary, discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.discretisation.string_statics import compute_string_state, remove_staggers
from verification.guide.comparisons import compare_absolute
from verification.guide.guide_format import Topic

_CASE = "en50318-2018/ac-simple/static"
_STRING_TOLERANCE_MM = 0.02
"""Tolerance of the string statics [mm]: the end spans of the library line act on its middle span by less."""


def study_dropper_lengths() -> Topic:
    """All dropper lengths of a span of AC simple."""
    (case,) = select_cases([_CASE])
    first, last = case.line.geometry.span(case.line.middle_span)
    catenary = remove_staggers(build_catenary(case.line))
    inside = [k for k, dropper in enumerate(catenary.droppers) if first < dropper.position < last]
    x = np.array([catenary.droppers[k].position for k in inside])
    strings = compute_string_state(catenary).dropper_length[inside]
    exact = _string_lengths(catenary, (first, last), x)
    bending = discretise(catenary, 0.25).state.dropper_length[inside]
    return Topic(
        title="Dropper lengths of AC simple",
        theory="Loaded strings: the prescribed heights of the contact wire give the force of each dropper, the forces "
        "and weights give the shape of the messenger wire. This is the calculation of dropper tables by hand.",
        setting=f"Line of {_CASE} without stagger, middle span; strings, and beams with elements of 0.25 m.",
        comparisons=[
            compare_absolute(
                f"dropper-{k}",
                f"length of dropper {k}",
                "mm",
                (1e3 * a, 1e3 * b),
                _STRING_TOLERANCE_MM,
                "Closed form of one of many equal spans; rounding, and the end spans of the line.",
            )
            for k, (a, b) in enumerate(zip(strings, exact, strict=True), 1)
        ],
        charts=[
            Chart(
                caption="Additional length of each dropper by the bending stiffness of the wires.",
                alternative="Bending makes every dropper of the span longer by about four millimetres. The line is the "
                "part of the messenger wire, which is rounded at its supports; the rest is due to the contact wire.",
                x_label="position in the span [m]",
                y_label="additional length [mm]",
                series=[
                    Series(
                        label="weight of a span √(EI/T) / 2T",
                        style="line",
                        x=[0.0, last - first],
                        y=[1e3 * _rounding_of_supports(catenary, (first, last))] * 2,
                    ),
                    Series(
                        label="elements of 0.25 m",
                        style="points",
                        x=(x - first).tolist(),
                        y=(1e3 * (bending - strings)).tolist(),
                    ),
                ],
            )
        ],
    )


def _string_lengths(catenary: Catenary, span: tuple[float, float], x: RealArray) -> RealArray:
    """Dropper lengths of one of many equal spans, by the statics of loaded strings [m]."""
    first, length = span[0], span[1] - span[0]
    droppers = [dropper for dropper in catenary.droppers if span[0] < dropper.position < span[1]]
    contact, messenger = catenary.contact_wires[0], catenary.wire(droppers[0].upper)
    height = np.array([dropper.contact_wire_height for dropper in droppers], dtype=np.float64)
    mass = np.array([d.mass + d.upper_clamp_mass + d.lower_clamp_mass for d in droppers])
    around = np.concatenate([[x[-1] - length], x, [x[0] + length]])
    slope = np.diff(np.concatenate([height[-1:], height, height[:1]])) / np.diff(around)
    share = contact.mass_per_length * GRAVITY * (around[2:] - around[:-2]) / 2
    load = share - contact.tension * np.diff(slope) + GRAVITY * mass
    place = x - first
    low, high = np.minimum.outer(place, place), np.maximum.outer(place, place)
    support = next(s.height for s in catenary.messenger_supports if abs(s.position - first) < 1e-6)
    weight = messenger.mass_per_length * GRAVITY * place * (length - place) / 2
    drop = (weight + (low * (length - high) / length) @ load) / messenger.tension
    return np.asarray(support - drop - height)


def _rounding_of_supports(catenary: Catenary, span: tuple[float, float]) -> float:
    """Height by which bending lifts the messenger wire between its supports: its slope there times √(EI/T) [m]."""
    droppers = [dropper for dropper in catenary.droppers if span[0] < dropper.position < span[1]]
    contact, messenger = catenary.contact_wires[0], catenary.wire(droppers[0].upper)
    wires = (span[1] - span[0]) * (contact.mass_per_length + messenger.mass_per_length)
    load = GRAVITY * (wires + sum(d.mass + d.upper_clamp_mass + d.lower_clamp_mass for d in droppers))
    return float(load / 2 / messenger.tension * np.sqrt(messenger.bending_stiffness / messenger.tension))
