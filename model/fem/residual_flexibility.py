"""Residual flexibility of a tensioned beam, from its exact static stiffness in the unknowns of `beam`.

Without load between its ends the beam has the deflection w = a + b x + c cosh(kx) + d sinh(kx), k^2 = T / EI.
"""

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.fem import beam

SHORT = 0.05
"""Length k h [-] below which cubic functions replace the closed form.

Their relative error there is 3e-9, and the closed form loses digits.
"""


def exact_stiffness(h: Array, tension: Array, bending_stiffness: Array) -> Array:
    """Exact static stiffness of tensioned beams.

    A string has no stiffness against slopes; a unit stiffness there keeps matrices regular and carries no force.

    Args:
        h: Lengths, (...) [m].
        tension: Tension T, (...) [N].
        bending_stiffness: Bending stiffness EI, (...) [N m2].

    Returns:
        Symmetric matrices, (..., 4, 4) [N/m, N, N m].
    """
    string = np.zeros((*h.shape, 4, 4))
    string[..., 1, 1] = string[..., 3, 3] = 1.0
    string[..., 0, 0] = string[..., 2, 2] = tension / h
    string[..., 0, 2] = string[..., 2, 0] = -tension / h
    stiff = np.where(bending_stiffness > 0, bending_stiffness, 1.0)
    k = np.sqrt(tension / stiff)
    z = k * h
    # Numerators and denominator are divided by cosh z, which overflows.
    tanh, sech = np.tanh(z), 1 / np.cosh(np.minimum(z, 300.0))
    denominator = 2 * (sech - 1) + z * tanh
    with np.errstate(divide="ignore", invalid="ignore"):
        force = stiff * k**3 * tanh / denominator
        mixed = stiff * k**2 * (1 - sech) / denominator
        near = stiff * k * (z - tanh) / denominator
        far = stiff * k * (tanh - z * sech) / denominator
    rows = [
        [force, mixed, -force, mixed],
        [mixed, near, -mixed, far],
        [-force, -mixed, force, -mixed],
        [mixed, far, -mixed, near],
    ]
    exact = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    short = (z < SHORT)[..., None, None]
    exact = np.where(short, beam.stiffness(h, tension, bending_stiffness), exact)
    return np.where((bending_stiffness > 0)[..., None, None], exact, string)


# Residual flexibility of a wire under a point force, which cubic shape functions cannot represent.
#
# A wire bends sharply under a pantograph or a dropper; a cubic polynomial per element does not, neither between
# stations nor at one. The missing deflection per force
#
# R(x) = G_exact(x) - G_elements(x)
#
# is the difference of two static point flexibilities of the same wire. It is local (beyond a few elements both agree)
# and static at all frequencies of interest, so that it acts in series with every part that is connected to the wire at
# a point. G_exact follows from the stiffness of a tensioned beam in closed form (`exact_stiffness`).
PATCH_SIDE = 3
"""Elements on either side of an element over which the two solutions are compared; more change the result by 1e-6.

Their outer ends are hinged. A clamped end has a boundary layer of its own, whose error would count as well.
"""

DEGREE = 6
"""Degree of the polynomial in an element: the square of cubic shape functions."""

_NODES = np.linspace(0.0, 1.0, DEGREE + 1)


def element_flexibility(length: Array, tension: Array, bending_stiffness: Array) -> Array:
    """Residual flexibility along every element of a row.

    Args:
        length: Lengths of the elements, (n,) [m].
        tension: Tension, zero where the row has no wire, (n,) [N].
        bending_stiffness: Bending stiffness, (n,) [N m2].

    Returns:
        Coefficients of the polynomial in the share s of the length, constant first, (n, 7) [m/N].
    """
    coefficients = np.zeros((length.size, DEGREE + 1))
    present = np.flatnonzero(tension > 0)
    if present.size == 0:
        return coefficients
    patch = present[:, None] + np.arange(-PATCH_SIDE, PATCH_SIDE + 1)
    inside = (patch >= 0) & (patch < length.size)
    inside &= tension[np.where(inside, patch, 0)] > 0
    # Beyond its ends a wire continues like the element itself.
    patch = np.where(inside, patch, present[:, None])
    data = np.stack([length.round(9), tension, bending_stiffness], axis=-1)[patch].tobytes()
    size = len(data) // present.size
    places: dict[bytes, int] = {}  # a hash finds equal patches a hundred times faster than sorting
    number = np.array([places.setdefault(data[at : at + size], len(places)) for at in range(0, len(data), size)])
    different = np.frombuffer(b"".join(places)).reshape(len(places), -1)
    h, stretched, bending = np.moveaxis(different.reshape(len(different), -1, 3), -1, 0)
    values = _point_flexibility(h, stretched, bending)
    coefficients[present] = np.linalg.solve(np.vander(_NODES, increasing=True), values.T).T[number]
    return coefficients


