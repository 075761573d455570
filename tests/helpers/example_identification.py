"""Identification of exact decays as it stands in identification.json: two repeats of one drop, no search of poles."""

from typing import Any

import numpy as np

from helpers.exact_decays import build_exact_decay, build_exact_fit
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import Identification
from pantocheck.conformance.drops.line_fit import build_modes

FREQUENCY = np.array([0.88, 0.92, 0.97, 1.75, 1.86, 1.93])
RATIO = np.array([0.0050, 0.0048, 0.0046, 0.0030, 0.0029, 0.0028])
RESIDUES = np.array([[1.0, 0.4], [0.7, -0.9], [0.6, 0.8], [0.5, -0.5], [0.4, 0.3], [0.3, -0.2]])


def build_example_line() -> dict[str, Any]:
    """One entry of the `lines` of identification.json: three modes in each of two groups, two sensors, 80 s."""
    poles = 2 * np.pi * FREQUENCY * (-RATIO + 1j * np.sqrt(1 - RATIO**2))
    decays = [build_exact_decay(poles, RESIDUES.astype(complex), f"run {n}", duration=80.0) for n in (1, 2)]
    fit = build_exact_fit(decays, poles, np.array([1e-4]))
    line = analyse_identification(Identification(fit, build_modes(fit, 3), ()))
    return line.model_dump(mode="json", by_alias=True)
