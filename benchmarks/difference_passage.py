"""Passage of a case in the second formulation: start at rest under the static force, run, quantities."""

from dataclasses import dataclass

import numpy as np
from difference_arrays import Model, build_model
from difference_data import Heads
from difference_line import build_line
from difference_step import march
from difference_strands import Floats

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.pantograph_file import ChainTable
from pantocheck.conformance.quantities.bands import band_rms
from pantocheck.conformance.quantities.filters import LowPass

HEIGHT_SAMPLES = 24
"""Positions along a span for the mean working height."""
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


def simulate(case: Case, model: Model, uplift_forces: tuple[float, ...]) -> Passage:
    """Simulate the passage of a case with given uplift forces [N]."""
    arrays = model.arrays
    starts = np.array(case.start_positions)
    steps = int((case.end - case.start) / case.speed / arrays.step) + 1
    rest = sum(model.point_load(x, f) for x, f in zip(starts, uplift_forces, strict=True))
    displacement = model.uplift.displacement(rest)
    heads = _heads(case, model, starts, uplift_forces, displacement)
    force = np.zeros((starts.size, steps))
    every = max(1, int(RECORDING_STEP / arrays.step + 1e-9))
    start, end = case.analysis_section
    watched = np.array([model.contact.point(x) for x in model.line.supports if start - 1e-6 <= x <= end + 1e-6])
    uplift = np.zeros((watched.size, (steps - 1) // every + 1))
    march(arrays, heads, displacement, np.zeros_like(displacement), force, uplift, watched, every)
    position = starts[:, None] + case.speed * arrays.step * np.arange(steps)
    return Passage(force, position, uplift, arrays.step)


def working_height(case: Case, model: Model, force: float, contact_stiffness: float) -> float:
    """Mean height of the head over the first span of the analysis section under a static force, above the line at rest.

    This height is counted from the contact wire at rest, as the case library does.
    """
    start, end = case.line.geometry.span((case.file.evaluated_spans or (1,))[0])
    positions = start + (end - start) * np.arange(HEIGHT_SAMPLES) / HEIGHT_SAMPLES
    return float(np.mean([model.static_uplift(x, force) for x in positions])) + force / contact_stiffness


def _heads(case: Case, model: Model, starts: Floats, uplift_forces: tuple[float, ...], displacement: Floats) -> Heads:
    chains = [_chain(file.chain) for file in case.pantographs]
    stiffness = case.pantographs[0].contact.stiffness_N_m
    unstretched, height, uplift = [], [], []
    cache: dict[float, float] = {}
    for chain, x, force in zip(chains, starts, uplift_forces, strict=True):
        if chain.base_spring_unstretched == "working_height":
            free = cache.setdefault(force, working_height(case, model, force, stiffness))
        else:
            free = 0.0
        load = np.zeros(len(chain.masses_kg))
        load[chain.uplift_mass] = force
        head = model.lift(x, model.rest.shape + displacement) + force * (1 / stiffness - model.contact.excess_at(x))
        unstretched.append(free)
        uplift.append(load)
        height.append(_equilibrium(np.array(chain.stiffness_N_m), load, free, head))
    return Heads(
        position=starts.copy(),
        speed=case.speed,
        mass=np.array([chain.masses_kg for chain in chains]),
        stiffness=np.array([chain.stiffness_N_m for chain in chains]),
        damping=np.array([chain.damping_N_s_m for chain in chains]),
        unstretched=np.array(unstretched),
        uplift=np.array(uplift),
        contact_stiffness=stiffness,
        height=np.array(height),
        velocity=np.zeros((starts.size, len(chains[0].masses_kg))),
    )


def _chain(chain: ChainTable | None) -> ChainTable:
    if chain is None:
        raise ValueError("the second formulation has pantographs of lumped masses only")
    return chain


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
    force: Floats, position: Floats, rate: float, section: tuple[float, float], low_pass: LowPass
) -> dict[str, float]:
    """Quantities of one contact force over an analysis section."""
    inside = (position >= section[0] - 1e-9) & (position < section[1] - 1e-9)
    filtered = low_pass(force, rate)[inside]
    raw = force[inside]
    bands = [band_rms(raw, rate, *edges) for edges in ((0.0, 5.0), (5.0, 20.0), (20.0, 50.0))]
    values = (raw.mean(), filtered.std(), *bands, filtered.max(), filtered.min())
    return dict(zip(QUANTITIES, map(float, values), strict=True))


def difference_quantities(case: Case, spacing: float, uplift_forces: tuple[float, ...]) -> Quantities:
    """Quantities of a case in the second formulation."""
    model = build_model(build_line(case.line), spacing)
    passage = simulate(case, model, uplift_forces)
    section, low_pass, values = case.analysis_section, case.file.filter.low_pass, Quantities()
    for k, (force, position) in enumerate(zip(passage.force, passage.position, strict=True), 1):
        quantities = force_quantities(force, position, 1 / passage.step, section, low_pass)
        values |= {(k, name): value for name, value in quantities.items()}
    start, end = case.line.geometry.span((case.file.evaluated_spans or (1,))[0])
    lifts = [model.static_uplift(x, 1.0) for x in ((start + end) / 2, start)]
    in_mm = [1e3 * value for value in (float(passage.uplift.max()), *lifts)]
    return values | {(0, name): value for name, value in zip(LINE_QUANTITIES, in_mm, strict=True)}
