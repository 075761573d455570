"""Statics of the second formulation: strands under loads, with prescribed displacements and unilateral bars."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from verification.formulations.difference_line import Line
from verification.formulations.difference_strands import Floats, Indices, Strands, Weights, size


@dataclass(frozen=True)
class Bar:
    """Spring whose elongation is the sum of coefficients times displacements; a unilateral bar carries tension only.

    Position [m], points and coefficients, stiffness [N/m], damping [N s/m], tension at rest [N].
    """

    position: float
    points: Indices
    coefficients: Floats
    stiffness: float
    damping: float = 0.0
    preload: float = 0.0
    unilateral: bool = False


def join(*parts: tuple[float, Weights]) -> Weights:
    """Points and coefficients of a sum of factors times interpolated displacements."""
    return (
        np.concatenate([points for _, (points, _) in parts]),
        np.concatenate([factor * weights for factor, (_, weights) in parts]),
    )


def rows(weights: list[Weights], size: int) -> sp.csr_array:
    """Matrix with one row of coefficients per list entry."""
    place = np.repeat(np.arange(len(weights)), [points.size for points, _ in weights])
    points, values = (np.concatenate([w[k] for w in weights]) if weights else np.zeros(0, int) for k in (0, 1))
    return sp.csr_array((values, (place, points)), shape=(len(weights), size))


class HeldStructure:
    """Linear structure with prescribed sums of displacements, factored once: K w + A' p = load, A w = values."""

    def __init__(self, stiffness: sp.csc_array, held: sp.csr_array) -> None:
        self.size = stiffness.shape[0]
        self._factor: SuperLU = splu(sp.csc_matrix(sp.block_array([[stiffness, held.T], [held, None]])))

    def solve(self, load: Floats, values: Floats) -> tuple[Floats, Floats]:
        """Displacements and the forces that hold the prescribed sums."""
        solution = self._factor.solve(np.append(load, values))
        return solution[: self.size], -solution[self.size :]


class Uplift:
    """Static displacement from the state of rest under point loads, with slack droppers.

    With the droppers of a set slack, forces q along them cancel their linear tensions: q = preload + k d(q).
    """

    def __init__(self, stiffness: sp.csc_array, bars: list[Bar], held: sp.csr_array) -> None:
        size = stiffness.shape[0]
        self._elongation = rows([(bar.points, bar.coefficients) for bar in bars], size)
        self._stiffness = np.array([bar.stiffness for bar in bars])
        self._preload = np.array([bar.preload if bar.unilateral else np.inf for bar in bars])
        bar_matrix = self._elongation.T @ sp.diags_array(self._stiffness) @ self._elongation
        self._structure = HeldStructure(sp.csc_array(stiffness + bar_matrix), held)
        self._zero = np.zeros(held.shape[0])
        self._columns: dict[int, Floats] = {}

    def displacement(self, load: Floats) -> Floats:
        """Displacement under a load, (size,) [N]."""
        linear = self._structure.solve(load, self._zero)[0]
        displacement, slack = linear, np.zeros(0, dtype=int)
        for _ in range(100):
            tension = self._preload + self._stiffness * (self._elongation @ displacement)
            now = np.flatnonzero(tension < 0)
            if np.array_equal(now, slack):
                return displacement
            slack = now
            columns = np.array([self._column(j) for j in slack]).reshape(slack.size, linear.size)
            part = self._elongation[slack]
            k = self._stiffness[slack]
            system = np.eye(slack.size) - k[:, None] * (part @ columns.T)
            forces = np.linalg.solve(system, self._preload[slack] + k * (part @ linear))
            displacement = linear + forces @ columns
        raise RuntimeError("the set of slack droppers still changes after 100 iterations")

    def _column(self, j: int) -> Floats:
        if j not in self._columns:
            self._columns[j] = self._structure.solve(self._elongation[[j]].toarray().ravel(), self._zero)[0]
        return self._columns[j]


# Ends of the droppers and clamps of the stitch wires, as interpolated displacements.
def dropper_ends(line: Line, strands: Strands, axis: str) -> tuple[list[Weights], list[Weights]]:
    """Interpolation at the lower and at the upper ends of the droppers."""
    below = [strands["contact", axis].weights(d.position) for d in line.droppers]
    return below, [strands[d.upper, axis].weights(d.position) for d in line.droppers]


def ties(line: Line, strands: Strands, axis: str) -> list[Weights]:
    """Stitch wire minus messenger at every clamp."""
    return [
        join((1.0, strands[name, axis].weights(x)), (-1.0, strands["messenger", axis].weights(x)))
        for x, name in line.clamps
    ]


