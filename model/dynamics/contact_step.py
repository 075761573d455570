"""Contact of pantographs and contact wires in a time step: Gauss-Seidel sweeps over the contact forces.

A head can touch every contact wire whose extent covers the element above it: parallel wires, and in an overlap of
sections the wires of both. A raised wire lies above the head and has no overlap with it.

The contact is a unilateral spring between head and wire: the penalty and the residual flexibility of the wire element
in series (`residual_flexibility`). With the predicted overlap d of head and wire, the force at the end of a step is

    F = max(0, k (d + dt^2/4 a)),    a = acceleration of the head minus acceleration of the wire

A change of F changes a by -(compliance) F, and F is solved exactly with all other forces held. A constraint has no
penalty: the residual flexibility R alone remains, and F >= 0 is complementary to R F - (d + dt^2/4 a) >= 0. A damper
adds c (d' + dt/2 a). Hertz's law adds its penetration to that of the linear parts (`contact_law`).

Without a penalty, head and wire on R vibrate faster than a mesh radiates waves, and average acceleration damps nothing.
R then has the damper of critical damping, c^2 = 4 / (R compliance): it follows from mesh and time step, and vanishes
with them.

The sweeps need the wire at its contacts only: its response to a unit force of a head, a local column of the inverse
(`inverse_columns`), is solved anew in every step, and gives the influence of the contact on the other contacts and on
the scalar forces.
"""

import math

from pantocheck.model.dynamics.active_window import Window, search
from pantocheck.model.dynamics.block_tridiagonal import solve_stations
from pantocheck.model.dynamics.connector_step import ConnectorArrays, inner_product
from pantocheck.model.dynamics.contact_arrays import (
    ContactArrays,
    ContactWorkspace,
    height_of_irregularity,
    slope_of_irregularity,
)
from pantocheck.model.dynamics.distributed_step import DistributedArrays
from pantocheck.model.dynamics.joint_step import predict_joints
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.scalar_forces import NEGLIGIBLE_FORCE, ScalarWorkspace, maximum
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import LANES
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility

_find_element, _residual_flexibility = kernel(find_element), kernel(residual_flexibility)


@kernel
def predict_train(contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace) -> None:
    """Move and predict the pantographs, and press with the contact forces of the last step as a first guess."""
    dt = contact.time_step
    unknowns = train.z.shape[2]
    train.elapsed[0] += dt
    # Share of the static force that still holds the heads down: a half-cosine from 1 to 0.
    holding = 0.0
    if train.elapsed[0] < train.ramp[0]:
        holding = (1 + math.cos(math.pi * train.elapsed[0] / train.ramp[0])) / 2
    for p in range(train.position.size):
        train.position[p] += dt * train.speed[0]
        for i in range(unknowns):
            train.z[0, p, i] += dt * train.z[1, p, i] + dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]
        for c in range(train.first_strip[p], train.first_strip[p + 1]):
            work.place[c] = train.position[p] + train.offset[c]
            _find_wires_above(contact, train, work, c)
            work.pressing[c] = 0.0
            for n in range(work.number_above[c]):
                work.pressing[c] += train.contact[c, work.above[c, n]]
                _shape_strip(contact, motion, train, work, c, work.above[c, n])
            work.pressing[c] += holding * train.held[c]
        for i in range(unknowns):
            train.z[2, p, i] = 0.0
        for j in range(unknowns):
            force = train.force[p, j]
            for c in range(train.first_strip[p], train.first_strip[p + 1]):
                force -= train.head[c, j] * work.pressing[c]
                if train.lateral.shape[1] > 0:
                    for n in range(work.number_above[c]):
                        wire = work.above[c, n]
                        force -= (work.head[c, wire, j] - train.head[c, j]) * train.contact[c, wire]
            for k in range(train.joint_owner.size):
                if train.joint_owner[k] == p:
                    force -= train.joint[k, j] * train.joint_force[k]
            for m in range(unknowns):
                force -= train.damping[p, j, m] * train.z[1, p, m] + train.stiffness[p, j, m] * train.z[0, p, m]
            for i in range(unknowns):
                train.z[2, p, i] += train.inverse[p, i, j] * force
    for c in range(train.owner.size):
        p = train.owner[c]
        for n in range(work.number_above[c]):
            wire, head, compliance = work.above[c, n], 0.0, 0.0
            for i in range(unknowns):
                for j in range(unknowns):
                    compliance += work.head[c, wire, i] * train.inverse[p, i, j] * work.head[c, wire, j]
                head += work.head[c, wire, i] * train.z[0, p, i]
            work.head_compliance[c, wire], work.overlap[c, wire] = compliance, head
            _predict_contact(contact, motion, train, work, c, wire)
            _solve_response(contact, work, c, wire)
            if math.isinf(train.contact_stiffness[c]):
                mobility = compliance + _at_contact(work, c, c, wire)
                work.damping[c, wire] = 2 * math.sqrt(work.stiffness[c, wire] / mobility)
    predict_joints(train, work)


