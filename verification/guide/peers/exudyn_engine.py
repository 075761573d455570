"""Comparison with a general multibody engine: Exudyn integrates our matrices with its own Newmark and Newton methods.

Exudyn receives the assembled mass, damping and stiffness of line and pantographs with every dropper taut, as one
general second-order object. The nonlinear forces, slack droppers and the moving contact, are a user function of that
object, with its tangent. Method (average acceleration), time step and elements are those of the kernel; equation
solver, Newton's method and its tolerances are those of Exudyn.
"""

import time
from itertools import pairwise

import exudyn as exu
import numpy as np
import scipy.sparse as sp
from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.model import DiscretisedLine, Passage
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem.residual_flexibility import residual_flexibility
from pantocheck.model.statics.assembly import (
    assemble_matrices,
    bandwidth_order,
    connector_directions,
    correct_mass,
    point_load,
)


class DroppersAndContact:
    """Nonlinear forces of line and pantographs, and their tangent.

    Args:
        line: Line with one contact wire.
        passage: Pantographs, their positions and speed.
    """

    def __init__(self, line: DiscretisedLine, passage: Passage) -> None:
        """Line and pantographs at rest, and the matrices of both."""
        stepping = build_kernel_arrays(line, passage.time_step)
        motion, train = start_motion(line, stepping, passage)
        matrices = assemble_matrices(line)
        self.line, self.passage, self.free = line, passage, matrices.free
        n, sizes = matrices.free.size, [p.head.size for p in passage.pantographs]
        at = n + np.concatenate([[0], np.cumsum(sizes)])
        self.own = [slice(int(a), int(b)) for a, b in pairwise(at)]
        self.size = int(at[-1])
        place = bandwidth_order(line)
        self.mass, self.damping, self.stiffness = (
            sp.csr_matrix(sp.block_diag([line_matrix, *pantograph_matrices]))
            for line_matrix, pantograph_matrices in (
                (correct_mass(line, passage.time_step), [p.mass for p in passage.pantographs]),
                (matrices.damping, [p.damping for p in passage.pantographs]),
                (matrices.stiffness, [p.stiffness for p in passage.pantographs]),
            )
        )
        self.constant_force = np.concatenate([np.zeros(n), *(p.force for p in passage.pantographs)])
        stations = line.mesh.position.size
        at_rest = np.stack([motion.w[0, :, :stations], motion.r[0, :, :stations]], axis=-1).ravel()[place][
            matrices.free
        ]
        moving = [train.z[0, p, :size] for p, size in enumerate(sizes)]
        self.at_rest = np.concatenate([at_rest, *moving])
        self.rest = line.state.deflection.ravel()[place]
        self.flexibility = stepping.contact.flexibility[0]
        unilateral = line.connectors.unilateral
        self.bars = sp.csr_matrix(
            sp.vstack(
                [
                    connector_directions(line)[matrices.free][:, unilateral],
                    sp.csr_array((self.size - n, int(unilateral.sum()))),
                ]
            )
        )
        self.elongations = sp.csr_matrix(self.bars.T)
        self.dropper_stiffness = line.connectors.stiffness[unilateral]
        self.dropper_damping = line.connectors.damping[unilateral]
        self.preload = line.connectors.preload[unilateral]

    def force(self, t: float, q: RealArray, v: RealArray) -> RealArray:
        """Forces beside the linear system [N]: the contact forces, and the compensation of slack droppers."""
        force = np.asarray(self.bars @ np.minimum(self._tension(q, v), 0.0))
        for p in range(len(self.own)):
            touched, shares, stiffness, closing = self._contact(t, q, p)
            force[touched] -= shares * stiffness * max(closing, 0.0)
        return force

    def contact_force(self, t: float, q: RealArray) -> RealArray:
        """Contact force of each pantograph [N]."""
        contacts = [self._contact(t, q, p) for p in range(len(self.own))]
        return np.array([stiffness * max(closing, 0.0) for _, _, stiffness, closing in contacts])

    def tangent(self, t: float, q: RealArray, v: RealArray, on_q: float, on_v: float) -> sp.csr_matrix:
        """Negative derivative of `force`: `on_q` times the one by q, plus `on_v` times the one by v."""
        slack = self._tension(q, v) < 0.0
        loose = np.where(slack, -on_q * self.dropper_stiffness - on_v * self.dropper_damping, 0.0)
        whole = self.bars @ sp.diags_array(loose) @ self.elongations
        for p in range(len(self.own)):
            touched, shares, stiffness, closing = self._contact(t, q, p)
            if closing > 0.0:
                head = sp.csr_matrix((shares, (touched, np.zeros_like(touched))), shape=(self.size, 1))
                whole = whole + on_q * stiffness * (head @ head.T)
        tangent = sp.csr_matrix(whole)
        tangent.eliminate_zeros()
        return tangent

    def _tension(self, q: RealArray, v: RealArray) -> RealArray:
        elastic = self.preload + self.dropper_stiffness * (self.elongations @ q)
        return np.asarray(elastic + self.dropper_damping * (self.elongations @ v))

    def _contact(self, t: float, q: RealArray, p: int) -> tuple[NDArray[np.int64], RealArray, float, float]:
        """Unknowns of a contact, their shares in its closing, its stiffness [N/m] and its closing [m]."""
        model, x = self.passage.pantographs[p], self.passage.start[p] + self.passage.speed * t
        share = point_load(self.line, self.line.contact_rows[0], x)
        direction = np.zeros(self.size)
        direction[: self.free.size], direction[self.own[p]] = -share[self.free], model.head
        stations = self.line.mesh.position
        e = int(np.clip(np.searchsorted(stations, x) - 1, 0, stations.size - 2))
        flexibility = residual_flexibility(self.flexibility[e], (x - stations[e]) / (stations[e + 1] - stations[e]))
        touched = np.flatnonzero(direction)
        shares = direction[touched]
        closing = float(shares @ q[touched] - share @ self.rest)
        return touched, shares, 1 / (1 / model.contact_stiffness + flexibility), closing


