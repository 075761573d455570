"""Topic: dropper lengths, for strings in closed form and with the bending of the wires."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.guide.comparisons import compare_absolute
from pantocheck.conformance.results.figure_data import Chart, Series
from pantocheck.conformance.results.guide_format import Topic
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, discretise
from pantocheck.model.catenary import GRAVITY
from pantocheck.model.statics.string_statics import compute_string_state, remove_staggers

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
    exact = _string_lengths(catenary, (first, last), x, strings)
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
                caption="Lengths of the droppers of the middle span: strings, and wires with bending stiffness.",
                alternative="Both curves fall towards mid-span; bending makes every dropper 4 to 5 mm longer.",
                x_label="position in the span [m]",
                y_label="length [m]",
                series=[
                    Series(label="loaded strings, closed form", style="line", x=(x - first).tolist(), y=exact.tolist()),
                    Series(label="strings", style="points", x=(x - first).tolist(), y=strings.tolist()),
                    Series(label="with bending", style="points", x=(x - first).tolist(), y=bending.tolist()),
                ],
            )
        ],
    )


def _string_lengths(catenary: Catenary, span: tuple[float, float], x: RealArray, lengths: RealArray) -> RealArray:
    """Dropper lengths of one of many equal spans, by the statics of loaded strings [m].

    The weights of the droppers need their lengths; those of the finite elements serve for them.
    """
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