@kernel
def _shape_strip(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, c: int, wire: int
) -> None:
    """Displacement of strip c per unknown below a wire, at its lateral position."""
    for i in range(train.head.shape[1]):
        work.head[c, wire, i] = train.head[c, i]
    if train.lateral.shape[1] > 0:
        (y, _), power = _lateral_motion(contact, motion, train, work, c, wire), 1.0
        for k in range(train.lateral.shape[1]):
            power *= y
            for i in range(train.head.shape[1]):
                work.head[c, wire, i] += power * train.lateral[c, k, i]


@kernel
def _lateral_motion(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, c: int, wire: int
) -> tuple[float, float]:
    """Predicted lateral position of a wire above strip c, and its rate as the strip moves [m, m/s]."""
    row, y, rate = contact.lateral_row[wire], 0.0, 0.0
    if row < 0:
        return 0.0, 0.0
    e, h, s = _find_element(contact.position, work.place[c])
    for i in range(2):
        # Hermite functions and their derivatives along the track.
        n, m = (1 - s) ** 2 * (1 + 2 * s) if i == 0 else s * s * (3 - 2 * s), h * s * (1 - s) * (1 - i - s)
        by_w, by_r = (12 * i - 6) * s * (1 - s) / h, (1 - i - s) * (1 - i - 3 * s + 2 * i)
        w, r = (
            contact.rest[row, e + i, 0] + motion.w[0, row, e + i],
            contact.rest[row, e + i, 1] + motion.r[0, row, e + i],
        )
        y += n * w + m * r
        rate += train.speed[0] * (by_w * w + by_r * r) + n * motion.w[1, row, e + i] + m * motion.r[1, row, e + i]
    return y, rate


@kernel
def _find_wires_above(contact: ContactArrays, train: Train, work: ContactWorkspace, c: int) -> None:
    """Find the element and the contact wires above strip c; a wire that it has left presses no more."""
    e, _, _ = _find_element(contact.position, work.place[c])
    work.element[c], work.number_above[c] = e, 0
    for wire in range(train.contact.shape[1]):
        if contact.wires.first[wire] <= e < contact.wires.last[wire]:
            work.above[c, work.number_above[c]] = wire
            work.number_above[c] += 1
        else:
            train.contact[c, wire] = work.first_guess[c, wire] = 0.0