def run_exudyn(line: DiscretisedLine, passage: Passage) -> tuple[RealArray, float, float]:
    """Simulate a passage with Exudyn's implicit Newmark solver, sparse matrices and Newton's method.

    Args:
        line: Line in the vertical plane with one contact wire.
        passage: Pantographs, speed, duration.

    Returns:
        Contact force [N], process time of the solver [s], part of it in user functions [s], (P, T).
    """
    model = DroppersAndContact(line, passage)
    forces: list[RealArray] = []
    in_user_functions = 0.0

    def force(_system: object, t: float, _item: int, q: RealArray, v: RealArray) -> RealArray:
        nonlocal in_user_functions
        begin = time.process_time()
        result = model.force(t, np.asarray(q), np.asarray(v))
        in_user_functions += time.process_time() - begin
        return result

    def tangent(_system: object, t: float, _item: int, q: RealArray, v: RealArray, on_q: float, on_v: float) -> object:
        nonlocal in_user_functions
        begin = time.process_time()
        result = _sparse(model.tangent(t, np.asarray(q), np.asarray(v), on_q, on_v))
        in_user_functions += time.process_time() - begin
        return result

    def record(system: exu.MainSystem, t: float) -> bool:
        nonlocal in_user_functions
        begin = time.process_time()
        forces.append(model.contact_force(t, np.asarray(system.systemData.GetODE2Coordinates())))
        in_user_functions += time.process_time() - begin
        return True

    system = exu.SystemContainer().AddSystem()
    node = NodeGenericODE2(
        numberOfODE2Coordinates=model.size,
        referenceCoordinates=np.zeros(model.size),
        initialCoordinates=model.at_rest,
        initialCoordinates_t=np.zeros(model.size),
    )
    system.AddObject(
        ObjectGenericODE2(
            nodeNumbers=[system.AddNode(node)],
            massMatrix=_sparse(model.mass),
            dampingMatrix=_sparse(model.damping),
            stiffnessMatrix=_sparse(model.stiffness),
            forceVector=model.constant_force,
            forceUserFunction=force,
            jacobianUserFunction=tangent,
        )
    )
    system.SetPostStepUserFunction(record)
    system.Assemble()
    begin = time.process_time()
    system.SolveDynamic(_settings(passage))
    spent = time.process_time() - begin
    # The first record belongs to the initial state.
    return np.array(forces[1:]).T, spent, in_user_functions


def _sparse(matrix: sp.csr_matrix) -> exu.MatrixContainer:
    container = exu.MatrixContainer()
    container.SetWithSparseMatrix(matrix, *matrix.shape, useDenseMatrix=False)
    return container


def _settings(passage: Passage) -> exu.SimulationSettings:
    """Default settings, except for average acceleration with a constant time step, and sparse matrices."""
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = round(passage.duration / passage.time_step), passage.duration
    integration.adaptiveStep = False
    integration.generalizedAlpha.useNewmark = True
    # The simulation starts in equilibrium with zero accelerations, as in the kernel.
    integration.generalizedAlpha.computeInitialAccelerations = False
    # The full method evaluates the forces twice per step, the modified one seven times at the same total cost.
    integration.newton.useModifiedNewton = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.solution.file.write = False
    return settings
