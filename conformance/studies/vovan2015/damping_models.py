"""Computed damping ratios of a line under the damping models of a case."""

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, DiscretisedLine
from pantocheck.model.discretised_line import with_damping
from pantocheck.model.modal.modes import Modes, damping_ratios


def build_lines(case: Case) -> dict[str, Catenary]:
    """The case's line under each of the other damping models it names."""
    return {name: build_catenary(case.with_damping(name, damping).line) for name, damping in case.dampings.items()}


def computed_damping_ratios(mesh: DiscretisedLine, shapes: Modes, line: Catenary) -> RealArray:
    """Damping ratio that a line's damping gives to the modes of the undamped line, modal bands in place of the rest.

    Parameters
    ----------
    mesh : DiscretisedLine
        The line in finite elements, with any damping.
    shapes : Modes
        Its modes.
    line : Catenary
        The same line with the damping in question.
    """
    ratio = damping_ratios(with_damping(mesh, line.damping), shapes)
    for band in line.modal_damping:
        inside = (shapes.frequency >= band.from_frequency) & (shapes.frequency < band.to_frequency)
        ratio[inside] = band.damping_ratio
    return ratio
