"""Damping of a line: identified from simulated drops, or computed from a damping model.

Both are compared as in Vo Van, Balmes and Lorang (2015).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.identify import Identification, identify_modes
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.population import Population, PopulationTest
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.figure_data import Series
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.case_run import build_run_table
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.drop_simulation import SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.model import Catenary, DiscretisedLine
from pantocheck.model.discretised_line import with_damping
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
    """Run facts of a number of simulated drops that began at `begin` of `time.perf_counter` [s] and end now."""
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
    """Damping ratios of the undamped modes of a line; inside a modal band, its ratio replaces Rayleigh damping.

    Args:
        mesh: Line in finite elements with any damping.
        shapes: Undamped modes of this line.
        line: The same line with the damping model.

    Returns:
        Damping ratio of every mode, (n,) [-].
    """
    rayleigh = damping_ratios(with_damping(mesh, line.damping), shapes)
    return apply_modal_bands(rayleigh, shapes.frequency, line.modal_damping)
