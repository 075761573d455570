"""Preparation of a measured record: from samples to signals, with a note on each cut."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import Evaluation, SectionEvaluations, evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import RUN_OUT_M, UPLIFT_STRETCH_M, LineSignals, has_gaps
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals, edge_warnings
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside
from pantocheck.conformance.quantities.unavailable import SectionNotCovered
from pantocheck.conformance.records.clock_join import Clock
from pantocheck.conformance.records.column_values import list_sensor_warnings
from pantocheck.conformance.records.events import RecordEvent, TooManyEvents, list_events
from pantocheck.conformance.records.force_checks import detect_filtered, find_outliers
from pantocheck.conformance.records.record import MAX_SAMPLES, RecordInvalid, check_strip_forces
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, analysis_section
from pantocheck.conformance.records.source_alignment import (
    GAP_STEPS,
    Alignment,
    align_source,
    extend_train,
    join_uplift,
    list_drift_warnings,
    list_short_ends,
)
from pantocheck.conformance.records.uplift_sensor import refuse_faulty_uplift
from pantocheck.conformance.records.usable_sections import (
    SHORTEST_S,
    PlacedSamples,
    UsableSection,
    find_usable_sections,
    format_share,
    local_speed,
    place_samples,
    resample_section,
)

MOST_NAMES = 20
"""Largest number of names in a note."""


@dataclass(frozen=True)
class PreparedRecord(SectionEvaluations):
    """Signals of a measured record."""

    pantographs: dict[int, PantographSignals]
    """Signals by number from 1."""
    line: LineSignals
    """Uplift at the supports."""
    rate: float
    """Sampling rate after resampling [Hz]."""
    speed: float
    """Mean speed of the samples at nominal speed, or the nominal speed if there are none [m/s]."""
    section: tuple[float, float]
    """Start and end of the analysis section [m]."""
    seconds: float
    """Evaluated duration of the first pantograph [s]; 0 if it does not cover the analysis section."""
    notes: tuple[str, ...]
    """Remarks on the preparation."""
    warnings: tuple[str, ...]
    """Caveats for the reader of the report."""
    events: tuple[RecordEvent, ...] = ()
    """Events of the analysis section."""
    excluded: tuple[tuple[float, float], ...] = ()
    """Stretches that are left out of the statistics of the pantographs [m, m]."""
    alignments: tuple[Alignment, ...] = ()
    """Clocks of the sources that have times of their own."""
    shifted_lines: tuple[LineSignals, ...] = ()
    """Uplift with all clocks of sources at either end of their intervals."""
    place_clocks: tuple[tuple[str, str, Clock], ...] = ()
    """Name, kind of the join and clock of the sources of speed and position."""
    place_uncertainty: float = 0.0
    """Half-width of the 95 % interval of the place of all samples, by the clock of a source [m]."""

    @cached_property
    def evaluation(self) -> Evaluation:
        """Quantities over the analysis section."""
        return evaluate_signals(self.evaluated_pantographs, self.line)

    @property
    def evaluated_pantographs(self) -> Mapping[int, PantographSignals | SignalsOutside]:
        """Signals without the excluded stretches."""
        if not self.excluded:
            return self.pantographs
        return {number: SignalsOutside(signals, self.excluded) for number, signals in self.pantographs.items()}

    def evaluate_channels(self, pantographs: Mapping[int, PantographSignals], line: LineSignals) -> Evaluation:
        """Evaluate the quantities of other channels over the analysis section."""
        return replace(self, pantographs=dict(pantographs), line=line).evaluation

    def with_supports(self, supports: tuple[float, ...] | None) -> "PreparedRecord":
        """Same record with the positions of all supports of the line [m]; None: they are not known."""
        line, *shifted = (replace(line, line_supports=supports) for line in (self.line, *self.shifted_lines))
        return replace(self, line=line, shifted_lines=tuple(shifted))


@dataclass(frozen=True)
class _Settings:
    """Sampling rate [Hz], analysis section [m], filters, and mask of the samples at nominal speed."""

    rate: float
    section: tuple[float, float]
    low_pass: Filter
    filter_applied_Hz: float | None
    steady: NDArray[np.bool_]


def prepare_record(
    samples: RecordSamples, sidecar: RecordSidecar, low_pass: Filter, speed_tolerance_pct: float
) -> PreparedRecord:
    """Select the usable part of a record, evenly sampled in time.

    Args:
        samples: Samples as read.
        sidecar: Sidecar of the record.
        low_pass: Filter of the graded force.
        speed_tolerance_pct: Largest difference from the nominal speed in the analysis section [%].

    Returns:
        Signals over the usable sections.

    Raises:
        RecordInvalid: Time or position decreases, no sample has both, the pantographs share no track, no part is
            usable, or the forces of strips contradict the contact force.
    """
    check_strip_forces(samples.force, samples.front_strip, samples.rear_strip)
    placed = place_samples(samples, sidecar)
    samples, time, position = placed.samples, placed.time, placed.position
    rate = float(f"{1 / float(np.median(np.diff(time))):.6g}")
    if (time[-1] - time[0]) * rate > MAX_SAMPLES:
        found = f"{time[-1] - time[0]:.4g} s at {rate:.4g} Hz give more than the accepted {MAX_SAMPLES} samples"
        raise RecordInvalid("time", found)
    nominal = sidecar.speed_km_h / 3.6
    speed = local_speed(time, position[0])
    recorded = [speed] if samples.speed is None else [speed, samples.speed]
    steady = np.all([np.abs(values / nominal - 1) <= speed_tolerance_pct / 100 for values in recorded], axis=0)
    warnings = [*placed.warnings, *list_sensor_warnings(sidecar.columns, samples.left_out_sensors)]
    if not steady.all():
        warnings.append(
            f"{format_share(~steady)} of the record was cut, first at {position[0][np.argmin(steady)]:.1f} m: "
            f"the speed differs by more than {speed_tolerance_pct:g} % from {sidecar.speed_km_h:g} km/h"
        )
    section = analysis_section(sidecar, position)
    if not section[0] < section[1]:
        raise RecordInvalid("position", "no part of the track is common to all pantographs")
    settings = _Settings(rate, section, low_pass, sidecar.low_passed_Hz, steady)
    pantographs = {}
    for row in range(samples.force.shape[0]):
        pantographs[row + 1], remarks = _prepare_pantograph(placed, row, settings)
        warnings += remarks
    # The run of a case ends where the case says, often one span behind its section.
    run_out = UPLIFT_STRETCH_M if sidecar.case is None else RUN_OUT_M
    line, remarks = _prepare_line(placed, section, run_out)
    train = extend_train(time, position, nominal)
    alignments = tuple(align_source(source, train) for source in samples.sources.uplift)
    lines = [join_uplift(line, alignments, train, side) for side in (0, -1, 1)]
    warnings += [part.describe() for part in alignments if part.state != "confirmed"]
    warnings += list_short_ends(alignments, train, section)
    warnings += list_drift_warnings(samples.sources, alignments)
    mean_speed = float(recorded[-1][steady].mean())
    # A section that nobody stated is the whole track: every record ends at its limits.
    edges = [] if sidecar.evaluated_m is None else edge_warnings(pantographs, mean_speed)
    seconds = _duration(pantographs[1])
    length = f"Evaluated: {seconds:.4g} s, about {seconds * nominal / 1000:.3g} km of line."
    return PreparedRecord(
        pantographs=pantographs,
        line=lines[0],
        rate=rate,
        speed=mean_speed,
        section=section,
        seconds=seconds,
        notes=(*_resampling_notes(placed, rate), *_ignored_notes(samples), *([length] if seconds else [])),
        warnings=(*warnings, *edges, *remarks),
        events=_list_section_events(sidecar, position[0], samples.event_level, section),
        alignments=alignments,
        shifted_lines=tuple(lines[1:]) if alignments else (),
        place_clocks=samples.sources.clocks,
        place_uncertainty=nominal * samples.sources.place_uncertainty_s,
    )


def _list_section_events(
    sidecar: RecordSidecar, position: RealArray, levels: RealArray | None, section: tuple[float, float]
) -> tuple[RecordEvent, ...]:
    """Events that touch the analysis section."""
    try:
        events = list_events(sidecar, position, levels)
    except TooManyEvents as error:
        raise RecordInvalid("event_channel", str(error)) from None
    return tuple(event for event in events if event.start <= section[1] and event.end >= section[0])


def _prepare_pantograph(placed: PlacedSamples, row: int, settings: _Settings) -> tuple[PantographSignals, list[str]]:
    """Signals of one pantograph over the usable part of its record, and warnings."""
    name, force, position = f"pantograph {row + 1}", placed.samples.force[row], placed.position[row]
    present = np.isfinite(force)
    warnings = []
    if not present.all():
        warnings.append(
            f"{format_share(~present)} of the force of {name} is missing, first at {position[~present][0]:.1f} m"
        )
    warnings += _outlier_warnings(force[present], position[present], name)
    parts = find_usable_sections(placed.time, present & settings.steady)
    if not parts:
        raise RecordInvalid("force", f"{name} has no section of {SHORTEST_S:g} s without gaps at the nominal speed")
    indices = max(parts, key=lambda part: _overlap(position[part], settings.section))
    if len(parts) > 1:
        warnings.append(
            f"the record of {name} has {len(parts)} usable parts between gaps; that from {position[indices[0]]:.1f} m "
            f"to {position[indices[-1]]:.1f} m is evaluated"
        )
    height, front = (
        None if values is None else values[row][indices]
        for values in (placed.samples.contact_height, placed.samples.front_strip)
    )
    arcs = _select_arcs(placed.samples, row, indices)
    channels = UsableSection(position[indices], force[indices], height, front, arcs)
    part = resample_section(placed.time[indices], channels, settings.rate)
    if front is not None and part.front_strip is None:
        warnings.append(f"forces of the strips of {name} are missing inside of the record; they are not shown")
    channel = ForceChannel(part.force, settings.rate, settings.low_pass, settings.filter_applied_Hz)
    signals = PantographSignals(
        part.position, channel, settings.section, part.height, part.arcs, front_strip=part.front_strip
    )
    if _duration(signals):
        signals, remarks = detect_filtered(signals, name)
        warnings += remarks
    return signals, warnings


def _select_arcs(samples: RecordSamples, row: int, indices: NDArray[np.intp]) -> RealArray | None:
    """Arcs and time under load of a pantograph, (2, n); None without an arc detector."""
    if samples.arcing is None or samples.loaded is None or not np.isfinite(samples.arcing[row]).any():
        return None
    return np.vstack([samples.arcing[row][indices], samples.loaded[row][indices]])


def _overlap(position: RealArray, section: tuple[float, float]) -> float:
    """Length of the analysis section that a part of a record covers [m]; negative at a distance from it."""
    return min(float(position[-1]), section[1]) - max(float(position[0]), section[0])


def _duration(signals: PantographSignals) -> float:
    """Evaluated duration [s]; 0 if the analysis section is not covered."""
    try:
        return signals.delivered.size / signals.force.rate
    except SectionNotCovered:
        return 0.0


def _outlier_warnings(force: RealArray, position: RealArray, name: str) -> list[str]:
    outliers = find_outliers(force)
    if not outliers.size:
        return []
    places = ", ".join(f"{force[i]:.4g} N at {position[i]:.1f} m" for i in outliers[:5])
    return [
        f"the force of {name} has {outliers.size} outlier{'s' if outliers.size > 1 else ''}, which are graded: {places}"
        f"{', ...' if outliers.size > 5 else ''}; write nan for a wrong value"
    ]


def _prepare_line(placed: PlacedSamples, section: tuple[float, float], run_out: float) -> tuple[LineSignals, list[str]]:
    """Uplift of the supports where no value that counts is missing, and warnings."""
    supports, uplift = placed.samples.support_position, placed.samples.uplift
    if uplift is None or supports is None:
        return LineSignals(section), []
    missing, last_position = ~np.isfinite(uplift), placed.position.min(axis=0)
    warnings = []
    if missing.any():
        warnings.append(
            f"{format_share(missing)} of the uplift is missing; supports with missing values that count are not "
            "evaluated"
        )
    lost = np.array([_has_lost_samples(place, placed, run_out) for place in supports])
    complete = ~has_gaps(supports, uplift, last_position) & ~lost
    line = LineSignals(section, supports[complete], uplift[complete], last_position=last_position)
    return refuse_faulty_uplift(line, placed.position), warnings


def _has_lost_samples(place: float, placed: PlacedSamples, run_out: float) -> bool:
    """Whether a record has a gap at the passage of a support [m], or ends before a distance behind it [m]."""
    first, last = placed.position.max(axis=0), placed.position.min(axis=0)
    steps = np.diff(placed.time)[(first[1:] >= place - UPLIFT_STRETCH_M) & (last[:-1] <= place + UPLIFT_STRETCH_M)]
    ends = not steps.size or last[-1] < place + run_out
    return bool(ends or steps.max() > GAP_STEPS * np.median(steps))


def _ignored_notes(samples: RecordSamples) -> list[str]:
    """Names of the columns that are not used, cut to a readable length."""
    if not samples.ignored:
        return []
    names = ", ".join(samples.ignored[:MOST_NAMES])
    return [f"Columns of the file that are not used: {names}{', ...' if len(samples.ignored) > MOST_NAMES else ''}."]


def _resampling_notes(placed: PlacedSamples, rate: float) -> list[str]:
    if placed.samples.time is None:
        return [f"The record was sampled by distance; it was resampled to {rate:g} samples per second with its speed."]
    if np.abs(np.diff(placed.time) * rate - 1).max() > 0.02:
        return [f"The record was not evenly sampled; it was resampled to {rate:g} samples per second."]
    return []
