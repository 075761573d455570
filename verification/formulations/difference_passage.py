"""Passage of a case in the second formulation: start at rest under the static force, run, quantities."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
    """Contact forces [N] and positions [m], (P, T) each, uplift of the supports (U, S) [m] and time step [s]."""

    force: Floats
    position: Floats
    uplift: Floats
    step: float


def simulate(case: CaseData, model: Model, uplift_forces: tuple[float, ...]) -> Passage:
    """Simulate the passage of a case with given uplift forces [N]."""
    check_conventions(case)
    arrays, speed, last = model.arrays, case["speed_km_h"] / 3.6, case["pantographs"][-1]
    starts = np.array([pantograph["start_m"] for pantograph in case["pantographs"]])
    steps = int((last["end_m"] - last["start_m"]) / speed / arrays.step) + 1
    rest = sum(model.point_load(x, f) for x, f in zip(starts, uplift_forces, strict=True))
    displacement = model.uplift.displacement(rest)
    heads = build_heads(case, model, starts, uplift_forces, displacement)
    force = np.zeros((starts.size, steps))
    every = max(1, int(RECORDING_STEP / arrays.step + 1e-9))
    start, end = case["evaluated_m"]
    watched = np.array([model.contact.point(x) for x in model.line.supports if start - 1e-6 <= x <= end + 1e-6])
    uplift = np.zeros((watched.size, (steps - 1) // every + 1))
    march(arrays, heads, displacement, np.zeros_like(displacement), force, uplift, watched, every)
    position = starts[:, None] + speed * arrays.step * np.arange(steps)
    return Passage(force, position, uplift, arrays.step)


def check_conventions(case: CaseData) -> None:
    """Require the start and the contact that this formulation computes with."""
    start = case["derived"]["train"]["start"]
    if start["state"] != "equilibrium_under_uplift_forces" or start["ramp_m"] or start["line_velocity_m_s"]:
        raise ValueError("the second formulation starts at rest under the uplift forces, without a ramp")


def working_height(case: CaseData, model: Model, force: float, contact_stiffness: float) -> float:
    """Height of the head under a static force: nominal height, mean uplift of the wire, and the contact [m]."""
    positions = case["derived"]["train"]["working_height_positions_m"]
    lift = float(np.mean([model.static_uplift(x, force) for x in positions])) + force / contact_stiffness
    return nominal_height(case, model) + lift


def nominal_height(case: CaseData, model: Model) -> float:
    """Mean height of the straight lines between the supports over the positions of the working height [m]."""
    positions = case["derived"]["train"]["working_height_positions_m"]
    return float(np.interp(positions, model.line.span_limits, model.line.contact_heights).mean())


def build_heads(
    case: CaseData, model: Model, starts: Floats, uplift_forces: tuple[float, ...], displacement: Floats
) -> Heads:
    """Pantographs at rest on the displaced line."""
    chains = [_chain(pantograph) for pantograph in case["pantographs"]]
    contact = case["pantographs"][0]["contact"]
    if contact.get("law", "spring") == "hertz" or contact.get("damping_N_s_m"):
        raise ValueError("the second formulation has contacts by a spring without damper, or by a constraint")
    stiffness = contact.get("stiffness_N_m", np.inf)
    excess = 0.0 if np.isinf(stiffness) else 1.0
    unstretched, height, uplift = [], [], []
    cache: dict[float, float] = {}
    for pantograph, chain, x, force in zip(case["pantographs"], chains, starts, uplift_forces, strict=True):
        if chain["base_spring_unstretched"] == "working_height":
            free = cache.setdefault(force, working_height(case, model, force, stiffness))
        else:
            free = nominal_height(case, model)
        load = _place_forces(pantograph, chain, force)
        head = model.lift(x, model.rest.shape + displacement) + force * (
            1 / stiffness - excess * model.contact.excess_at(x)
        )
        unstretched.append(free)
        uplift.append(load)
        height.append(_equilibrium(np.array(chain["stiffness_N_m"]), load, free, head))
    return Heads(
        position=starts.copy(),
        speed=case["speed_km_h"] / 3.6,
        mass=np.array([chain["masses_kg"] for chain in chains]),
        stiffness=np.array([chain["stiffness_N_m"] for chain in chains]),
        damping=np.array([chain["damping_N_s_m"] for chain in chains]),
        unstretched=np.array(unstretched),
        uplift=np.array(uplift),
        contact_stiffness=stiffness,
        height=np.array(height),
        velocity=np.zeros((starts.size, len(chains[0]["masses_kg"]))),
    )


def _chain(pantograph: CaseData) -> CaseData:
    chain: CaseData | None = pantograph["chain"]
    if chain is None:
        raise ValueError("the second formulation has pantographs of lumped masses only")
    return chain


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


def _equilibrium(stiffness: Floats, load: Floats, free: float, head: float) -> Floats:
    """Heights of the masses of a chain at rest with the head held; the first spring is unstretched at `free`."""
    n = stiffness.size
    system, right = np.zeros((n, n)), load.copy()
    for j in range(n):
        system[j, j] += stiffness[j]
        if j > 0:
            system[j - 1, j - 1] += stiffness[j]
            system[j, j - 1] -= stiffness[j]
            system[j - 1, j] -= stiffness[j]
    right[0] += stiffness[0] * free
    system[-1], right[-1] = np.eye(n)[-1], head
    return np.linalg.solve(system, right)


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


def difference_quantities(case: CaseData, spacing: float, uplift_forces: tuple[float, ...]) -> Quantities:
    """Quantities of a case, as a program receives it, in the second formulation."""
    model = build_model(build_line(case), spacing)
    passage = simulate(case, model, uplift_forces)
    section, low_pass, values = case["evaluated_m"], Filter(**case["filter"]), Quantities()
    bands = case["derived"]["train"]["evaluation"]["bands_Hz"]
    for k, (force, position) in enumerate(zip(passage.force, passage.position, strict=True), 1):
        quantities = force_quantities(force, position, 1 / passage.step, section, low_pass, bands)
        values |= {(k, name): value for name, value in quantities.items()}
    start = section[0]
    end = min(x for x in model.line.span_limits if x > start)
    lifts = [model.static_uplift(x, 1.0) for x in ((start + end) / 2, start)]
    in_mm = [1e3 * value for value in (float(passage.uplift.max()), *lifts)]
    return values | {(0, name): value for name, value in zip(LINE_QUANTITIES, in_mm, strict=True)}
