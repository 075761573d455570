"""Passages of one track beside each other: worst places, and runs that are not where they say.

Passages with the same pantograph, direction and class of speed are averaged by position. Their forces are in files, so
that the memory does not grow with the number of runs.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Series
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.network.run_placement import find_offsets, measure_agreement
from pantocheck.conformance.network.section_grading import GradedPassage
from pantocheck.conformance.network.span_comparison import (
    GRID_M,
    Deviation,
    find_deviations,
    find_spans,
    scale_difference,
    subtract_neighbours,
)
from pantocheck.conformance.network.track_places import find_known_place, list_support_kilometres
from pantocheck.conformance.network.unusual_values import FEWEST_PASSAGES
from pantocheck.conformance.results.network_format import ForcePlace, KnownPlace, MisplacedRun, SectionPassage

SPEED_CLASS_KM_H = 10.0
"""Width of a class of speeds [km/h]."""

SAME_PLACE_KM = 0.08
"""Largest distance of two deviations that belong to one place [km]: a span and a half."""

TRACE_M, TRACE_POINTS = 80.0, 300
"""Track on either side of a place whose force is kept [m], and largest number of its points."""


@dataclass(frozen=True)
class ForceProfile:
    """Force of one pantograph in one run on the grid of the track, in the order of kilometres."""

    passage: SectionPassage
    """First of its passages."""
    first: int
    """First sample; the sample 0 is at 0 km."""
    size: int
    speed: float
    """Mean speed [km/h]."""
    force_file: Path
    """Filtered force [N], NaN where it is not known."""
    rest_file: Path
    """Difference from the neighbouring spans, in robust standard deviations."""

    @property
    def kind(self) -> tuple[str, str, float]:
        """Pantograph, direction and class of speed of passages that are averaged."""
        return self.passage.pantograph, self.passage.direction, self.speed // SPEED_CLASS_KM_H

    def read(self, path: Path, first: int, size: int) -> RealArray:
        """Values of a file on another part of the grid, NaN outside.

        Args:
            path: File of this profile.
            first, size: First sample and number of samples.
        """
        found = np.full(size, np.nan)
        low, high = max(first, self.first), min(first + size, self.first + self.size)
        if low < high:
            stored = np.load(path, mmap_mode="r")
            found[low - first : high - first] = stored[low - self.first : high - self.first]
        return found


def write_profiles(graded: Sequence[GradedPassage], places: Sequence[KnownPlace], folder: Path) -> list[ForceProfile]:
    """Write the forces of the pantographs of one run, with their differences from the neighbouring spans.

    Args:
        graded: Passages of the run over the sections of a track.
        places: Known places; supports are the ends of the spans.
        folder: Folder for the files.
    """
    parts = defaultdict[str, list[GradedPassage]](list)
    for item in graded:
        if item.km.size > 1:
            parts[item.passage.pantograph].append(item)
    return [
        _write_profile(items, places, folder / f"{i}-{items[0].passage.run}") for i, items in enumerate(parts.values())
    ]


def _write_profile(items: Sequence[GradedPassage], places: Sequence[KnownPlace], path: Path) -> ForceProfile:
    step = GRID_M / 1000
    first = int(np.floor(min(item.km.min() for item in items) / step))
    size = int(np.ceil(max(item.km.max() for item in items) / step)) + 1 - first
    force = np.full(size, np.nan)
    for item in items:
        order = slice(None) if item.km[-1] > item.km[0] else slice(None, None, -1)
        km, values = item.km[order], item.force[order]
        edge = float(np.median(np.diff(km)))  # a sample of the grid between two sections belongs to both
        low, high = int(np.ceil((km[0] - edge) / step)), int(np.floor((km[-1] + edge) / step)) + 1
        low, high = max(low, first), min(high, first + size)
        force[low - first : high - first] = np.interp(step * np.arange(low, high), km, values)
    section = items[0].passage.section
    supports = 1000 * (list_support_kilometres(places, section.line, section.track) - first * step)
    rest = scale_difference(subtract_neighbours(force, find_spans(force, supports)), force)
    speeds = [item.passage.speed_km_h for item in items if item.passage.speed_km_h is not None]
    files = path.with_suffix(".force.npy"), path.with_suffix(".rest.npy")
    for file, values in zip(files, (force, rest), strict=True):
        np.save(file, values.astype(np.float32))
    return ForceProfile(items[0].passage, first, size, float(np.mean(speeds)), *files)


@dataclass(frozen=True)
class _Found:
    km: float
    deviation: Deviation
    profile: ForceProfile
    alone: bool
    """Whether the passage shows the deviation by itself."""

    @property
    def excess(self) -> float:
        return abs(self.deviation.deviation) / self.deviation.threshold


def compare_passages(
    profiles: Sequence[ForceProfile], known: Sequence[KnownPlace]
) -> tuple[list[ForcePlace], list[MisplacedRun]]:
    """Worst places and misplaced runs of one track.

    Args:
        profiles: Forces of the passages.
        known: Known places.
    """
    found: list[_Found] = []
    misplaced: list[MisplacedRun] = []
    alike = defaultdict[tuple[str, str, float], list[ForceProfile]](list)
    for profile in profiles:
        alike[profile.kind].append(profile)
    for part in alike.values():
        first = min(profile.first for profile in part)
        size = max(profile.first + profile.size for profile in part) - first
        wrong = list(_find_misplaced(part, first, size)) if len(part) >= FEWEST_PASSAGES else []
        misplaced += wrong
        names = {run.run for run in wrong}
        placed = [profile for profile in part if profile.passage.run not in names]
        found += _find_places(placed, first, size)
    return list(_join_places(found, profiles, known)), misplaced


def _add(profiles: Sequence[ForceProfile], first: int, size: int) -> tuple[RealArray, RealArray]:
    """Sum and number of the known differences."""
    total, count = np.zeros(size), np.zeros(size)
    for profile in profiles:
        rest = profile.read(profile.rest_file, first, size)
        total += np.nan_to_num(rest)
        count += np.isfinite(rest)
    return total, count


def _average(total: RealArray, count: RealArray) -> RealArray:
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _find_misplaced(profiles: Sequence[ForceProfile], first: int, size: int) -> Iterator[MisplacedRun]:
    total, count = _add(profiles, first, size)

    def read_pair(profile: ForceProfile) -> tuple[RealArray, RealArray]:
        """Difference of a passage, and the mean of the others."""
        own = profile.read(profile.rest_file, first, size)
        return own, _average(total - np.nan_to_num(own), count - np.isfinite(own))

    usual = float(np.median([measure_agreement(*read_pair(profile)) for profile in profiles]))
    for profile in profiles:
        for part in find_offsets(*read_pair(profile), usual):
            ends = ((first + number) * GRID_M / 1000 for number in (part.first, part.last))
            low, high = (round(min(max(end, profile.first * GRID_M / 1000), _end(profile)), 4) for end in ends)
            metres = part.offset_m
            yield MisplacedRun(
                line=profile.passage.section.line,
                track=profile.passage.section.track,
                run=profile.passage.run,
                pantograph=profile.passage.pantograph,
                from_km=low,
                to_km=high,
                offset_m=metres,
                offset_s=None if metres is None else round(3.6 * abs(metres) / profile.speed, 3),
                agreement=round(part.agreement, 3),
            )


def _end(profile: ForceProfile) -> float:
    return (profile.first + profile.size) * GRID_M / 1000


def _find_places(profiles: Sequence[ForceProfile], first: int, size: int) -> Iterator[_Found]:
    """Places that a passage shows, or the mean of all; the passage with the largest difference stands for the mean."""
    for profile in profiles:
        for item in find_deviations(profile.read(profile.rest_file, profile.first, profile.size)):
            yield _Found((profile.first + item.index) * GRID_M / 1000, item, profile, alone=True)
    if len(profiles) > 1:
        for item in find_deviations(_average(*_add(profiles, first, size))):
            index = first + item.index
            values = [float(profile.read(profile.rest_file, index, 1)[0]) for profile in profiles]
            sizes = np.nan_to_num(np.abs(values), nan=-1.0)
            yield _Found(index * GRID_M / 1000, item, profiles[int(np.argmax(sizes))], alone=False)


def _join_places(
    found: Sequence[_Found], profiles: Sequence[ForceProfile], known: Sequence[KnownPlace]
) -> Iterator[ForcePlace]:
    """Places with the deviations that lie close to each other, in the order of kilometres."""
    clusters: list[list[_Found]] = []
    for item in sorted(found, key=lambda item: (item.km, item.profile.passage.run, item.profile.passage.pantograph)):
        if clusters and item.km - clusters[-1][-1].km <= SAME_PLACE_KM:
            clusters[-1].append(item)
        else:
            clusters.append([item])
    for cluster in clusters:
        worst = max(cluster, key=lambda item: item.excess)
        passage, km = worst.profile.passage, round(worst.km, 4)
        here = round(1000 * km / GRID_M)
        reach = round(TRACE_M / GRID_M)
        trace = worst.profile.read(worst.profile.force_file, here - reach, 2 * reach + 1)
        name, explained = find_known_place(known, passage.section.line, passage.section.track, km)
        yield ForcePlace(
            line=passage.section.line,
            track=passage.section.track,
            km=km,
            run=passage.run,
            date=passage.date,
            direction=passage.direction,
            pantograph=passage.pantograph,
            force_N=round(float(trace[reach]), 2),
            deviation=round(worst.deviation.deviation, 2),
            threshold=round(worst.deviation.threshold, 2),
            extent_m=worst.deviation.extent_m,
            found=len({(x.profile.passage.run, x.profile.passage.pantograph) for x in cluster if x.alone}),
            passages=sum(profile.first <= here < profile.first + profile.size for profile in profiles),
            place=name,
            explained=explained,
            trace=_draw_trace(trace, here - reach),
        )


def _draw_trace(values: RealArray, first: int) -> Series:
    step = -(-values.size // TRACE_POINTS)
    km: RealArray = GRID_M / 1000 * (first + np.arange(values.size, dtype=np.float64))
    known = np.flatnonzero(np.isfinite(values))[::step]
    return Series(label="filtered force", style="line", x=round_digits(km[known], 8), y=round_digits(values[known], 6))
