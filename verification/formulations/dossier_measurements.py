"""Measurements of the example dossier: passages, static values and frequency responses, none of them of a real line.

The passages and static values come from the second formulation (docs/second-formulation.md), which shares no code with
the reference simulator, on a line with 30 % more stiffness-proportional damping. A measuring chain adds noise, an
inertia error of the head, sampling and rounding. The frequency responses come from springs, dampers and
masses in series, with noise. Seeds are fixed: the command writes the same bytes each time.

python -m verification.formulations.dossier_measurements [--out examples/dossier/measured]
"""

import argparse
import zlib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import scipy
import tomli_w

from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.command_system import build_case_message
from verification.formulations.difference_arrays import Model, build_model
from verification.formulations.difference_line import CaseData, build_line
from verification.formulations.difference_passage import Passage, simulate
from verification.formulations.difference_strands import Floats

DOSSIER = Path(__file__).parents[2] / "examples" / "dossier"
RUNS = ("run-160", "run-200", "run-200-two")
DAMPING = (
    "line.damping.contact_wire.stiffness_coefficient_s=6.5e-5",
    "line.damping.messenger_wire.stiffness_coefficient_s=6.5e-5",
)
"""Damping of the measured line: 30 % more than in its file."""
SPACING = 0.25
"""Spacing of the points of the second formulation [m]."""
RATE = 150.0
"""Sampling rate of the measuring chain [Hz]."""
FORCE_NOISE_N, HEIGHT_NOISE_M, UPLIFT_NOISE_M = 1.5, 0.5e-3, 0.3e-3
"""Standard deviations of the noise of the measuring chain."""
INERTIA_ERROR = 0.05
"""Share of the inertia force of the head that the correction of the measuring chain leaves."""
FIRST_POSITION_M = 140.0
"""Position of the first pantograph at the first stored sample [m]."""
STATIC_FORCE_N, STATIC_POSITIONS_M = 100.0, np.arange(100.0, 500.0, 5.0)
"""Force of the measured elasticity, and measured positions."""
ELASTICITY_NOISE, STATIC_HEIGHT_NOISE_M = 0.01, 1.5e-3
"""Relative standard deviation of the elasticities, and standard deviation of the heights."""
FREQUENCIES_HZ = np.geomspace(0.5, 50.0, 120)
LOADS_N = (70.0, 110.0)
"""Static forces of the frequency responses [N]."""
MODULUS_NOISE, PHASE_NOISE_DEG = 0.01, 0.5
"""Standard deviations of the noise of the frequency responses."""
SYSTEM = {"name": "Measuring chain of the example", "version": "second formulation, other damping"}


