"""Elasticity of a line: static uplift of the contact wire under a force, and its height."""

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.fem.assembly import point_load
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from pantocheck.model.irregularity_spline import NO_IRREGULARITY, irregularity_height
from pantocheck.model.statics.static_solver import StaticSolver


def static_uplift(line: DiscretisedLine, position: Array, force: float) -> Array:
    """Compute the uplift of the contact wire under a static force at each position in turn; droppers may slacken.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    position : (n,) ndarray
        Positions of the force [m].
    force : float
        Force upwards, shared by the contact wires [N].

    Returns
    -------
    (n,) ndarray
        Uplift at the force, mean over the contact wires [m].
    """
    statics = StaticSolver(line)
    rows = line.contact_rows
    uplift = np.empty(len(position))
    for i, x in enumerate(position):
        loads = [point_load(line, row, float(x)) for row in rows]
        displacement = statics.deflection(force / len(rows) * np.sum(loads, axis=0)).displacement
        flat = displacement.transpose(1, 0, 2).ravel()
        uplift[i] = np.mean([load @ flat for load in loads]) + force / len(rows) * _mean_residual(line, float(x))
    return uplift


def rest_height(line: DiscretisedLine, position: Array) -> Array:
    """Height of the contact wire at rest.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    position : (n,) ndarray
        Positions along the line [m].

    Returns
    -------
    (n,) ndarray
        Height above the datum of the line, mean over the contact wires [m].
    """
    deflection = line.state.deflection.transpose(1, 0, 2).ravel()
    heights = [[point_load(line, row, float(x)) @ deflection for row in line.contact_rows] for x in position]
    return np.asarray(np.mean(heights, axis=1))


def height_under_forces(line: DiscretisedLine, position: Array, force: Array) -> Array:
    """Compute the height of the contact wire, with its irregularity, at static forces; droppers may slacken.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    position : (n,) ndarray
        Positions of the forces [m].
    force : (n,) ndarray
        Forces upwards, each shared by the contact wires [N].

    Returns
    -------
    (n,) ndarray
        Height, mean over the contact wires [m].
    """
    rows = line.contact_rows
    shapes = [np.mean([point_load(line, row, float(x)) for row in rows], axis=0) for x in position]
    displacement = StaticSolver(line).deflection(np.sum([f * n for f, n in zip(force, shapes, strict=True)], axis=0))
    height = (line.state.deflection + displacement.displacement).transpose(1, 0, 2).ravel()
    residual = [f / len(rows) * _mean_residual(line, float(x)) for x, f in zip(position, force, strict=True)]
    return np.asarray(np.array([shape @ height for shape in shapes]) + residual + _mean_irregularity(line, position))


def _mean_residual(line: DiscretisedLine, position: float) -> float:
    """Residual flexibility at a position, mean over the contact wires [m/N]."""
    element, _, s = find_element(line.mesh.position, position)
    return float(np.mean([residual_flexibility(line.beams.flexibility[r, element], s) for r in line.contact_rows]))


def _mean_irregularity(line: DiscretisedLine, position: Array) -> Array:
    """Irregularity at positions, mean over the contact wires [m]."""
    wires = line.catenary.contact_wires
    heights = [irregularity_height(wire.irregularity or NO_IRREGULARITY, position) for wire in wires]
    return np.asarray(np.mean(heights, axis=0))


def non_uniformity(elasticity: Array) -> float:
    """Non-uniformity of the elasticity along a span: (max - min) / (max + min).

    Parameters
    ----------
    elasticity : (n,) ndarray
        Elasticity along a span, in any unit.

    Returns
    -------
    float
        Non-uniformity [-].
    """
    return float((elasticity.max() - elasticity.min()) / (elasticity.max() + elasticity.min()))
