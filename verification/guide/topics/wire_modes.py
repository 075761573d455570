"""Topic: natural frequencies of a pinned wire."""

import numpy as np

from pantocheck.model import discretise
from pantocheck.model.modal.modes import compute_modes
from verification.formulations.pinned_wire import pinned_frequencies
from verification.guide.comparisons import build_study, compare_relative
from verification.guide.guide_format import ConvergenceStudy, Topic
from verification.guide.topics.bare_wires import WIRE_BENDING, WIRE_MASS, WIRE_TENSION, build_wire

_LENGTH, _MODE = 60.0, 10
"""Length of the wire [m], and mode of the convergence studies: half a wave is 6 m long."""

_WIRES = {
    "string": ("a string", WIRE_TENSION, 0.0, (2.0, 1.0, 0.5), (6.0, 0.15), "h⁶: the cubic element of a string."),
    "beam": ("a beam", 0.0, 2e4, (2.0, 1.0, 0.5), (4.0, 0.1), "h⁴: the cubic element of a beam without tension."),
}
"""Wires without bending and without tension: words, tension [N], EI [N m2], elements [m], order, and its origin."""


def study_frequencies() -> Topic:
    """Natural frequencies of a contact wire, and their convergence for a string and a beam."""
    modes = compute_modes(discretise(build_wire(_LENGTH), 0.5), 20)
    exact = pinned_frequencies(20, _LENGTH, WIRE_TENSION, WIRE_BENDING, WIRE_MASS)
    reason = "At 12 elements per wave or more, the error of cubic elements is below 1e-6."
    return Topic(
        title="Natural frequencies of a wire",
        theory="f = √((T k² + EI k⁴) / m) / 2π with k = n π / L for a pinned beam with tension. The error of "
        "cubic elements is of order 6 where tension rules and of order 4 where bending rules.",
        setting=f"Contact wire of {_LENGTH:g} m, elements of 0.5 m; convergence in mode {_MODE}.",
        comparisons=[
            compare_relative(
                f"mode-{n}", f"frequency of mode {n}", "Hz", (modes.frequency[n - 1], exact[n - 1]), 1e-6, reason
            )
            for n in (1, 5, 10, 20)
        ],
        convergence=[_study_wire(key) for key in _WIRES],
    )


def _study_wire(key: str) -> ConvergenceStudy:
    words, tension, bending, elements, theory, reason = _WIRES[key]
    exact = pinned_frequencies(_MODE, _LENGTH, tension, bending, WIRE_MASS)[-1]

    def error(element: float) -> float:
        line = discretise(build_wire(_LENGTH, tension, bending), element)
        return float(np.abs(compute_modes(line, _MODE).frequency[-1] / exact - 1))

    results = [(element, error(element)) for element in elements]
    return build_study(key, f"frequency of mode {_MODE} of {words}", "element length [m]", results, theory, reason)
