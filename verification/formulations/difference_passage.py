"""Passage of a case in the second formulation: start at rest under the static force, run, quantities."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.quantities.bands import band_rms
from pantocheck.conformance.quantities.filters import Filter
from verification.formulations.difference_arrays import Model, build_model
from verification.formulations.difference_line import CaseData, Heads, build_line
from verification.formulations.difference_step import march
from verification.formulations.difference_strands import Floats

RECORDING_STEP = 0.5e-3
"""Largest time between two recorded displacements of the supports [s]."""
QUANTITIES = (
    "mean_force_N",
    "std_force_N",
    "rms_0_5_N",
    "rms_5_20_N",
    "rms_20_50_N",
    "max_force_N",
    "min_force_N",
)
LINE_QUANTITIES = ("max_uplift_at_support_mm", "elasticity_mid_span_mm_N", "elasticity_support_mm_N")
Quantities = dict[tuple[int, str], float]
"""Values by pantograph, 0 for the line, and name."""


@dataclass(frozen=True)
class Passage:
    """Strip forces (P, strips, T) [N], positions (P, T) [m], uplift of the supports (U, S) [m] and time step [s]."""

    strip_force: Floats
    position: Floats
    uplift: Floats
    step: float

    @property
    def force(self) -> Floats:
        """Contact force of every pantograph, (P, T) [N]."""
        return np.asarray(self.strip_force.sum(axis=1))


def simulate(case: CaseData, model: Model, uplift_forces: tuple[float, ...]) -> Passage:
    """Simulate the passage of a case with given uplift forces [N]."""
    check_conventions(case)
    arrays, speed, last = model.arrays, case["speed_km_h"] / 3.6, case["pantographs"][-1]
    starts = np.array([pantograph["start_m"] for pantograph in case["pantographs"]])
    steps = int((last["end_m"] - last["start_m"]) / speed / arrays.step) + 1
    rest = sum(
        model.point_load(x + ahead, share)
        for x, pantograph, force in zip(starts, case["pantographs"], uplift_forces, strict=True)
        for ahead, share in _list_strip_forces(pantograph, force)
    )
    displacement = model.uplift.displacement(rest)
    heads = build_heads(case, model, starts, uplift_forces, displacement)
    force = np.zeros((*heads.offset.shape, steps))
    every = max(1, int(RECORDING_STEP / arrays.step + 1e-9))
    start, end = case["evaluated_m"]
    watched = np.array([model.contact.point(x) for x in model.line.supports if start - 1e-6 <= x <= end + 1e-6])
    uplift = np.zeros((watched.size, (steps - 1) // every + 1))
    march(arrays, heads, displacement, np.zeros_like(displacement), force, uplift, watched, every)
    position = starts[:, None] + speed * arrays.step * np.arange(steps)
    return Passage(force, position, uplift, arrays.step)


def _list_strip_forces(pantograph: CaseData, force: float) -> list[tuple[float, float]]:
    """Offset of every strip, and its part of the uplift force on a level wire [m, N]."""
    part, chain = build_parts(pantograph), pantograph["chain"]
    load = np.zeros(part.mass.size)
    load[: len(chain["masses_kg"])] = _place_forces(pantograph, chain, force)
    return list(zip(part.offset.tolist(), part.level_forces(load, force).tolist(), strict=True))


def check_conventions(case: CaseData) -> None:
    """Require the start and the contact that this formulation computes with."""
    start = case["derived"]["train"]["start"]
    if start["state"] != "equilibrium_under_uplift_forces" or start["ramp_m"] or start["line_velocity_m_s"]:
        raise ValueError("the second formulation starts at rest under the uplift forces, without a ramp")


def working_height(case: CaseData, model: Model, force: float) -> float:
    """Height of the wire under a static force: nominal height and mean uplift of the wire [m]."""
    positions = case["derived"]["train"]["working_height_positions_m"]
    return nominal_height(case, model) + float(np.mean([model.static_uplift(x, force) for x in positions]))


def nominal_height(case: CaseData, model: Model) -> float:
    """Mean height of the straight lines between the supports over the positions of the working height [m]."""
    positions = case["derived"]["train"]["working_height_positions_m"]
    return float(np.interp(positions, model.line.span_limits, model.line.contact_heights).mean())


def build_heads(
    case: CaseData, model: Model, starts: Floats, uplift_forces: tuple[float, ...], displacement: Floats
) -> Heads:
    """Pantographs at rest on the displaced line."""
    contact = case["pantographs"][0]["contact"]
    law, damping = contact.get("law", "spring"), contact.get("damping_N_s_m", 0.0)
    stiffness = contact["stiffness_N_m"] if law == "spring" else np.inf
    excess, hertz = 0.0 if law == "constraint" else 1.0, np.inf
    if law == "hertz":
        hertz = 4 / 3 * contact["effective_modulus_N_m2"] * contact["effective_radius_m"] ** 0.5

    def penetrate(force: float) -> float:
        """Penetration of a strip under a static force [m]."""
        return force / stiffness + (force / hertz) ** (2 / 3)

    parts = [build_parts(pantograph) for pantograph in case["pantographs"]]
    if damping and any(part.shape.shape[1] > 1 for part in parts):
        raise ValueError("the second formulation has no contact damper below a wire that moves across a strip")
    loads, heights, laws = [], [], []
    for pantograph, part, x, force in zip(case["pantographs"], parts, starts, uplift_forces, strict=True):
        free = nominal_height(case, model)
        if pantograph["chain"]["base_spring_unstretched"] == "working_height":
            free = working_height(case, model, force) + penetrate(force / part.offset.size)
        load = np.zeros(part.mass.size)
        masses = len(pantograph["chain"]["masses_kg"])
        load[:masses] = _place_forces(pantograph, pantograph["chain"], force)
        # Every spring is without force with all masses at one height.
        load += part.stiffness @ np.where(part.is_height, free, 0.0)
        shares = part.level_forces(load, force)
        held = [
            model.lift(x + ahead, model.arrays.rest + displacement)
            + penetrate(share)
            - excess * share * model.contact.excess_at(x + ahead)
            for ahead, share in zip(part.offset, shares, strict=True)
        ]
        loads.append(load)
        heights.append(part.hold(load, np.array(held)))
        laws.append(part.joint_law + np.outer(part.joint_datum * free, np.eye(5)[2]))
    return Heads(
        position=starts.copy(),
        speed=case["speed_km_h"] / 3.6,
        mass=np.array([part.mass for part in parts]),
        stiffness=np.array([part.stiffness for part in parts]),
        damping=np.array([part.damping for part in parts]),
        load=np.array(loads),
        offset=np.array([part.offset for part in parts]),
        shape=np.array([part.shape for part in parts]),
        contact_stiffness=stiffness,
        height=np.array(heights),
        velocity=np.zeros((starts.size, parts[0].mass.size)),
        contact_damping=damping or 0.0,
        hertz=hertz,
        joint=np.array([part.joint for part in parts]),
        joint_law=np.array(laws),
    )


@dataclass(frozen=True)
class Parts:
    """Pantograph of n unknowns and S strips: masses of a chain, pitch, strips on springs, roll, bending modes."""

    mass: Floats
    stiffness: Floats
    damping: Floats
    is_height: NDArray[np.bool_]
    """Whether an unknown is a height, (n,)."""
    offset: Floats
    shape: Floats
    """Displacement of each strip per unknown and power of the lateral position of the wire, (S, powers, n)."""
    joint: Floats
    joint_law: Floats
    joint_datum: Floats
    """Friction and stops as in `Heads`, and change of their gap with the height of springs without force, (J,)."""

    @property
    def axis_shape(self) -> Floats:
        """Displacement of each strip per unknown below the axis of the track, (S, n)."""
        return np.asarray(self.shape[:, 0])

    def hold(self, load: Floats, heights: Floats) -> Floats:
        """Displacements at rest with the strips held at heights, (n,)."""
        n, strips = self.mass.size, self.offset.size
        system = np.zeros((n + strips, n + strips))
        system[:n, :n], system[:n, n:], system[n:, :n] = self.stiffness, self.axis_shape.T, self.axis_shape
        return np.linalg.solve(system, np.append(load, heights))[:n]

    def level_forces(self, load: Floats, force: float) -> Floats:
        """Forces of the strips at rest under a level wire, at the height where they add up to a force [N]."""
        n, strips = self.mass.size, self.offset.size
        if strips == 1:
            return np.array([force])
        size = n + strips + 1
        system = np.zeros((size, size))
        system[:n, :n], system[:n, n:-1], system[n:-1, :n] = self.stiffness, self.axis_shape.T, self.axis_shape
        system[n:-1, -1], system[-1, n:-1] = -1.0, 1.0
        right = np.concatenate([load, np.zeros(strips), [force]])
        return np.asarray(np.linalg.lstsq(system, right)[0][n:-1])


def build_parts(pantograph: CaseData) -> Parts:
    """Matrices of a pantograph from its inputs, spring by spring."""
    chain: CaseData | None = pantograph["chain"]
    if chain is None:
        raise ValueError("the second formulation has pantographs of lumped masses only")
    head = pantograph.get("head") or {}
    strips, pitch, roll = head.get("strip", []), head.get("pitch"), head.get("roll")
    modes: list[CaseData] = head.get("bending_mode", [])
    masses = len(chain["masses_kg"])
    turn = masses if pitch else None
    own = [n for n, strip in enumerate(strips) if strip.get("mass_kg")]
    rigid = masses + bool(pitch) + len(own)
    size = rigid + bool(roll) + len(modes)
    mass, shape = np.zeros(size), np.zeros((max(len(strips), 1), 5, size))
    matrices = np.zeros((2, size, size))

    def connect(ends: dict[int, float], spring: float, damper: float) -> None:
        """Add a spring and a damper on a weighted sum of unknowns."""
        row = np.zeros(size)
        row[list(ends)] = list(ends.values())
        matrices[0] += spring * np.outer(row, row)
        matrices[1] += damper * np.outer(row, row)

    mass[:masses] = chain["masses_kg"]
    for n, spring, damper in zip(range(masses), chain["stiffness_N_m"], chain["damping_N_s_m"], strict=True):
        connect({n: 1.0, n - 1: -1.0} if n else {0: 1.0}, spring, damper)
    if pitch and turn is not None:
        mass[turn] = pitch["inertia_kg_m2"]
        connect({turn: 1.0}, pitch["stiffness_N_m_rad"], pitch["damping_N_m_s_rad"])
    shape[0, 0, masses - 1] = 1.0
    for n, strip in enumerate(strips):
        lower = {masses - 1: 1.0} | ({} if turn is None else {turn: strip["position_m"]})
        shape[n] = 0.0
        if n in own:
            place = rigid - len(own) + own.index(n)
            mass[place], shape[n, 0, place] = strip["mass_kg"], 1.0
            ends = {place: -1.0} | lower
            connect(ends, strip["stiffness_N_m"], strip["damping_N_s_m"])
        else:
            shape[n, 0, list(lower)] = list(lower.values())
    if roll:
        mass[rigid], shape[:, 1, rigid] = roll["inertia_kg_m2"], 1.0
        connect({rigid: 1.0}, roll["stiffness_N_m_rad"], roll["damping_N_m_s_rad"])
    for place, mode in enumerate(modes, rigid + bool(roll)):
        omega = 2 * np.pi * mode["frequency_Hz"]
        mass[place] = 1.0
        connect({place: 1.0}, omega**2, 2 * mode["damping_ratio"] * omega)
        for n, polynomial in enumerate(mode["shapes"]):
            shape[n, : len(polynomial), place] = polynomial
    offset = np.array([strip["position_m"] for strip in strips] or [0.0])
    is_height = (np.arange(size) != turn) & (np.arange(size) < rigid)
    shape = shape[:, : int(np.flatnonzero(shape.any(axis=(0, 2))).max()) + 1]
    return Parts(mass, matrices[0], matrices[1], is_height, offset, shape, *_build_joints(head, chain, shape[:, 0]))


def _build_joints(head: CaseData, chain: CaseData, strips: Floats) -> tuple[Floats, Floats, Floats]:
    """Friction and stops between two parts, see `Parts`; displacement of each strip per unknown, (S, n)."""
    size = strips.shape[1]

    def move(part: int | str) -> Floats:
        """Displacement of a part per unknown."""
        if part == "base":
            return np.zeros(size)
        if isinstance(part, str) and part.startswith("strip "):
            return np.asarray(strips[int(part[6:]) - 1])
        return np.asarray(np.eye(size)[_find_mass(chain, part)])

    rows, laws, datum = [], [], []
    for table in head.get("friction", []):
        lower, upper = map(move, table["between"])
        rows.append(upper - lower)
        laws.append((0.0, table["force_N"] / table["sliding_speed_m_s"], 0.0, -table["force_N"], table["force_N"]))
        datum.append(0.0)
    for table in head.get("stop", []):
        lower, upper = map(move, table["between"])
        for sign, key in ((1.0, "extension_m"), (-1.0, "compression_m")):
            if table[key] is not None:
                rows.append(sign * (upper - lower))
                laws.append((table["stiffness_N_m"], table["damping_N_s_m"], table[key], 0.0, np.inf))
                datum.append(sign if "base" in table["between"] else 0.0)
    return np.reshape(rows, (-1, size)), np.reshape(laws, (-1, 5)), np.array(datum)


def _place_forces(pantograph: CaseData, chain: CaseData, uplift_force: float) -> Floats:
    """Constant force on every mass: the uplift force, or its static and its aerodynamic part."""
    load = np.zeros(len(chain["masses_kg"]))
    load[_find_mass(chain, chain["uplift_force_on"])] = uplift_force
    if (applied := pantograph.get("applied_forces")) is not None:
        load[_find_mass(chain, chain["uplift_force_on"])] -= applied["aerodynamic_force_N"]
        load[_find_mass(chain, applied["aerodynamic_force_on"])] += applied["aerodynamic_force_N"]
    return load


def _find_mass(chain: CaseData, on: int | str) -> int:
    """Index of a mass; the case has its name, or its number from 1."""
    return chain["names"].index(on) if isinstance(on, str) else int(on) - 1


def force_quantities(
    force: Floats,
    position: Floats,
    rate: float,
    section: tuple[float, float],
    low_pass: Filter,
    band_edges: Sequence[tuple[float, float]],
) -> dict[str, float]:
    """Quantities of one contact force over an analysis section."""
    inside = (position >= section[0] - 1e-9) & (position < section[1] - 1e-9)
    filtered = low_pass(force, rate)[inside]
    raw = force[inside]
    bands = [band_rms(raw, rate, *edges) for edges in band_edges]
    values = (raw.mean(), filtered.std(), *bands, filtered.max(), filtered.min())
    return dict(zip(QUANTITIES, map(float, values), strict=True))


def name_forces(strips: Floats) -> dict[str, Floats]:
    """Contact force of a pantograph and, if it has two, of its strips (S, T) [N], by the prefix of their quantities."""
    sum_of_strips = {"": strips.sum(axis=0)}
    return sum_of_strips if len(strips) == 1 else sum_of_strips | dict(zip(("front ", "rear "), strips, strict=True))


def difference_quantities(case: CaseData, spacing: float, uplift_forces: tuple[float, ...]) -> Quantities:
    """Quantities of a case, as a program receives it, in the second formulation."""
    model = build_model(build_line(case), spacing)
    passage = simulate(case, model, uplift_forces)
    section, low_pass, values = case["evaluated_m"], Filter(**case["filter"]), Quantities()
    bands = case["derived"]["train"]["evaluation"]["bands_Hz"]
    for k, (strips, position) in enumerate(zip(passage.strip_force, passage.position, strict=True), 1):
        for channel, force in name_forces(strips).items():
            quantities = force_quantities(force, position, 1 / passage.step, section, low_pass, bands)
            values |= {(k, channel + name): value for name, value in quantities.items()}
    start = section[0]
    end = min(x for x in model.line.span_limits if x > start)
    lifts = [model.static_uplift(x, 1.0) for x in ((start + end) / 2, start)]
    in_mm = [1e3 * value for value in (float(passage.uplift.max()), *lifts)]
    return values | {(0, name): value for name, value in zip(LINE_QUANTITIES, in_mm, strict=True)}