def station_flexibility(elements: Array) -> Array:
    """Residual flexibility at every station of a row, the mean of the two elements there.

    Args:
        elements: Coefficients of the elements, see `element_flexibility`, (n, 7) [m/N].

    Returns:
        Residual flexibility, zero where the row has no wire, (n + 1,) [m/N].
    """
    at_start, at_end = np.append(elements[:, 0], 0.0), np.append(0.0, elements.sum(axis=1))
    known = (at_start != 0).astype(float) + (at_end != 0)
    return np.asarray((at_start + at_end) / np.maximum(known, 1.0))


def residual_flexibility(coefficients: Array, s: float) -> float:
    """Residual flexibility at the share s of the length of an element [m/N]; see `element_flexibility`.

    The time step compiles this function, too.
    """
    value = coefficients[-1]
    for k in range(coefficients.size - 2, -1, -1):
        value = value * s + coefficients[k]
    return float(value)


def combine_in_series(stiffness: Array, damping: Array, flexibility: Array, lag: Array) -> tuple[Array, Array]:
    """Springs with parallel dampers in series with residual flexibilities, to first order in frequency.

    A wire with stiffness-proportional damping beta has the flexibility R / (1 + i w beta). With f = 1 / (1 + k R) the
    series has the stiffness f k and the damping f^2 (c + k^2 R beta). A line with one beta for all its parts keeps it.

    Args:
        stiffness, damping: Stiffness k and damping c of the parts, (n,) [N/m, N s/m].
        flexibility, lag: Residual flexibility R of the wires at their ends, and its product with beta, (n,)
            [m/N, m s/N].

    Returns:
        stiffness, damping: Both in series, (n,) [N/m, N s/m].
    """
    factor = 1 / (1 + stiffness * flexibility)
    return np.asarray(factor * stiffness), np.asarray(factor**2 * (damping + stiffness**2 * lag))


def _point_flexibility(h: Array, tension: Array, bending_stiffness: Array) -> Array:
    """Residual flexibility at the nodes of the middle element of U patches of elements, (U, 7) [m/N]."""
    middle = h.shape[1] // 2
    of_middle = (h[:, middle], tension[:, middle], bending_stiffness[:, middle])
    cubic = _end_flexibility(beam.stiffness(h, tension, bending_stiffness))
    exact = _end_flexibility(exact_stiffness(h, tension, bending_stiffness))
    shape = np.moveaxis(beam.shape(*np.broadcast_arrays(_NODES[:, None], of_middle[0])), 0, -1).copy()
    exact_shape, clamped = shape.copy(), np.zeros(shape.shape[:2])  # both have the same shape at the ends
    exact_shape[1:-1], clamped[1:-1] = _exact_shape(_NODES[1:-1, None], *of_middle)
    nodes = zip(clamped, exact_shape, shape, strict=True)
    return np.array([a + _quadratic_form(exact, b) - _quadratic_form(cubic, c) for a, b, c in nodes]).T


def _quadratic_form(matrix: Array, vector: Array) -> Array:
    return np.asarray(np.einsum("ui,uij,uj->u", vector, matrix, vector))


def _end_flexibility(elements: Array) -> Array:
    """Flexibility of the ends of the middle element of U patches with hinged outer ends, (U, 4, 4)."""
    patches, count = elements.shape[:2]
    stiffness = np.zeros((patches, 2 * count + 2, 2 * count + 2))
    for e in range(count):
        stiffness[:, 2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += elements[:, e]
    free = np.delete(np.arange(stiffness.shape[1]), [0, -2])
    ends = slice(count - 2, count + 2)
    load = np.eye(free.size)[:, ends]
    inner = stiffness[:, free[:, None], free]
    return np.linalg.solve(inner, np.broadcast_to(load, (patches, *load.shape)))[:, ends]


def _exact_shape(s: Array, h: Array, tension: Array, bending_stiffness: Array) -> tuple[Array, Array]:
    """Exact static shape functions of elements at s, (n, 1), and the flexibility there with clamped ends, (n, U)."""
    left, right = (exact_stiffness(share * h, tension, bending_stiffness) for share in (s, 1 - s))
    inverse: Array = np.asarray(np.linalg.inv(left[..., 2:, 2:] + right[..., :2, :2]), dtype=np.float64)
    coupling = np.concatenate([left[..., 2:, :2], right[..., :2, 2:]], axis=-1)
    return -(inverse @ coupling)[..., 0, :], inverse[..., 0, 0]
