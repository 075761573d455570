"""Modes identified from the simulated drops of a case, as in Vo Van, Balmes and Lorang (2015)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.identify import Identification, identify_modes
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.results.results_format import Series
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.simulation.drop_simulation import SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.model import Catenary


@dataclass(frozen=True)
class IdentifiedDrops:
    """Simulated drops of a case and the modes identified from their records."""

    drops: tuple[SimulatedDrop, ...]
    identification: Identification

    @property
    def certain_modes(self) -> list[Mode]:
        """Vertical modes whose damping is determined with certainty."""
        return [mode for mode in self.identification.modes if mode.certain and not mode.lateral]


def identify_drops(case: Case, line: Catenary | None = None) -> IdentifiedDrops:
    """Simulate all drops of a case and identify the modes; `line` replaces the line of the case."""
    mass_drop = require_mass_drop(case)
    drops = tuple(simulate_drop(case, number, line=line) for number in range(1, len(mass_drop.drop) + 1))
    (identification,) = identify_modes(tuple(drop.record for drop in drops), mass_drop.highest_Hz)
    return IdentifiedDrops(drops, identification)


def damping_series(label: str, modes: Sequence[Mode]) -> Series:
    """Damping ratio [%] against frequency [Hz] with 95 % intervals."""
    return Series(
        label=label,
        style="points",
        x=thin_series(np.array([mode.frequency_Hz for mode in modes])),
        y=thin_series(np.array([100 * mode.damping_ratio for mode in modes])),
        error=thin_series(np.array([196 * mode.damping_ratio_std for mode in modes])),
    )
