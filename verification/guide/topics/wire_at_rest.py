"""Topic: sag of a wire under its weight, and its deflection under a point force."""

import numpy as np

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.model import discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.statics.elasticity import static_uplift
from verification.guide.comparisons import build_study, compare_relative
from verification.guide.guide_format import Topic
from verification.guide.topics.bare_wires import WIRE_BENDING, WIRE_MASS, WIRE_TENSION, build_wire
from verification.guide.topics.closed_forms import point_flexibility, wire_sag

_LENGTH = 60.0
_SHORT, _STIFF = 20.0, 2e4
"""Length [m] and bending stiffness [N m2] of a wire whose end layers of 1 m the elements resolve."""

_ELEMENTS = (1.0, 0.5, 0.25)
"""Element lengths of the convergence study [m]."""


def study_sag() -> Topic:
    """Sag of a string and of a tensioned beam."""
    string = discretise(build_wire(_LENGTH, bending_stiffness=0.0), 1.0)
    middle = string.state.deflection[0, string.mesh.station(_LENGTH / 2), 0]
    exact = -WIRE_MASS * GRAVITY * _LENGTH**2 / (8 * WIRE_TENSION)
    line = discretise(build_wire(_SHORT, bending_stiffness=_STIFF), _ELEMENTS[-1])
    x = line.mesh.position
    return Topic(
        title="Sag of a wire under its weight",
        theory="A string has the parabola m g x (L − x) / 2T. A pinned beam with tension solves EI w'''' − T w'' = "
        "−m g; its end layers have the length √(EI/T).",
        setting=f"String of {_LENGTH:g} m with elements of 1 m. Beam of {_SHORT:g} m with EI = {_STIFF:g} N m²; end "
        "layers of 1 m.",
        comparisons=[
            compare_relative(
                "string",
                "sag of a string in mid-span",
                "m",
                (middle, exact),
                1e-10,
                "The shape functions contain the parabola; only rounding remains.",
            )
        ],
        convergence=[
            build_study(
                "beam",
                "largest error of the sag of a beam",
                "element length [m]",
                [(h, _sag_error(h)) for h in _ELEMENTS],
                (4.0, 0.3),
                "Cubic shape functions; the end layers of a fourth-order equation converge with h⁴.",
            )
        ],
        charts=[
            Chart(
                caption="Sag of a pinned beam with tension under its weight.",
                alternative="The computed points lie on the closed form along the whole wire.",
                x_label="position [m]",
                y_label="deflection [mm]",
                series=[
                    Series(label="closed form", style="line", x=x.tolist(), y=(1e3 * _exact_sag(x)).tolist()),
                    Series(
                        label="elements of 0.25 m",
                        style="points",
                        x=x[::4].tolist(),
                        y=(1e3 * line.state.deflection[0, ::4, 0]).tolist(),
                    ),
                ],
            )
        ],
    )


def _exact_sag(x: np.ndarray) -> np.ndarray:
    return wire_sag(x, _SHORT, WIRE_TENSION, WIRE_MASS, _STIFF)


def _sag_error(element: float) -> float:
    """Largest error of the sag over the largest sag."""
    line = discretise(build_wire(_SHORT, bending_stiffness=_STIFF), element)
    exact = _exact_sag(line.mesh.position)
    return float(np.abs(line.state.deflection[0, :, 0] - exact).max() / np.abs(exact).max())


def study_elasticity() -> Topic:
    """Deflection of a wire under a point force, at stations and between them."""
    positions = np.array([15.0, 22.37, 30.0, 41.13])
    line = discretise(build_wire(_LENGTH), 0.5)
    computed = static_uplift(line, positions, 1.0)
    exact = point_flexibility(positions, _LENGTH, WIRE_TENSION, WIRE_BENDING)
    return Topic(
        title="Static elasticity of a wire",
        theory="A unit force at x deflects a pinned beam with tension by [x (L − x) / L − sinh(kx) sinh(k(L − x)) / "
        "(k sinh(kL))] / T with k = √(T/EI).",
        setting=f"Contact wire of {_LENGTH:g} m, elements of 0.5 m; forces at stations and between them.",
        comparisons=[
            compare_relative(
                f"at-{x:g}m",
                f"deflection per force at {x:g} m",
                "mm/N",
                (1e3 * a, 1e3 * b),
                1e-6,
                "The residual flexibility of a point force is exact in a uniform wire; only rounding and its "
                "interpolation within an element remain.",
            )
            for x, a, b in zip(positions, computed, exact, strict=True)
        ],
    )
