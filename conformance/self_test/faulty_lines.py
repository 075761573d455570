"""Lines with one numerical fault each."""

from dataclasses import replace

import numpy as np

from pantocheck.model import DiscretisedLine
from pantocheck.model.discretised_line import with_damping
from pantocheck.model.fem.connectors import build_connectors


def without_residual_flexibility(line: DiscretisedLine) -> DiscretisedLine:
    """Leave out the residual flexibility at contacts, droppers, arms and clamps."""
    beams = line.beams._replace(flexibility=np.zeros_like(line.beams.flexibility))
    return replace(line, beams=beams, connectors=build_connectors(line.catenary, line.mesh, beams, line.state))


def scale_damping(line: DiscretisedLine, factor: float) -> DiscretisedLine:
    """Multiply every Rayleigh coefficient of a line by a factor."""
    scaled = {
        kind: replace(
            rayleigh,
            mass_coefficient=factor * rayleigh.mass_coefficient,
            stiffness_coefficient=factor * rayleigh.stiffness_coefficient,
        )
        for kind, rayleigh in line.catenary.damping.items()
    }
    return with_damping(line, scaled)