@kernel
def _predict_contact(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, c: int, wire: int
) -> None:
    """Complete the overlap of strip c, so far its height, and load a wire with the contact force."""
    row, n = contact.wires.row[wire], work.shape[c, wire]
    e, h, s = _find_element(contact.position, work.place[c])
    # Hermite functions, as in `beam.shape`.
    n[0], n[1] = (1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2
    n[2], n[3] = s * s * (3 - 2 * s), h * s * s * (s - 1)
    force, height = train.contact[c, wire], 0.0
    work.first_guess[c, wire] = force
    for i in range(2):
        height += n[2 * i] * (contact.rest[row, e + i, 0] + motion.w[0, row, e + i])
        height += n[2 * i + 1] * (contact.rest[row, e + i, 1] + motion.r[0, row, e + i])
        motion.w[2, row, e + i] += n[2 * i] * force
        motion.r[2, row, e + i] += n[2 * i + 1] * force
    work.stiffness[c, wire] = 1 / (
        1 / train.contact_stiffness[c] + _residual_flexibility(contact.flexibility[row, e], s)
    )
    work.overlap[c, wire] -= height + height_of_irregularity(contact.irregularity, wire, work.place[c])
    if train.contact_damping[c] > 0.0:
        softening = work.stiffness[c, wire] / train.contact_stiffness[c]
        work.damping[c, wire] = softening * softening * train.contact_damping[c]
    if train.contact_damping[c] > 0.0 or math.isinf(train.contact_stiffness[c]):
        work.rate[c, wire] = _closing_rate(contact, motion, train, work, c, wire)


@kernel
def _closing_rate(
    contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace, c: int, wire: int
) -> float:
    """Predicted rate of the overlap of strip c and a wire [m/s]: the contact moves along the slope of the wire."""
    row, shape, rate = contact.wires.row[wire], work.shape[c, wire], 0.0
    e, h, s = _find_element(contact.position, work.place[c])
    slope = slope_of_irregularity(contact.irregularity, wire, work.place[c])
    for i in range(2):
        # Derivatives of the Hermite functions along the track.
        by_w, by_r = (12 * i - 6) * s * (1 - s) / h, (1 - i - s) * (1 - i - 3 * s + 2 * i)
        slope += by_w * (contact.rest[row, e + i, 0] + motion.w[0, row, e + i])
        slope += by_r * (contact.rest[row, e + i, 1] + motion.r[0, row, e + i])
        rate -= shape[2 * i] * motion.w[1, row, e + i] + shape[2 * i + 1] * motion.r[1, row, e + i]
    for i in range(train.z.shape[2]):
        rate += work.head[c, wire, i] * train.z[1, train.owner[c], i]
    if train.lateral.shape[1] > 0:
        (y, moving), power = _lateral_motion(contact, motion, train, work, c, wire), 1.0
        for k in range(train.lateral.shape[1]):
            for i in range(train.z.shape[2]):
                rate += moving * (k + 1) * power * train.lateral[c, k, i] * train.z[0, train.owner[c], i]
            power *= y
    return float(rate - train.speed[0] * slope)


@kernel
def _solve_response(contact: ContactArrays, work: ContactWorkspace, c: int, wire: int) -> None:
    """Response of a wire to a unit force of strip c."""
    e, half_width, response = work.element[c], contact.half_width, work.response[c, wire]
    start = (e - half_width) // LANES * LANES
    work.start[c] = start
    response[:] = 0.0
    for i in range(2):
        for slope in range(2):
            response[slope, e + i - start] = work.shape[c, wire, 2 * i + slope]
    first, last = max(0, e - half_width), min(contact.position.size - 1, e + 1 + half_width)
    solve_stations(contact.factor, contact.wires.row[wire], first, last, response[0], response[1], -start)


@kernel
def accelerate_contacts(
    contact: ContactArrays,
    connectors: ConnectorArrays,
    distributed: DistributedArrays,
    motion: Motion,
    work: ContactWorkspace,
    window: Window,
) -> None:
    """Compute the accelerations of the wires at the contacts under all forces, and the influence of the contacts.

    Args:
        contact, connectors, distributed: Contact wires, connectors and distributed forces of a line.
        motion: Forces in place of the accelerations.
        work: Responses of the wires; the rest is filled.
        window: Active window.
    """
    strips, size = work.element.size, work.response.shape[3]
    wires, rows, width = work.shape.shape[1], motion.w.shape[1], motion.w.shape[2]
    for c in range(strips):
        for n in range(work.number_above[c]):
            wire = work.above[c, n]
            at = (2 * rows + contact.wires.row[wire]) * width + work.start[c]
            response = 2 * (c * wires + wire) * size
            work.wire_acceleration[c, wire] = inner_product(work.response, response, size, motion.w, motion.r, at)
            for other in range(strips):
                work.wire_compliance[c, other, wire] = _at_contact(work, c, other, wire)
            _list_near_connectors(contact, connectors, work, c, wire, window)
            _list_near_distributed(contact, distributed, motion, work, c, wire)


@kernel
def _at_contact(work: ContactWorkspace, c: int, other: int, wire: int) -> float:
    """Acceleration of a wire at the contact of another strip, or of c itself, per force of strip c."""
    acceleration, s = 0.0, work.element[other] - work.start[c]
    if s < 0 or s + 1 >= work.response.shape[3]:
        return 0.0
    for i in range(2):
        for slope in range(2):
            acceleration += work.shape[other, wire, 2 * i + slope] * work.response[c, wire, slope, s + i]
    return acceleration


@kernel
def _list_near_connectors(
    contact: ContactArrays, connectors: ConnectorArrays, work: ContactWorkspace, c: int, wire: int, window: Window
) -> None:
    """List the connectors with a node inside the response to a contact, and their accelerations."""
    nodes, row, start, number = connectors.nodes, contact.wires.row[wire], work.start[c], 0
    low, high = max(start, window.first), min(start + work.response.shape[3], window.last + 1)
    j = search(nodes.station, nodes.first[row], nodes.first[row + 1], low)
    while j < nodes.first[row + 1] and nodes.station[j] < high:
        acceleration = work.response[c, wire, 0, nodes.station[j] - start]
        for end in range(nodes.first_end[j], nodes.first_end[j + 1]):
            work.near[c, wire, number] = nodes.connector[end]
            work.influence[c, wire, number] = nodes.coefficient[end] * acceleration
            number += 1
        j += 1
    work.number_near[c, wire] = number


@kernel
def _list_near_distributed(
    contact: ContactArrays, distributed: DistributedArrays, motion: Motion, work: ContactWorkspace, c: int, wire: int
) -> None:
    """List the distributed forces whose response covers a contact, and their accelerations."""
    number, n, e = work.number_near[c, wire], work.shape[c, wire], work.element[c]
    for z in range(distributed.force.size):
        size = (distributed.first[z + 1] - distributed.first[z]) // 2
        s = e - distributed.station[z]
        if distributed.row[z] == contact.wires.row[wire] and s >= 0 and s + 1 < size:
            at = distributed.first[z] + s
            work.near[c, wire, number] = motion.force.size - distributed.number + distributed.force[z]
            work.influence[c, wire, number] = (
                n[0] * distributed.response[at]
                + n[1] * distributed.response[at + size]
                + n[2] * distributed.response[at + 1]
                + n[3] * distributed.response[at + size + 1]
            )
            number += 1
    work.number_near[c, wire] = number


@kernel
def sweep_contacts(dt: float, train: Train, work: ContactWorkspace, scalar: ScalarWorkspace) -> float:
    """Solve every contact once, all other forces held; return the largest change of a contact force [N].

    Args:
        dt: Time step [s].
        train: Pantographs; contact forces and accelerations are updated.
        work: Predictors of the contacts.
        scalar: Scalar forces, whose accelerations are updated.
    """
    largest = 0.0
    for c in range(train.owner.size):
        p = train.owner[c]
        for number in range(work.number_above[c]):
            wire = work.above[c, number]
            old, k, damper = train.contact[c, wire], work.stiffness[c, wire], work.damping[c, wire]
            approach = -work.wire_acceleration[c, wire]
            for i in range(train.z.shape[2]):
                approach += work.head[c, wire, i] * train.z[2, p, i]
            for other in range(train.owner.size):
                change = train.contact[other, wire] - work.first_guess[other, wire]
                approach -= work.wire_compliance[c, other, wire] * change
            for i in range(work.number_near[c, wire]):
                approach += work.influence[c, wire, i] * scalar.change[work.near[c, wire, i]]
            gain, held = k * dt * dt / 4 + damper * dt / 2, k * work.overlap[c, wire] + damper * work.rate[c, wire]
            compliance = gain * (work.head_compliance[c, wire] + work.wire_compliance[c, c, wire])
            force = max((held + gain * approach + compliance * old) / (1 + compliance), 0.0)
            if train.hertz[c] > 0.0 and force > 0.0:
                force = reduce_by_hertz(force, train.hertz[c] * k / (1 + compliance))
            change = force - old
            if abs(change) > NEGLIGIBLE_FORCE:
                train.contact[c, wire] = force
                for i in range(work.number_near[c, wire]):
                    scalar.acceleration[work.near[c, wire, i]] += work.influence[c, wire, i] * change
                for i in range(train.z.shape[2]):
                    for j in range(train.z.shape[2]):
                        train.z[2, p, i] -= train.inverse[p, i, j] * work.head[c, wire, j] * change
            largest = maximum(largest, abs(change))
    return largest


@kernel
def reduce_by_hertz(linear: float, share: float) -> float:
    """Force F with F + share F^(2/3) = linear, by Newton's method in the root of F.

    Args:
        linear: Force of the contact without Hertz's law, above zero [N].
        share: Penetration by Hertz's law per F^(2/3), over the flexibility of all linear parts [N^(1/3)].
    """
    # Both terms alone bound the root from above, and the function is convex there: the iteration descends to it.
    root = min(linear ** (1 / 3), math.sqrt(linear / share))
    for _ in range(60):
        change = (root * root * (root + share) - linear) / (root * (3 * root + 2 * share))
        root -= change
        if change <= 1e-15 * root:
            break
    return float(root * root * root)


@kernel
def load_contacts(contact: ContactArrays, motion: Motion, train: Train, work: ContactWorkspace) -> None:
    """Load the wires with the changes of the contact forces since the last step."""
    for c in range(train.owner.size):
        for number in range(work.number_above[c]):
            wire, e = work.above[c, number], work.element[c]
            row, change = contact.wires.row[wire], train.contact[c, wire] - work.first_guess[c, wire]
            for i in range(2):
                motion.w[2, row, e + i] += work.shape[c, wire, 2 * i] * change
                motion.r[2, row, e + i] += work.shape[c, wire, 2 * i + 1] * change


@kernel
def correct_train(dt: float, train: Train) -> None:
    """Complete the predictors of the pantographs with the accelerations at the end of the step."""
    for p in range(train.position.size):
        for i in range(train.z.shape[2]):
            train.z[0, p, i] += dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]
