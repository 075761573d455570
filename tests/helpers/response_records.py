"""Response records computed with a pantograph of the library, so that masses and noise are known."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

FREQUENCY = np.geomspace(0.5, 50.0, 120)
"""Frequencies of a rig [Hz]: 26 per octave of ten percent steps and less."""

Complex = NDArray[np.complex128]


def read_pantograph(path: str = "en50318-2018/pantograph.toml") -> PantographFile:
    """Pantograph of the library."""
    return read_model(library_folder() / path, PantographFile, "pantograph")


def scale_head(pantograph: PantographFile, factor: float) -> PantographFile:
    """Pantograph with the mass of its head multiplied."""
    masses = pantograph.chain.masses_kg
    chain = pantograph.chain.model_copy(update={"masses_kg": (*masses[:-1], factor * masses[-1])})
    return pantograph.model_copy(update={"chain": chain})


def chain_stiffness(pantograph: PantographFile, frequency: NDArray[np.float64] = FREQUENCY) -> Complex:
    """Dynamic stiffness of a chain from the base upwards: each element in series, each mass in parallel [N/m]."""
    chain = pantograph.chain
    s = 2j * np.pi * frequency
    total: Any = np.inf
    for mass, stiffness, damping in zip(chain.masses_kg, chain.stiffness_N_m, chain.damping_N_s_m, strict=True):
        total = 1 / (1 / (stiffness + s * damping) + 1 / total) + s**2 * mass
    return total


def add_noise(response: Complex, seed: int, modulus: float = 0.01, phase_deg: float = 0.5) -> Complex:
    """Response with independent normal errors of modulus and phase, given by their standard deviations."""
    random = np.random.default_rng(seed)
    errors = modulus * random.standard_normal(response.size) + 1j * np.radians(phase_deg) * random.standard_normal(
        response.size
    )
    return response * np.exp(errors)


def write_response(
    folder: Path,
    table_columns: dict[str, Sequence[float] | NDArray[np.float64]],
    name: str = "measured",
    **sidecar: Any,
) -> Path:
    """Write a table and its sidecar; return the path of the table."""
    rows = [",".join(f"{value:.12g}" for value in row) for row in zip(*table_columns.values(), strict=True)]
    table = folder / f"{name}.csv"
    table.write_text("\n".join([",".join(table_columns), *rows]) + "\n", encoding="utf-8")
    stated = {
        "schema": "pantocheck.response/1",
        "file": table.name,
        "kind": "apparent_mass",
        "rows": len(rows),
        "static_force_N": 70.0,
        **sidecar,
    }
    content = {key: value for key, value in stated.items() if value is not None}
    table.with_suffix(".toml").write_text(tomli_w.dumps(content), encoding="utf-8")
    return table


def polar_columns(response: Complex, unit: str, frequency: NDArray[np.float64] = FREQUENCY) -> dict[str, Any]:
    """Frequency, modulus and phase of a response."""
    phase = np.degrees(np.angle(response))
    return {"frequency_Hz": frequency, f"modulus_{unit}": np.abs(response), "phase_deg": phase}


def apparent_mass_columns(stiffness: Complex, frequency: NDArray[np.float64] = FREQUENCY) -> dict[str, Any]:
    """Frequency, modulus and phase of the apparent mass of a dynamic stiffness."""
    return polar_columns(-stiffness / (2 * np.pi * frequency) ** 2, "kg", frequency)
