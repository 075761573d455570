"""Elasticity of a line: static uplift of the contact wire under a force, and its height."""

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.irregularity_spline import NO_IRREGULARITY, irregularity_height
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element, find_elements
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from pantocheck.model.statics.assembly import point_load
from pantocheck.model.statics.contact_wires import locate_contact_wires, mark_touched_wires, touched_rows, wire_heights
from pantocheck.model.statics.static_solver import point_product, static_solver
from pantocheck.model.statics.unit_responses import UnitResponses, compute_unit_responses, invert_blocks

POINTS_AT_ONCE = 240
"""Positions whose responses are computed together: ten spans, whose responses reach few other ones."""


def static_uplift(line: DiscretisedLine, position: Array, force: float) -> Array:
    """Compute the uplift of the contact wire under a static force at each position in turn; droppers may slacken.

    Args:
        line: Discretised line.
        position: Positions of the force, (n,) [m].
        force: Force upwards, shared by the contact wires that a head touches there [N].

    Returns:
        Uplift at the force, mean over these contact wires, (n,) [m].
    """
    order = np.argsort(position, kind="stable")
    uplift = np.empty(position.size)
    for first in range(0, position.size, POINTS_AT_ONCE):
        part = order[first : first + POINTS_AT_ONCE]
        points, residual = _point_responses(line, tuple(position[part].tolist()))
        uplift[part] = static_solver(line).deflections_at(points, force) + force * residual
    return uplift


@keep_with_line
def _point_responses(line: DiscretisedLine, positions: tuple[float, ...]) -> tuple[UnitResponses, Array]:
    """Responses to a unit force that the touched contact wires share, and their residual flexibility, (n,) [m/N]."""
    touched = mark_touched_wires(line, np.array(positions))
    element, length, s = find_elements(line.mesh.position, np.array(positions))
    shapes = (beam.shape(s, length) / touched.sum(axis=1)).T.reshape(-1, 2, 2)
    share, residual = np.zeros((len(positions), 2, line.mesh.rows, 2)), np.zeros(len(positions))
    for row, under in zip(locate_contact_wires(line).row, touched.T, strict=True):
        share[under, :, row] = shapes[under]
        coefficients = line.beams.flexibility[row, element[under]]
        residual[under] += np.polynomial.polynomial.polyval(s[under], coefficients.T, tensor=False)
    residual /= touched.sum(axis=1) ** 2
    return compute_unit_responses(invert_blocks(line), element, share.reshape(len(positions), 2, -1)), residual


def rest_height(line: DiscretisedLine, position: Array) -> Array:
    """Height of the contact wire at rest, with its irregularity.

    Args:
        line: Discretised line.
        position: Positions along the line, (n,) [m].

    Returns:
        Height above the datum of the line, mean over the contact wires that a head touches there, (n,) [m].
    """
    touched = mark_touched_wires(line, position)
    return np.average(wire_heights(line, position), axis=1, weights=touched) + _mean_irregularity(line, position)


def height_under_forces(line: DiscretisedLine, position: Array, force: Array) -> Array:
    """Compute the height of the contact wire, with its irregularity, at static forces; droppers may slacken.

    Args:
        line: Discretised line.
        position: Positions of the forces, (n,) [m].
        force: Forces upwards, each shared by the contact wires that a head touches there, (n,) [N].

    Returns:
        Height, mean over these contact wires, (n,) [m].
    """
    rows = [touched_rows(line, float(x)) for x in position]
    shapes = [
        np.mean([point_load(line, row, float(x)) for row in under], axis=0)
        for x, under in zip(position, rows, strict=True)
    ]
    displacement = static_solver(line).deflection(np.sum([f * n for f, n in zip(force, shapes, strict=True)], axis=0))
    height = (line.state.deflection + displacement.displacement).transpose(1, 0, 2).ravel()
    residual = [
        f / len(under) * _mean_residual(line, under, float(x))
        for x, f, under in zip(position, force, rows, strict=True)
    ]
    heights = np.array([point_product(shape, height) for shape in shapes])
    return np.asarray(heights + residual + _mean_irregularity(line, position))


def _mean_residual(line: DiscretisedLine, rows: Indices, position: float) -> float:
    """Residual flexibility at a position, mean over rows of contact wires [m/N]."""
    element, _, s = find_element(line.mesh.position, position)
    return float(np.mean([residual_flexibility(line.beams.flexibility[row, element], s) for row in rows]))


def _mean_irregularity(line: DiscretisedLine, position: Array) -> Array:
    """Irregularity at positions, mean over the contact wires that a head touches there [m]."""
    wires = line.catenary.contact_wires
    heights = [irregularity_height(wire.irregularity or NO_IRREGULARITY, position) for wire in wires]
    return np.asarray(np.average(heights, axis=0, weights=mark_touched_wires(line, position).T))


def non_uniformity(elasticity: Array) -> float:
    """Non-uniformity of the elasticity along a span: (max - min) / (max + min).

    Args:
        elasticity: Elasticity along a span, in any unit, (n,).

    Returns:
        Non-uniformity [-].
    """
    return float((elasticity.max() - elasticity.min()) / (elasticity.max() + elasticity.min()))
