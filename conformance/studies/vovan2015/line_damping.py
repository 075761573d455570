"""Damping of a line: identified from simulated drops, or computed from a damping model.

Both are compared as in Vo Van, Balmes and Lorang (2015).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Series
from pantocheck.conformance.drops.drop_simulation import SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.conformance.drops.identify import Identification, identify_modes
from pantocheck.conformance.drops.population import Population, PopulationTest
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.records.traces import thin_series
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.population_format import PopulationFile
from pantocheck.conformance.runs.case_run import build_run_table
from pantocheck.model import Catenary, DiscretisedLine
from pantocheck.model.discretisation.discretised_line import with_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import Modes, damping_ratios


@dataclass(frozen=True)
class IdentifiedDrops:
    """Simulated drops of a case and the modes identified from their records."""

    drops: tuple[SimulatedDrop, ...]
    """Drops in the order of the case."""
    identification: Identification
    """Modes of all drops together."""

    @property
    def certain_modes(self) -> list[Mode]:
        """Vertical modes with a certain damping ratio."""
        return select_certain(self.identification)


def select_certain(identification: Identification) -> list[Mode]:
    """Vertical modes of an identification with a certain damping ratio."""
    return [mode for mode in identification.modes if mode.certain and not mode.lateral]


def identify_drops(case: Case, line: Catenary | None = None) -> IdentifiedDrops:
    """Simulate all drops of a case and identify the modes; `line` replaces the line of the case."""
    mass_drop = require_mass_drop(case)
    drops = tuple(simulate_drop(case, number, line=line) for number in range(1, len(mass_drop.drop) + 1))
    (identification,) = identify_modes(tuple(drop.record for drop in drops), mass_drop.highest_Hz)
    return IdentifiedDrops(drops, identification)


def identify_tests(identified: IdentifiedDrops, highest: float) -> Population:
    """Identify the record of every drop on its own, up to a frequency [Hz], as a population of tests."""
    tests = []
    for drop in identified.drops:
        (single,) = identify_modes((drop.record,), highest)
        tests.append(PopulationTest(drop.record, single, identified.identification))
    return Population(tuple(tests), (identified.identification,), ())


def build_drop_run_table(case: Case, drops: int, begin: float) -> RunTable:
    """Run facts of simulated drops; `begin` is the `time.perf_counter` at their start [s], their end is now."""
    mass_drop = require_mass_drop(case)
    return build_run_table(case.file.discretisation, drops * (mass_drop.hanging_s + mass_drop.record_s), begin)


def draw_damping_ratios(label: str, modes: Sequence[Mode]) -> Series:
    """Draw damping ratios [%] against frequency [Hz] with 95 % intervals."""
    return Series(
        label=label,
        style="points",
        x=thin_series(np.array([mode.frequency_Hz for mode in modes])),
        y=thin_series(np.array([100 * mode.damping_ratio for mode in modes])),
        error=thin_series(np.array([196 * mode.damping_ratio_std for mode in modes])),
    )


def build_lines(case: Case) -> dict[str, Catenary]:
    """Build the line of a case under each damping model that the case compares."""
    return {name: build_catenary(case.with_damping(name, damping).line) for name, damping in case.dampings.items()}


def computed_damping_ratios(mesh: DiscretisedLine, shapes: Modes, line: Catenary) -> RealArray:
    """Damping ratios, (n,) [-], of the undamped shapes of a mesh under the damping of a line with the same geometry.

    Inside a modal band, its ratio replaces Rayleigh damping.
    """
    rayleigh = damping_ratios(with_damping(mesh, line.damping), shapes)
    return apply_modal_bands(rayleigh, shapes.frequency, line.modal_damping)


# Quantities of groups of span modes (Vo Van, Balmes and Lorang 2015), computed from identified modes.
HIGHEST_HZ = 6.0
"""Vo Van, Balmes and Lorang (2015): from the third group to this frequency [Hz], the damping does not vary."""


def compute_group_findings(modes: Sequence[Mode]) -> dict[str, Value]:
    """Compute the quantities by which Vo Van, Balmes and Lorang (2015) describe groups of span modes.

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