# State of rest of the second formulation: heights, dropper tensions and lengths, and the linearised bars.
#
# 1. The contact wire is held at its prescribed heights; the holding forces are the dropper tensions.
# 2. Messenger and stitch wires hang between the supports under weights and dropper tensions.
# 3. Staggers are prescribed in plan view; a dropper with vertical force V and height z is a lateral spring V / z.
# 4. Distances between the wires are dropper lengths. Dropper masses are those of the case.
@dataclass(frozen=True)
class Rest:
    """State of rest."""

    shape: Floats
    """Height above the contact wire at the supports or lateral position of every point, (size,) [m]."""
    dropper_force: Floats
    """Vertical force at mid-length, (droppers,) [N]."""
    dropper_extent: Floats
    """Upper minus lower end, y and z, (droppers, 2) [m]."""
    arm_force: Floats
    """Force of each steady arm on the contact wire, y and z, (supports, 2) [N]."""

    @property
    def dropper_length(self) -> Floats:
        """Lengths between the axes of the wires [m]."""
        return np.hypot(*self.dropper_extent.T)


def compute_rest(line: Line, strands: Strands) -> Rest:
    """State of rest of a line."""
    n, table, supports, gravity = size(strands), line.derived["droppers"], line.supports, line.gravity
    mass = np.array([dropper.mass for dropper in line.droppers])
    contact = strands["contact", "z"]
    below, above = dropper_ends(line, strands, "z")
    # 1. Contact wire.
    level = np.array([arm["static_share"] == "level" for arm in line.arms], dtype=bool)
    at_limits = line.contact_heights
    held = [contact.weights(0.0), contact.weights(contact.wire.end), *below]
    held += [contact.weights(x) for x, carries in zip(supports, level, strict=True) if carries]
    heights = np.array([*at_limits[[0, -1]], *(d.height for d in line.droppers), *at_limits[1:-1][level]])
    weight = np.zeros(n)
    for part in line.point_masses:
        points, weights = strands[part.wire, "z"].weights(part.position)
        weight[points] -= gravity * part.mass * weights
    shape, force = _hang(strands, ["contact"], gravity, weight, held, heights)
    holding, arm_force = force[2 : 2 + len(below)], np.zeros((len(supports), 2))
    arm_force[level, 1] = force[2 + len(below) :]
    vertical = holding + gravity * (table["lower_clamp_kg"] + mass / 2)
    # 2. Messenger and stitch wires.
    upper = [wire.name for wire in line.wires if wire.name != "contact"]
    load = weight - (rows(above, n).T @ (vertical + gravity * (table["upper_clamp_kg"] + mass / 2)))
    messenger = strands["messenger", "z"]
    for x, _ in line.clamps:
        load[messenger.point(x)] -= gravity * line.derived["stitch_wires"]["clamp_mass_kg"]
    held = [messenger.weights(x) for x in line.span_limits] + ties(line, strands, "z")
    heights = np.append(line.derived["messenger_wire"]["height_m"], np.zeros(len(line.clamps)))
    shape += _hang(strands, upper, gravity, load, held, heights)[0]
    extent = np.zeros((len(line.droppers), 2))
    extent[:, 1] = (rows(above, n) - rows(below, n)) @ shape
    # 3. Plan view.
    if line.staggered:
        lateral, arm_force[:, 0] = _plan_view(line, strands, vertical / extent[:, 1])
        shape += lateral
        below, above = dropper_ends(line, strands, "y")
        extent[:, 0] = (rows(above, n) - rows(below, n)) @ shape
    return Rest(shape, vertical, extent, arm_force)


def _hang(
    strands: Strands, names: list[str], gravity: float, load: Floats, held: list[Weights], values: Floats
) -> tuple[Floats, Floats]:
    """Heights and holding forces of some wires under their weights and a load."""
    n, parts = size(strands), [strands[name, "z"] for name in names]
    load = load.copy()
    for part in parts:
        load[part.first : part.first + part.count] += part.weight(gravity)
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
    load = np.zeros(n)
    for wire in line.wires:
        strand = strands[wire.name, "y"]
        places = np.arange(strand.first, strand.first + strand.count)
        x = wire.start + strand.spacing * (places - strand.first)
        tension = wire.tension + sum(change * ((x > start) & (x < end)) for start, end, change in wire.relief)
        load[places] = tension * strand.spacing * line.curvature(x)
    shape, force = _solve_part(sp.csc_array(stiffness), rows(held, n), load, np.array(values))
    return shape, force[1 : 1 + len(line.supports)]
