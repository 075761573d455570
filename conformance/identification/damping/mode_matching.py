"""Identified modes of a record, matched with the computed modes of a line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.identification.damping.damping_format import Matching
from pantocheck.conformance.identification.damping.damping_model import MeasuredModes
from pantocheck.conformance.identification.damping.mode_pairing import (
    ModePair,
    compute_sensor_shapes,
    find_overlapping_modes,
    find_sensor_positions,
    pair_modes,
)
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.overlapping_bands import half_power_bandwidth
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.model import Catenary, DiscretisedLine, discretise
from pantocheck.model.modal.modes import Modes, compute_modes_below
from pantocheck.model.one_thread import use_one_thread

HIGHEST_OVER_USABLE = 1.1
"""Highest frequency of the computed modes over that of the usable modes: room for a line that is too stiff."""

MIN_PAIRS = 6
"""Smallest number of identified modes with a computed counterpart for a fit."""


@dataclass(frozen=True)
class MatchedModes:
    """Usable identified modes, the computed modes of the line, and their pairs."""

    usable: list[Mode]
    """Usable identified modes."""
    mesh: DiscretisedLine
    """The line, with a station at each sensor."""
    shapes: Modes
    """Computed modes of the line."""
    pairs: tuple[ModePair, ...]
    """Pairs, in the order of the usable modes."""
    matching: Matching
    """Numbers of modes and pairs, and the agreement of their shapes."""

    @property
    def paired(self) -> list[Mode]:
        """Identified modes with a computed counterpart, in the order of the pairs."""
        return [self.usable[pair.measured] for pair in self.pairs]

    @property
    def unpaired(self) -> list[Mode]:
        """Identified modes without a computed counterpart."""
        paired = {pair.measured for pair in self.pairs}
        return [mode for i, mode in enumerate(self.usable) if i not in paired]

    @property
    def overlapping(self) -> NDArray[np.bool_]:
        """Mask of the pairs whose half-power band overlaps that of another mode, (p,)."""
        frequency = np.array([mode.frequency_Hz for mode in self.usable])
        bandwidth = np.array([half_power_bandwidth(mode) for mode in self.usable])
        return find_overlapping_modes(frequency, bandwidth, self.shapes.frequency, self.pairs)

    @property
    def measured(self) -> MeasuredModes:
        """Frequencies, damping ratios and groups of the paired modes."""
        return MeasuredModes(
            np.array([mode.frequency_Hz for mode in self.paired]),
            np.array([mode.damping_ratio for mode in self.paired]),
            np.array([mode.damping_ratio_std for mode in self.paired]),
            np.array([mode.group or 0 for mode in self.paired], dtype=np.int64),
        )


def select_usable(modes: Sequence[Mode], source: str) -> list[Mode]:
    """Select the modes for a fit: certain, vertical and in a group.

    Args:
        modes: Identified modes.
        source: Name of their file, for messages.

    Returns:
        Usable modes.

    Raises:
        InputError: None of the modes is usable.
    """
    usable = [mode.rounded() for mode in modes if mode.certain and not mode.lateral and mode.group is not None]
    if not usable:
        raise InputError(source, "holds no certain vertical mode in a group", "Identify longer or more records.")
    return usable


@use_one_thread
def match_modes(usable: list[Mode], line: Catenary, element: float, source: str) -> MatchedModes:
    """Compute the modes of a line and pair them with identified modes.

    Args:
        usable: Usable identified modes.
        line: Line of the fit.
        element: Element length [m].
        source: Name of the file of the modes, for messages.

    Raises:
        InputError: A sensor is not on the line, or too few modes have a computed counterpart.
    """
    positions = find_sensor_positions(usable, line, source)
    mesh = discretise(line, element, tuple(sorted(x for _, x in positions)))
    frequency = np.array([mode.frequency_Hz for mode in usable])
    shapes = compute_modes_below(mesh, HIGHEST_OVER_USABLE * float(frequency.max()))
    measured_shapes, computed_shapes = compute_sensor_shapes(usable, mesh, shapes, positions)
    pairs = pair_modes(frequency, measured_shapes, shapes.frequency, computed_shapes)
    if len(pairs) < MIN_PAIRS:
        raise InputError(
            source,
            f"only {len(pairs)} of {len(usable)} modes have a computed counterpart, {MIN_PAIRS} are needed",
            "Name the line of the record with --line; spans and tensions determine the frequencies.",
        )
    # At a single sensor, all shapes agree.
    mac = [pair.mac for pair in pairs if measured_shapes[pair.measured].size > 1]
    matching = Matching(
        modes=len(usable),
        matched=len(pairs),
        matched_share=len(pairs) / len(usable),
        median_mac=float(np.median(mac)) if mac else None,
        lowest_mac=min(mac, default=None),
    )
    return MatchedModes(usable, mesh, shapes, pairs, matching)
