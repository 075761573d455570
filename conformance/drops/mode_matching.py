"""Identified modes of a record, matched with the computed modes of a line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_model import MeasuredModes
from pantocheck.conformance.drops.mode_groups import half_power_bandwidth, overlaps
from pantocheck.conformance.results.damping_format import Matching
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary, DiscretisedLine, Kind, discretise
from pantocheck.model.description.catenary import Wire
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.modal.modes import Modes, compute_modes_below, deflection_at

# Pairs of measured and computed modes, by frequency and by shape at the sensors.
LARGEST_FREQUENCY_GAP = 0.05
"""Largest relative difference between the frequencies of a pair [-]."""

MIN_MAC = 0.5
"""Smallest modal assurance criterion of a pair [-]."""

KIND_OF_WIRE = {"CW": Kind.CONTACT_WIRE, "MW": Kind.MESSENGER_WIRE, "SW": Kind.STITCH_WIRE}
"""Kinds of wire by their names in mass-drop records."""

Positions = dict[tuple[str, float], str]
"""Wire of the line under a sensor, by wire in the record and position of the sensor along the line [m]."""


@dataclass(frozen=True)
class ModePair:
    """Indices of a measured mode and of its computed counterpart, and the MAC of their shapes."""

    measured: int
    computed: int
    mac: float


def modal_assurance(measured: ComplexArray, computed: RealArray) -> RealArray:
    """Modal assurance criterion of a shape, (s,), and others, (n, s), at the same sensors; 1 for a multiple of it."""
    norm = np.sum(np.abs(measured) ** 2) * np.sum(computed**2, axis=1)
    return np.abs(computed @ measured.conj()) ** 2 / np.where(norm > 0, norm, 1.0)


def pair_modes(
    measured_frequency: RealArray,
    measured_shapes: list[ComplexArray],
    computed_frequency: RealArray,
    computed_shapes: list[RealArray],
) -> tuple[ModePair, ...]:
    """Pair measured and computed modes so that the sum of their distances is smallest.

    The main error of a line model is a common factor on its frequencies; this factor is removed first.

    Args:
        measured_frequency: Frequencies of the measured modes, (m,) [Hz].
        measured_shapes: Shape of each measured mode at its sensors, each (s,).
        computed_frequency: Frequencies of the computed modes, (n,) [Hz].
        computed_shapes: Computed shapes at the sensors of each measured mode, each (n, s).

    Returns:
        Pairs, in the order of the measured modes.
    """
    if measured_frequency.size == 0 or computed_frequency.size == 0:
        return ()
    similarity = np.array(list(map(modal_assurance, measured_shapes, computed_shapes)))
    single = np.array([shape.size < 2 for shape in measured_shapes])
    similarity[single] = 1.0
    factor = _common_factor(measured_frequency, computed_frequency, similarity)
    distance = np.abs(np.log(measured_frequency[:, None] / (factor * computed_frequency[None, :])))
    cost = np.where(distance < LARGEST_FREQUENCY_GAP, (distance / 0.01) ** 2 + 4 * (1 - similarity), 1e6)
    rows, columns = scipy.optimize.linear_sum_assignment(cost)
    return tuple(
        ModePair(int(i), int(j), float(similarity[i, j]))
        for i, j in zip(rows, columns, strict=True)
        if cost[i, j] < 1e6 and similarity[i, j] >= MIN_MAC
    )


def _common_factor(measured: RealArray, computed: RealArray, similarity: RealArray) -> float:
    """Factor on the computed frequencies with the best agreement with the measured ones."""
    trials = np.linspace(1 - LARGEST_FREQUENCY_GAP, 1 + LARGEST_FREQUENCY_GAP, 201)

    logarithm = np.log(measured[:, None] / computed)

    def misfit(factor: float) -> float:
        distance = (logarithm - np.log(factor)) / 0.01
        return float(np.sum(np.minimum((distance**2 + 4 * (1 - similarity)).min(axis=1), 4.0)))

    return float(min(trials, key=misfit))


def find_overlapping_modes(
    measured: RealArray, bandwidth: RealArray, computed: RealArray, pairs: Sequence[ModePair]
) -> NDArray[np.bool_]:
    """Mark the pairs whose half-power band overlaps that of another mode, (p,).

    Computed modes that overlap cannot be told apart by a few sensors: the measured mode can be a mixture of them, whose
    damping ratio belongs to none. Measured modes that overlap share their decay.

    Args:
        measured: Frequencies of the measured modes, (m,) [Hz].
        bandwidth: Half-power bandwidths of the measured modes, (m,) [Hz].
        computed: Frequencies of the computed modes, (n,) [Hz].
        pairs: The p pairs.

    Returns:
        True, (p,): another measured or computed mode lies within `OVERLAP` bandwidths.
    """
    return np.array(
        [
            overlaps(measured, pair.measured, width) or overlaps(computed, pair.computed, width)
            for pair, width in ((pair, float(bandwidth[pair.measured])) for pair in pairs)
        ],
        dtype=np.bool_,
    )


def find_sensor_positions(modes: Sequence[Mode], line: Catenary, source: str) -> Positions:
    """Find the wires of the line under the sensors; `source` is the name of the file of the modes in messages.

    Raises:
        InputError: The line has no wire of this kind at the position of a sensor.
    """
    positions = {}
    for name, x in {(sensor.wire, sensor.position_m) for mode in modes for sensor in mode.sensor_shape}:
        if x is None or name not in KIND_OF_WIRE:
            continue
        kind = KIND_OF_WIRE[name]
        wire = find_wire(line, kind, x)
        if wire is None:
            raise InputError(
                source,
                f"a sensor is at {x:g} m, where the line has no {kind.replace('_', ' ')}",
                "Name the line of the record with --line.",
            )
        positions[name, x] = wire.name
    return positions


def compute_sensor_shapes(
    modes: Sequence[Mode], mesh: DiscretisedLine, shapes: Modes, positions: Positions
) -> tuple[list[ComplexArray], list[RealArray]]:
    """Compute the shapes at the sensors of each identified mode.

    Args:
        modes: Identified modes.
        mesh: The line, with a station at each sensor.
        shapes: The n computed modes of the line.
        positions: Result of `find_sensor_positions`.

    Returns:
        measured: Shape of each identified mode at its s sensors, each (s,).
        computed: Shapes of the computed modes at the same sensors, each (n, s).
    """
    deflections = {
        (name, x): deflection_at(mesh, shapes, mesh.mesh.row_of[wire, "z"], x) for (name, x), wire in positions.items()
    }
    measured, computed = [], []
    for mode in modes:
        sensors = [s for s in mode.sensor_shape if (s.wire, s.position_m) in deflections]
        measured.append(np.array([complex(s.re, s.im) for s in sensors]))
        columns = [deflections[s.wire, s.position_m] for s in sensors if s.position_m is not None]
        computed.append(np.array(columns).T if columns else np.zeros((shapes.frequency.size, 0)))
    return measured, computed


def find_wire(line: Catenary, kind: Kind, position: float) -> Wire | None:
    """First wire of a kind at a position along the line [m]; None if there is none."""
    reaching = (wire for wire in line.wires if wire.kind is kind and wire.start <= position <= wire.end)
    return next(reaching, None)


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

    Raises:
        InputError: None of the modes is usable.
    """
    usable = [mode.rounded() for mode in modes if mode.certain and not mode.lateral and mode.group is not None]
    if not usable:
        raise InputError(source, "holds no certain vertical mode in a group", "Identify longer or more records.")
    return usable


@use_one_thread
def match_modes(usable: list[Mode], line: Catenary, element: float, source: str) -> MatchedModes:
    """Pair identified modes with those of a line in elements of a length [m]; `source` as in `find_sensor_positions`.

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