def main() -> None:
    """Write all measurements."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=Path, default=DOSSIER / "measured", help="folder of the measurements")
    folder = options.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    for name in RUNS:
        write_passage(folder, name)
    write_statics(folder)
    for load in LOADS_N:
        write_response(folder, load)


def read_run(name: str) -> CaseData:
    """Case of a run of the example on the measured line, as a program receives it."""
    (case,) = select_cases([str(DOSSIER / f"{name}.toml")], parse_changes(DAMPING))
    return build_case_message(case)


def write_passage(folder: Path, name: str) -> None:
    """Write the measured record of a run."""
    case = read_run(name)
    model = build_model(build_line(case), SPACING)
    passage = simulate(case, model, tuple(pantograph["uplift_force_N"] for pantograph in case["pantographs"]))
    random = seeded(name)
    time = np.arange(passage.force.shape[1]) * passage.step
    kept = np.arange(np.searchsorted(passage.position[0], FIRST_POSITION_M) * passage.step, time[-1], 1 / RATE)
    columns = {"time_s": (kept - kept[0], 5)}
    motions = [move_head(p["chain"], p["contact"]["stiffness_N_m"], f, passage.step) for p, f in zip(
        case["pantographs"], passage.force, strict=True)]  # fmt: skip
    for k, (position, force, (height, inertia)) in enumerate(
        zip(passage.position, passage.force, motions, strict=True), 1
    ):
        measured = force + INERTIA_ERROR * inertia + FORCE_NOISE_N * random.standard_normal(time.size)
        columns[f"position_{k}_m"] = (np.interp(kept, time, position), 3)
        columns[f"force_{k}_N"] = (np.interp(kept, time, measured), 1)
        noisy = np.interp(kept, time, height) + HEIGHT_NOISE_M * random.standard_normal(kept.size)
        columns[f"contact_height_{k}_mm"] = (1e3 * noisy, 1)
    start, end = case["evaluated_m"]
    supports = [x for x in model.line.supports if start - 1e-6 <= x <= end + 1e-6]
    for k, uplift in enumerate(resample_uplift(passage, time), 1):
        noisy = np.interp(kept, time, uplift) + UPLIFT_NOISE_M * random.standard_normal(kept.size)
        columns[f"uplift_{k}_mm"] = (1e3 * noisy, 1)
    sidecar = {
        "schema": "pantocheck.record/1",
        "file": f"{name}.csv",
        "speed_km_h": case["speed_km_h"],
        "pantographs": len(case["pantographs"]),
        "evaluated_m": case["evaluated_m"],
        "filter_applied_Hz": "none",
        "support_position_m": supports,
        "system": SYSTEM,
    }
    starts = [pantograph["start_m"] for pantograph in case["pantographs"]]
    if len(starts) > 1:
        sidecar["spacing_m"] = [float(ahead - behind) for ahead, behind in pairwise(starts)]
    write_table(folder / f"{name}.csv", columns, sidecar)


def move_head(chain: CaseData, contact_stiffness: float, force: Floats, step: float) -> tuple[Floats, Floats]:
    """Rise of the contact point since the start [m], and inertia force of the head [N], under a contact force.

    The chain starts at rest; its equations are integrated exactly for a force that is linear between the samples.
    """
    masses, stiffness, damping = (np.array(chain[key]) for key in ("masses_kg", "stiffness_N_m", "damping_N_s_m"))
    n = masses.size
    elongation = np.eye(n) - np.eye(n, k=-1)
    mass = np.diag(1 / masses)
    system = np.block(
        [
            [np.zeros((n, n)), np.eye(n)],
            [-mass @ elongation.T @ np.diag(part) @ elongation for part in (stiffness, damping)],
        ]
    )
    load = np.zeros((2 * n, 1))
    load[-1] = -1 / masses[-1]
    change = force - force[0]
    state = scipy.signal.lsim(
        (system, load, np.eye(2 * n), np.zeros((2 * n, 1))), change, np.arange(force.size) * step
    )[1]
    inertia = masses[-1] * (state @ system[-1] + load[-1, 0] * change)
    return state[:, n - 1] - change / contact_stiffness, inertia


def resample_uplift(passage: Passage, time: Floats) -> list[Floats]:
    """Uplift of every support at the times of the force [m]."""
    every = np.arange(passage.uplift.shape[1]) * (time[-1] / (passage.uplift.shape[1] - 1))
    return [np.interp(time, every, uplift) for uplift in passage.uplift]


def write_statics(folder: Path) -> None:
    """Write measured elasticities and contact wire heights."""
    random, model = seeded("statics"), build_model(build_line(read_run(RUNS[0])), SPACING)
    elasticity, height = static_values(model)
    elasticity *= 1 + ELASTICITY_NOISE * random.standard_normal(elasticity.size)
    height += STATIC_HEIGHT_NOISE_M * random.standard_normal(height.size)
    columns = {
        "position_m": (STATIC_POSITIONS_M, 2),
        "elasticity_mm_N": (1e3 * elasticity, 4),
        "contact_wire_height_m": (height, 4),
    }
    sidecar = {
        "schema": "pantocheck.static/1",
        "file": "statics.csv",
        "force_N": [STATIC_FORCE_N],
        "evaluated_spans": [3, 10],
        "largest_distance_m": 5.0,
        "elasticity_uncertainty_mm_N": float(f"{1.96e3 * ELASTICITY_NOISE * elasticity.max():.2g}"),
        "height_uncertainty_mm": float(f"{1.96e3 * STATIC_HEIGHT_NOISE_M:.2g}"),
    }
    write_table(folder / "statics.csv", columns, sidecar)


def static_values(model: Model) -> tuple[Floats, Floats]:
    """Elasticities [m/N] and heights of the contact wire at rest [m]."""
    elasticity = [model.static_uplift(x, STATIC_FORCE_N) / STATIC_FORCE_N for x in STATIC_POSITIONS_M]
    return np.array(elasticity), np.array([model.lift(x, model.rest.shape) for x in STATIC_POSITIONS_M])


def write_response(folder: Path, load: float) -> None:
    """Write the measured apparent mass of the head under a static force [N]."""
    name = f"response-{load:g}N"
    random = seeded(name)
    chain = read_run(RUNS[0])["pantographs"][0]["chain"]
    response = -series_stiffness(chain, FREQUENCIES_HZ) / (2 * np.pi * FREQUENCIES_HZ) ** 2
    modulus = np.abs(response) * np.exp(MODULUS_NOISE * random.standard_normal(response.size))
    phase = np.degrees(np.angle(response)) + PHASE_NOISE_DEG * random.standard_normal(response.size)
    columns = {"frequency_Hz": (FREQUENCIES_HZ, 4), "modulus_kg": (modulus, 4), "phase_deg": (phase, 2)}
    sidecar = {
        "schema": "pantocheck.response/1",
        "file": f"{name}.csv",
        "kind": "apparent_mass",
        "rows": FREQUENCIES_HZ.size,
        "static_force_N": load,
        "modulus_uncertainty_pct": 196 * MODULUS_NOISE,
        "phase_uncertainty_deg": 1.96 * PHASE_NOISE_DEG,
        "source": "springs, dampers and masses in series, with noise; "
        "verification/formulations/dossier_measurements.py",
    }
    write_table(folder / f"{name}.csv", columns, sidecar)


def series_stiffness(chain: CaseData, frequency: Floats) -> np.ndarray:
    """Dynamic stiffness at the head of a chain: from the base, each spring in series, each mass in parallel [N/m]."""
    s = 2j * np.pi * frequency
    total = np.full(frequency.size, np.inf, dtype=complex)
    for mass, stiffness, damping in zip(
        chain["masses_kg"], chain["stiffness_N_m"], chain["damping_N_s_m"], strict=True
    ):
        total = 1 / (1 / (stiffness + s * damping) + 1 / total) + s**2 * mass
    return total


def seeded(name: str) -> np.random.Generator:
    """Random numbers of one measurement, always the same."""
    return np.random.default_rng(zlib.crc32(name.encode()))


def write_table(path: Path, columns: dict[str, tuple[Floats, int]], sidecar: dict[str, object]) -> None:
    """Write a table with given decimals and its sidecar."""
    texts: Sequence[Sequence[str]] = [[f"{x:.{digits}f}" for x in values] for values, digits in columns.values()]
    rows = [",".join(row) for row in zip(*texts, strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n", encoding="utf-8")
    path.with_suffix(".toml").write_text(tomli_w.dumps(sidecar), encoding="utf-8")


if __name__ == "__main__":
    main()
