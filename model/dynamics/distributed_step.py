"""Distributed forces in a time step: scalar forces (`scalar_forces`) that act along many stations.

* The additional tension of a held stretch, h = k a'q, acts along the vector a of its elongation (`held_stretches`).
* The damping force of a mode with weight W = M phi, X = d W'q', acts along W (`modal_damping`). The full damping
  matrix, sum of d W W', is never formed.

A vector is stored strip by strip: a strip is the part on one row, between its first and last station. The acceleration
of the elongation under all forces is the inner product of these forces with the response, the inverse of the effective
matrix applied to the vector. Within a step a stretch moves its own wire only, a few stations beyond its ends included.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_stations
from pantocheck.model.dynamics.connector_step import inner_product
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.motion import Layout, Motion
from pantocheck.model.dynamics.scalar_forces import ScalarForces, ScalarLaw, ScalarWorkspace
from pantocheck.model.dynamics.vectors import LANES, align, load, round_up, splat, store
from pantocheck.model.fem.held_stretches import HeldStretches
from pantocheck.model.modal.modal_damping import ModalTerms

Strip = tuple[int, int, int, Array]
"""Distributed force, row, first station, and (n, 2) coefficients of deflections and slopes."""


class DistributedArrays(NamedTuple):
    """Distributed forces of a line in a time step; D forces on Z strips."""

    number: int
    """Number of forces, D."""
    force: Indices
    row: Indices
    station: Indices
    """Force and row of each strip, and its first station, a multiple of the size of a vector, (Z,)."""
    first: Indices
    """Index of the first value of each strip in the two arrays below, and their size, (Z + 1,)."""
    coefficient: Array
    """Coefficients of the elongation, strip by strip, (X,): first of the deflections, then of the slopes [-, m]."""
    response: Array
    """Accelerations of deflections and slopes per force, (X,) [1/kg, 1/(kg m)]."""


def build_distributed_laws(stretches: HeldStretches, terms: ModalTerms) -> ScalarLaw:
    """Laws of the additional tensions and of the modal damping forces, in this order."""
    stretched, modes = np.zeros(stretches.stiffness.size), np.zeros(terms.damping.size)
    number = stretched.size + modes.size
    return ScalarLaw(
        preload=np.zeros(number),
        stiffness=np.append(stretches.stiffness, modes),
        damping=np.append(stretched, terms.damping),
        unilateral=np.zeros(number, dtype=np.bool_),
    )


def build_distributed_arrays(
    stretches: HeldStretches, terms: ModalTerms, factor: Factor, layout: Layout, half_width: int
) -> DistributedArrays:
    """Build the arrays of the distributed forces for a time step; `half_width` as in `column_half_width`."""
    parts: list[tuple[tuple[int, int, int], Array, Array]] = []
    for n, b, start, values in [*_stretch_strips(stretches), *_modal_strips(stretches, terms)]:
        first = max(0, start - half_width) // LANES * LANES
        last = min(layout.stations, start + len(values) + half_width) - 1
        coefficient = np.zeros((2, round_up(last + 1 - first)))
        inside = min(len(values), layout.stations - start)
        coefficient[:, start - first : start - first + inside] = values[:inside].T
        response = coefficient.copy()
        solve_stations(factor, b, first, last, response[0], response[1], -first)
        parts.append(((n, b, first), coefficient.ravel(), response.ravel()))
    number = stretches.stiffness.size + terms.damping.size
    places = np.array([place for place, _, _ in parts], dtype=np.int64).reshape(-1, 3).T
    sizes = np.array([coefficient.size for _, coefficient, _ in parts], dtype=np.int64)
    coefficient, response = (align(np.concatenate([np.zeros(0), *(part[i] for part in parts)])) for i in (1, 2))
    force, row, station = (place.copy() for place in places)
    return DistributedArrays(number, force, row, station, np.append(0, np.cumsum(sizes)), coefficient, response)


def _stretch_strips(stretches: HeldStretches) -> Iterator[Strip]:
    """Strips of the held stretches."""
    for k in range(stretches.stiffness.size):
        for row, values in zip(stretches.row[k].tolist(), stretches.coefficient[k], strict=True):
            yield k, row, int(stretches.first[k]), values


def _modal_strips(stretches: HeldStretches, terms: ModalTerms) -> Iterator[Strip]:
    """Strips of the modes: whole rows."""
    for j, weight in enumerate(terms.weight):
        for row, values in enumerate(weight):
            yield stretches.stiffness.size + j, row, 0, values


def stack_vectors(distributed: DistributedArrays, values: Array, layout: Layout, rows: int) -> csr_array:
    """Coefficients or responses as a (D, 2 B S') matrix: all deflections row by row, then all slopes."""
    plane = rows * layout.width
    index, force = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for z in range(distributed.force.size):
        size = (distributed.first[z + 1] - distributed.first[z]) // 2
        at = distributed.row[z] * layout.width + distributed.station[z] + np.arange(size)
        index += [at, at + plane]
        force.append(np.full(2 * size, distributed.force[z]))
    entries = (values, (np.concatenate(force), np.concatenate(index)))
    return csr_array(entries, shape=(distributed.number, 2 * plane))


@kernel
def predict_distributed(
    distributed: DistributedArrays, forces: ScalarForces, motion: Motion, work: ScalarWorkspace, window: Window
) -> None:
    """Fill the predicted distributed forces, and load the rows with those of the last step as a first guess.

    A force outside of the active window is predicted as it is: no motion changes it.
    """
    offset, law = motion.force.size - distributed.number, forces.law
    for n in range(offset, motion.force.size):
        work.predicted[n] = law.preload[n]
        work.change[n] = 0.0
    plane = motion.w.shape[1] * motion.w.shape[2]
    for z in range(distributed.force.size):
        n, first, size, at = _strip(distributed, motion, z)
        if _outside(distributed, z, size, window):
            work.predicted[n] = motion.force[n]
            continue
        elongation = inner_product(distributed.coefficient, first, size, motion.w, motion.r, at)
        rate = inner_product(distributed.coefficient, first, size, motion.w, motion.r, at + plane)
        work.predicted[n] += law.stiffness[n] * elongation + law.damping[n] * rate
        _load_strip(distributed, motion, z, -motion.force[n], window)


@kernel
def accelerate_distributed(
    distributed: DistributedArrays, motion: Motion, work: ScalarWorkspace, window: Window
) -> None:
    """Compute the accelerations of the elongations under all forces."""
    plane = motion.w.shape[1] * motion.w.shape[2]
    for n in range(motion.force.size - distributed.number, motion.force.size):
        work.acceleration[n] = 0.0
    for z in range(distributed.force.size):
        n, first, size, at = _strip(distributed, motion, z)
        if not _outside(distributed, z, size, window):
            work.acceleration[n] += inner_product(distributed.response, first, size, motion.w, motion.r, at + 2 * plane)


@kernel
def load_distributed(distributed: DistributedArrays, motion: Motion, work: ScalarWorkspace, window: Window) -> None:
    """Load the rows with the changes of the distributed forces since the last step."""
    for z in range(distributed.force.size):
        n, _, _, _ = _strip(distributed, motion, z)
        _load_strip(distributed, motion, z, -work.change[n], window)


@kernel
def _strip(distributed: DistributedArrays, motion: Motion, z: int) -> tuple[int, int, int, int]:
    """Scalar force of a strip, index of its first value, its size, and its index in a flattened plane of rows."""
    first, end = distributed.first[z], distributed.first[z + 1]
    n = motion.force.size - distributed.number + distributed.force[z]
    return n, first, (end - first) // 2, distributed.row[z] * motion.w.shape[2] + distributed.station[z]


@kernel
def _outside(distributed: DistributedArrays, z: int, size: int, window: Window) -> bool:
    """Whether a strip has no station inside the window."""
    return bool(distributed.station[z] > window.last or distributed.station[z] + size <= window.first)


@kernel
def _load_strip(distributed: DistributedArrays, motion: Motion, z: int, value: float, window: Window) -> None:
    """Add a value times the coefficients of a strip to the forces on its row inside the window."""
    _, first, size, at = _strip(distributed, motion, z)
    force, x = at + 2 * motion.w.shape[1] * motion.w.shape[2], splat(value)
    start = distributed.station[z]
    for i in range(max(0, window.first - start), min(size, window.last + 1 - start), LANES):
        store(motion.w, force + i, load(motion.w, force + i) + x * load(distributed.coefficient, first + i))
        store(motion.r, force + i, load(motion.r, force + i) + x * load(distributed.coefficient, first + size + i))
