"""Quantities of groups of span modes (Vo Van, Balmes and Lorang 2015), computed from identified modes."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.population_format import PopulationFile
from pantocheck.conformance.quantities.evaluation import Value

HIGHEST_HZ = 6.0
"""Vo Van, Balmes and Lorang (2015): from the third group to this frequency [Hz], the damping does not vary."""


def compute_group_findings(modes: Sequence[Mode]) -> dict[str, Value]:
    """Compute the quantities by which Vo Van, Balmes and Lorang (2015) describe groups of span modes.

    Args:
        modes: Identified modes.

    Returns:
        Values by name of quantity. Lists start with group 1. Quantities that need more modes are left out.
    """
    vertical = [mode for mode in modes if not mode.lateral]
    certain = [mode for mode in vertical if mode.certain]
    counts: list[float] = []
    frequency, damping = [], []
    while members := [mode for mode in certain if mode.group == len(counts) + 1]:
        counts.append(float(sum(mode.group == members[0].group for mode in vertical)))
        frequency.append(float(np.median([mode.frequency_Hz for mode in members])))
        damping.append(float(np.median([mode.damping_ratio for mode in members])))
    findings: dict[str, Value] = {
        "modes_in_group": tuple(counts),
        "mode_frequency_Hz": tuple(frequency),
        "damping_ratio": tuple(damping),
    }
    if certain:
        findings["largest_damping_ratio"] = max(mode.damping_ratio for mode in certain)
    if len(damping) >= 3:
        steps = [100 * (1 - damping[1] / damping[0]), 100 * (1 - damping[2] / damping[1])]
        findings["damping_decrease_pct"], findings["largest_damping_decrease_pct"] = min(steps), max(steps)
        later = [z for f, z in zip(frequency[3:], damping[3:], strict=True) if f <= HIGHEST_HZ]
        if later:
            findings["damping_rise_pct"] = 100 * (max(later) / damping[2] - 1)
            findings["damping_variation_pct"] = 100 * max(abs(z / damping[2] - 1) for z in later)
    return findings


def compute_population_findings(population: PopulationFile) -> dict[str, Value]:
    """Quantities by which Vo Van, Balmes and Lorang (2015) describe all tests, each identified on its own.

    Args:
        population: Population of tests.

    Returns:
        Values by name of quantity, without those that need more tests or an outlier.
    """
    variability = population.variability
    findings: dict[str, Value] = {}
    if variability.rank_correlation is not None:
        findings["damping_dispersion_correlation"] = variability.rank_correlation
    if variability.outliers_above_share is not None:
        findings["outliers_above_pct"] = 100 * variability.outliers_above_share
    return findings


def compare_reference(modes: Sequence[Mode], frequency: RealArray, ratio: RealArray) -> tuple[float, ...]:
    """Damping ratio of a reference model over the identified one, median of each group of span modes.

    Args:
        modes: Identified modes; only vertical modes with a certain damping ratio count.
        frequency, ratio: Frequencies [Hz], ascending, and damping ratios [-] of the reference model, (n,).

    Returns:
        Ratios from group 1 to the last group before one without modes [-].
    """
    certain = [mode for mode in modes if mode.certain and not mode.lateral]
    medians: list[float] = []
    while members := [mode for mode in certain if mode.group == len(medians) + 1]:
        reference = np.interp([mode.frequency_Hz for mode in members], frequency, ratio)
        medians.append(float(np.median(reference / [mode.damping_ratio for mode in members])))
    return tuple(medians)
