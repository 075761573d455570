"""Coverage of the intervals of `pantocheck pantograph fit`: published chains, measured with noise, fitted many times.

    python -m verification.tables.pantograph_fit [--seeds 200] [--rows 120]

For each pantograph, the noise of modulus and phase is 1 % and 0.5 degrees. The table shows the share
of the 95 % intervals that contain the truth, of all parameters and of the one with the smallest share.
"""

import argparse

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.comparison.response_comparison import model_stiffness
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.chain_fit import compute_intervals, fit_chain
from pantocheck.conformance.pantograph.chain_problem import MeasuredStiffness
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

PANTOGRAPHS = (
    "en50318-2018/pantograph.toml",
    "en50318-2002/pantograph.toml",
    "pantographs/dsa380.toml",
    "pantographs/dsa250.toml",
)
NOISE = np.array([0.01, np.radians(0.5)])
"""Standard deviations of the logarithm of the modulus and of the phase [rad]."""

HEADINGS = (
    "pantograph",
    "95 % intervals that contain the truth",
    "least of one parameter",
    "mean half-width of the head mass",
)


def measure(stiffness: NDArray[np.complex128], frequency: NDArray[np.float64], seed: int) -> MeasuredStiffness:
    """Dynamic stiffness with independent normal errors."""
    errors = NOISE[:, None] * np.random.default_rng(seed).standard_normal((2, frequency.size))
    weight = np.repeat(1 / NOISE[:, None], frequency.size, axis=1)
    return MeasuredStiffness(frequency, stiffness * np.exp(errors[0] + 1j * errors[1]), weight)


def print_coverage(name: str, seeds: int, rows: int) -> None:
    """Fit a pantograph of the library once per seed."""
    pantograph = read_model(library_folder() / name, PantographFile, "pantograph")
    if pantograph.chain is None:
        raise ValueError(f"{name} is no chain")
    truth = np.array([pantograph.chain.masses_kg, pantograph.chain.stiffness_N_m, pantograph.chain.damping_N_s_m])
    frequency = np.geomspace(0.5, 50, rows)
    exact = model_stiffness(pantograph, frequency)
    values, widths = [], []
    for seed in range(seeds):
        fit = fit_chain(measure(exact, frequency, seed), np.full(truth.shape, np.nan))
        values.append(fit.values)
        widths.append(compute_intervals(fit, is_noise_stated=True).half_width)
    inside = np.abs(np.array(values) - truth) <= np.array(widths)
    least = inside.mean(axis=0)[truth > 0].min()
    head = np.mean(widths, axis=0)[0, -1] / truth[0, -1]
    print(f"| {pantograph.title} | {inside.mean():.1%} | {least:.1%} | {head:.2%} |".replace("%", " %"), flush=True)


def main() -> None:
    """Read the options."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--rows", type=int, default=120)
    options = parser.parse_args()
    print(f"| {' | '.join(HEADINGS)} |\n|---|--:|--:|--:|")
    for name in PANTOGRAPHS:
        print_coverage(name, options.seeds, options.rows)


if __name__ == "__main__":
    main()
