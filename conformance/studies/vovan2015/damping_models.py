"""Computed damping ratios of a line under the damping models of a case."""

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, DiscretisedLine
from pantocheck.model.discretised_line import with_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import Modes, damping_ratios


def build_lines(case: Case) -> dict[str, Catenary]:
    """The case's line under each of the other damping models it names."""
    return {name: build_catenary(case.with_damping(name, damping).line) for name, damping in case.dampings.items()}


def computed_damping_ratios(mesh: DiscretisedLine, shapes: Modes, line: Catenary) -> RealArray:
    """Damping ratios of the modes of the undamped line under the Rayleigh and modal damping of a line [-], (n,).

    Parameters
    ----------
    mesh : DiscretisedLine
        The line in finite elements, with any damping.
    shapes : Modes
        Its modes.
    line : Catenary
        The same line with the damping in question.
    """
    rayleigh = damping_ratios(with_damping(mesh, line.damping), shapes)
    return apply_modal_bands(rayleigh, shapes.frequency, line.modal_damping)
