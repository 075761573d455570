"""State of rest of the second formulation: heights, dropper tensions and lengths, and the linearised bars.

1. The contact wire is held at its prescribed heights; the holding forces are the dropper tensions.
2. Messenger and stitch wires hang between the supports under weights and dropper tensions.
3. Staggers are prescribed in plan view; a dropper with vertical force V and height z is a lateral spring V / z.
4. Distances between the wires are dropper lengths. Dropper weights follow from lengths, so the steps are repeated.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from difference_line import GRAVITY, Line
from difference_parts import dropper_ends, ties
from difference_statics import HeldStructure, rows
from difference_strands import Floats, Strands, Weights, size


@dataclass(frozen=True)
class Rest:
    """State of rest.

    Parameters
    ----------
    shape : (size,) ndarray
        Height above the contact wire at the supports or lateral position of every point [m].
    dropper_force : (droppers,) ndarray
        Vertical force at mid-length [N].
    dropper_extent : (droppers, 2) ndarray
        Upper minus lower end, y and z [m].
    dropper_mass : (droppers,) ndarray
        Masses [kg].
    arm_force : (supports, 2) ndarray
        Force of each steady arm on the contact wire, y and z [N].
    """

    shape: Floats
    dropper_force: Floats
    dropper_extent: Floats
    dropper_mass: Floats
    arm_force: Floats

    @property
    def dropper_length(self) -> Floats:
        """Lengths between the axes of the wires [m]."""
        return np.hypot(*self.dropper_extent.T)


def compute_rest(line: Line, strands: Strands) -> Rest:
    """State of rest of a line."""
    table = line.file.droppers
    mass = np.full(len(line.droppers), table.mass_kg or 0.0)
    rest = _rest(line, strands, mass)
    if table.mass_kg_m is None:
        return rest
    for _ in range(20):
        change = table.mass_kg_m * rest.dropper_length - rest.dropper_mass
        if np.abs(change).max() < 1e-10:
            return rest
        rest = _rest(line, strands, rest.dropper_mass + change)
    raise RuntimeError("the lengths of the droppers do not settle")


def _rest(line: Line, strands: Strands, mass: Floats) -> Rest:
    n, table, supports = size(strands), line.file.droppers, line.supports
    contact = strands["contact", "z"]
    below, above = dropper_ends(line, strands, "z")
    # 1. Contact wire.
    level = line.file.steady_arm.static_share == "level"
    held = [contact.weights(0.0), contact.weights(contact.wire.end), *below]
    held += [contact.weights(x) for x in supports if level]
    heights = np.array([0.0, 0.0, *(d.height for d in line.droppers), *(0.0 for _ in supports if level)])
    shape, force = _hang(strands, ["contact"], np.zeros(n), held, heights)
    holding, arm_force = force[2 : 2 + len(below)], np.zeros((len(supports), 2))
    if level:
        arm_force[:, 1] = force[2 + len(below) :]
    vertical = holding + GRAVITY * (table.clamp_on_contact_kg + mass / 2)
    # 2. Messenger and stitch wires.
    upper = [wire.name for wire in line.wires if wire.name != "contact"]
    load = -(rows(above, n).T @ (vertical + GRAVITY * (table.clamp_on_messenger_kg + mass / 2)))
    messenger = strands["messenger", "z"]
    for x, _ in line.clamps:
        load[messenger.point(x)] -= GRAVITY * line.file.stitch_wire.clamp_kg
    points = line.file.geometry.span_limits
    held = [messenger.weights(x) for x in points] + ties(line, strands, "z")
    heights = np.append(np.full(len(points), line.file.geometry.encumbrance_m), np.zeros(len(line.clamps)))
    shape += _hang(strands, upper, load, held, heights)[0]
    extent = np.zeros((len(line.droppers), 2))
    extent[:, 1] = (rows(above, n) - rows(below, n)) @ shape
    # 3. Plan view.
    if line.staggered:
        lateral, arm_force[:, 0] = _plan_view(line, strands, vertical / extent[:, 1])
        shape += lateral
        below, above = dropper_ends(line, strands, "y")
        extent[:, 0] = (rows(above, n) - rows(below, n)) @ shape
    return Rest(shape, vertical, extent, mass, arm_force)


def _hang(
    strands: Strands, names: list[str], load: Floats, held: list[Weights], values: Floats
) -> tuple[Floats, Floats]:
    """Heights and holding forces of some wires under their weights and a load."""
    n, parts = size(strands), [strands[name, "z"] for name in names]
    load = load.copy()
    for part in parts:
        load[part.first : part.first + part.count] += part.weight(GRAVITY)
    return _solve_part(sp.csc_array(sum(part.stiffness(n) for part in parts)), rows(held, n), load, values)


def _solve_part(stiffness: sp.csc_array, held: sp.csr_array, load: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Solve for the unknowns that have stiffness; all others are zero."""
    part = np.flatnonzero(stiffness.diagonal())
    shape, used = np.zeros(load.size), stiffness[part][:, part]
    solution, force = HeldStructure(sp.csc_array(used), held[:, part]).solve(load[part], values)
    shape[part] = solution
    return shape, force


def _plan_view(line: Line, strands: Strands, spring: Floats) -> tuple[Floats, Floats]:
    """Lateral shape, and lateral force of every steady arm on the contact wire."""
    n = size(strands)
    below, above = dropper_ends(line, strands, "y")
    elongation = rows(above, n) - rows(below, n)
    stiffness = sum(strands[wire.name, "y"].stiffness(n) for wire in line.wires)
    stiffness += elongation.T @ sp.diags_array(spring) @ elongation
    held, values = [], []
    for name, stagger in line.staggers.items():
        held += [strands[name, "y"].weights(x) for x, _ in stagger]
        values += [y for _, y in stagger]
    held += ties(line, strands, "y")
    values += [0.0] * len(line.clamps)
    shape, force = _solve_part(sp.csc_array(stiffness), rows(held, n), np.zeros(n), np.array(values))
    return shape, force[1 : 1 + len(line.supports)]
