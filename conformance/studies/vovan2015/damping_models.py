"""Damping ratios of a line under the damping models of Vo Van, Balmes and Lorang (2015)."""

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.model import Catenary, DiscretisedLine
from pantocheck.model.discretised_line import with_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import Modes, damping_ratios


def build_lines(case: Case) -> dict[str, Catenary]:
    """The line of a case under each damping model that the case names for comparison."""
    return {name: build_catenary(case.with_damping(name, damping).line) for name, damping in case.dampings.items()}


def computed_damping_ratios(mesh: DiscretisedLine, shapes: Modes, line: Catenary) -> RealArray:
    """Damping ratios of the undamped modes of a line; a modal band replaces the Rayleigh damping.

    Parameters
    ----------
    mesh : DiscretisedLine
        The line in finite elements, with any damping.
    shapes : Modes
        Its undamped modes.
    line : Catenary
        The same line with the damping model.

    Returns
    -------
    (n,) ndarray
        Damping ratio of every mode [-].
    """
    rayleigh = damping_ratios(with_damping(mesh, line.damping), shapes)
    return apply_modal_bands(rayleigh, shapes.frequency, line.modal_damping)
