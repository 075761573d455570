"""Assessment of a collection: passages over every section, their verdicts, repeats and worst places."""

import tempfile
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict, judge_parts, worst_verdict
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.network.run_collection import RefusedFile, StoredRun
from pantocheck.conformance.network.run_workers import MapRuns
from pantocheck.conformance.network.section_grading import NETWORK_QUANTITIES, grade_run, list_grid
from pantocheck.conformance.network.track_comparison import (
    SPEED_CLASS_KM_H,
    ForceProfile,
    compare_passages,
    write_profiles,
)
from pantocheck.conformance.network.track_places import list_tension_sections
from pantocheck.conformance.network.unusual_values import GroupedPassages, find_unusual
from pantocheck.conformance.results.network_format import (
    Direction,
    ForcePlace,
    GroupKey,
    KnownPlace,
    MisplacedRun,
    NetworkResults,
    RefusedImport,
    RepeatedValue,
    SectionGroup,
    SectionPassage,
    TrackSection,
    UnusualValue,
)

WORST_PLACES = 100
"""Number of places whose force is kept."""

SCRATCH = ".forces-"
"""Prefix of the name of a temporary folder."""

MISPLACED = "the force is that of another place"
"""Reason of a passage that does not pass because its run is misplaced."""

FEWEST_FOR_DRIFT, FEWEST_DATES = 4, 3
"""Smallest number of passages and of dates for a drift."""

SectionKey = tuple[str, str, float]
"""Line, track and lower kilometre of a section."""

GroupClass = tuple[float | None, Direction | None, str | None]
"""Lower end of the class of speed, direction and pantograph; None: not asked for."""


@dataclass(frozen=True)
class AssessmentTask:
    """Rules and grouping of the assessment of a collection."""

    profile: Profile
    trust: Trust
    by: tuple[GroupKey, ...]
    length_km: float
    """Length of a section where no tension sections are known [km]."""
    known_places: tuple[KnownPlace, ...] = ()
    scratch: Path | None = None
    """Folder for the forces of one track; None: that of temporary files."""


@dataclass(frozen=True)
class AssessedTrack:
    """Sections of one track of a line with the findings along it."""

    runs: int
    passages: int
    """Passages over sections, complete or not."""
    groups: tuple[SectionGroup, ...]
    places: tuple[ForcePlace, ...]
    misplaced: tuple[MisplacedRun, ...]
    unusual: tuple[UnusualValue, ...]
    suspicious: dict[str, tuple[str, ...]]
    """Remarks on the runs."""


RunPassages = list[tuple[StoredRun, list[SectionPassage]]]
"""Runs of a track with their passages."""


def assess_tracks(
    runs: Iterable[StoredRun], task: AssessmentTask, map_runs: MapRuns = map
) -> Iterator[tuple[AssessedTrack, RunPassages]]:
    """Grade the sections of a collection, one track after the other, with the passages of its runs.

    The samples of one run are in memory at a time, in each process.

    Args:
        runs: Runs in the order of line and track.
        task: Rules and grouping.
        map_runs: Function that grades the runs of a track.

    Raises:
        InputError: The files of a run are damaged.
    """
    for (line, track), part in groupby(runs, key=lambda run: (run.facts.line, run.facts.track)):
        here = list(part)
        places = tuple(place for place in task.known_places if (place.line, place.track) == (line, track))
        ends = [(min(x.facts.from_km, x.facts.to_km), max(x.facts.from_km, x.facts.to_km)) for x in here]
        own = list_tension_sections(places, line, track) or list_grid(line, track, ends, task.length_km)
        with tempfile.TemporaryDirectory(prefix=SCRATCH, dir=task.scratch) as scratch:
            grade = partial(_grade_run, sections=own, places=places, task=task, scratch=Path(scratch).absolute())
            graded = list(map_runs(grade, here))
            found, misplaced = compare_passages(
                [profile for _, own_profiles in graded for profile in own_profiles], places
            )
        passages = [_lower_misplaced(items, misplaced) for items, _ in graded]
        rows = _group([passage for items in passages for passage in items], own, task.by)
        result = AssessedTrack(
            runs=len(here),
            passages=sum(map(len, passages)),
            groups=tuple(group for group, _ in rows),
            places=tuple(_keep_worst(found)),
            misplaced=tuple(misplaced),
            unusual=tuple(_compare_sections(rows)),
            suspicious={run.facts.run: run.facts.remarks for run in here if run.facts.remarks},
        )
        yield result, list(zip(here, passages, strict=True))


def _grade_run(
    run: StoredRun, sections: Sequence[TrackSection], places: Sequence[KnownPlace], task: AssessmentTask, scratch: Path
) -> tuple[list[SectionPassage], list[ForceProfile]]:
    """Passages of a run over the sections of its track, and its forces in files of the folder `scratch`."""
    graded = list(grade_run(run, sections, task.profile, task.trust))
    return [item.passage for item in graded], write_profiles(graded, places, scratch)


def combine_tracks(
    tracks: Sequence[AssessedTrack], refused: Sequence[RefusedFile], task: AssessmentTask
) -> NetworkResults:
    """Results of a collection from those of its tracks.

    Args:
        tracks: Tracks in the order of line and track.
        refused: Files that were refused.
        task: Rules and grouping.

    Raises:
        InputError: There is no run.
    """
    if not tracks:
        raise InputError("collection", "has no run", "Import files: pantocheck runs import FILE ... --out DIR.")
    groups = [group for track in tracks for group in track.groups]
    verdict, reason = judge_network(groups, refused)
    lengths = {_key(group.section): group.section.to_km - group.section.from_km for group in groups}
    measured = {_key(group.section) for group in groups if group.passages}
    return NetworkResults(
        suite=build_suite(),
        profile=task.profile.name,
        trust=task.trust,
        by=task.by,
        verdict=verdict,
        reason=reason,
        runs=sum(track.runs for track in tracks),
        passages=sum(track.passages for track in tracks),
        measured_km=round(sum(lengths[key] for key in measured), 6),
        total_km=round(sum(lengths.values()), 6),
        groups=tuple(groups),
        places=tuple(_keep_worst([place for track in tracks for place in track.places])),
        misplaced=tuple(run for track in tracks for run in track.misplaced),
        unusual=tuple(value for track in tracks for value in track.unusual),
        known_places=task.known_places,
        refused=tuple(RefusedImport(file=item.file, reason=item.reason) for item in refused),
        suspicious={run: remarks for track in tracks for run, remarks in track.suspicious.items()},
    )


def _keep_worst(places: Sequence[ForcePlace]) -> list[ForcePlace]:
    """Places with the worst one first; traces of the first hundred."""
    ordered = sorted(places, key=lambda x: (-abs(x.deviation) / x.threshold, x.line, x.track, x.km))
    rest = ordered[WORST_PLACES:]
    return [*ordered[:WORST_PLACES], *(place.model_copy(update={"trace": None}) for place in rest)]


def _lower_misplaced(passages: Sequence[SectionPassage], misplaced: Sequence[MisplacedRun]) -> list[SectionPassage]:
    """Passages of a run, of which none passes where the run is misplaced."""
    return [
        passage.model_copy(
            update={
                "verdict": worst_verdict([passage.verdict, "skip"]),
                "reason": "; ".join(filter(None, (MISPLACED, passage.reason))),
            }
        )
        if any(_lies_in(passage, stretch) for stretch in misplaced)
        else passage
        for passage in passages
    ]


def _lies_in(passage: SectionPassage, stretch: MisplacedRun) -> bool:
    overlaps = passage.section.from_km < stretch.to_km and passage.section.to_km > stretch.from_km
    return overlaps and (passage.run, passage.pantograph) == (stretch.run, stretch.pantograph)


def judge_network(groups: Sequence[SectionGroup], refused: Sequence[object]) -> tuple[Verdict, str]:
    """Verdict of a collection, with its reason: the worst of the sections, `skip` at best with a refused file."""
    verdict = judge_parts(group.verdict for group in groups)
    if refused and verdict != "info":
        verdict = worst_verdict([verdict, "skip"])
    elif refused:
        verdict = "skip"
    counts = {name: sum(group.verdict == name for group in groups) for name in dict.fromkeys(g.verdict for g in groups)}
    parts = [f"{number} of {len(groups)} sections {name}" for name, number in sorted(counts.items())]
    return verdict, "; ".join([*parts, *([f"{len(refused)} files refused"] if refused else [])])


def _compare_sections(rows: GroupedPassages) -> Iterator[UnusualValue]:
    """Unusual values among the sections of the same track, class of speed, direction and pantograph."""
    alike = defaultdict[tuple[object, ...], GroupedPassages](list)
    for group, passages in rows:
        key = (group.section.line, group.section.track, group.speed_km_h, group.direction, group.pantograph)
        alike[key].append((group, passages))
    for part in alike.values():
        yield from find_unusual(part)


def _key(section: TrackSection) -> SectionKey:
    return section.line, section.track, section.from_km


def _group(
    passages: Sequence[SectionPassage], sections: Sequence[TrackSection], by: Sequence[GroupKey]
) -> GroupedPassages:
    """Groups of every section with their passages, in the order of the track; one group if there is no passage."""
    found = defaultdict[SectionKey, list[SectionPassage]](list)
    for passage in passages:
        found[_key(passage.section)].append(passage)
    groups: GroupedPassages = []
    for section in sections:
        classes = defaultdict[GroupClass, list[SectionPassage]](list)
        here = found[_key(section)]
        whole = [passage for passage in here if passage.whole]
        for passage in sorted(whole, key=lambda x: x.speed_km_h is None):
            key = _classify(passage, by)
            # A passage without a speed, such as an incomplete one, counts in every class of speed.
            same = [other for other in classes if other[1:] == key[1:]] if passage.speed_km_h is None else []
            for other in same or [key]:
                classes[other].append(passage)
        for key in sorted(classes, key=str) or [(None, None, None)]:
            groups.append((_build_group(section, key, classes[key], len(here) - len(whole)), classes[key]))
    return groups


def _classify(passage: SectionPassage, by: Sequence[GroupKey]) -> GroupClass:
    """Class of a passage; None where it is not asked for, or the speed is not known."""
    speed = None
    if "speed" in by and passage.speed_km_h is not None:
        speed = SPEED_CLASS_KM_H * (passage.speed_km_h // SPEED_CLASS_KM_H)
    direction = passage.direction if "direction" in by else None
    return speed, direction, passage.pantograph if "pantograph" in by else None


def _build_group(section: TrackSection, key: GroupClass, whole: Sequence[SectionPassage], partial: int) -> SectionGroup:
    speed, direction, pantograph = key
    verdict: Verdict = judge_parts(passage.verdict for passage in whole) if whole else "skip"
    reasons = (x.reason for x in whole if x.verdict == verdict and x.reason)
    dates = [passage.date for passage in whole]
    return SectionGroup(
        section=section,
        speed_km_h=None if speed is None else (speed, speed + SPEED_CLASS_KM_H),
        direction=direction,
        pantograph=pantograph,
        verdict=verdict,
        reason=next(reasons, "") if whole else "no run measured the whole section",
        passages=len(whole),
        partial=partial,
        dates=(min(dates), max(dates)) if dates else (),
        run=next((x.run for x in whole if x.verdict == verdict), None),
        clocks="; ".join(dict.fromkeys(x.clocks for x in whole if x.clocks)),
        values={
            name: _repeat([(x.date.toordinal(), x.values[name]) for x in known])
            for name in NETWORK_QUANTITIES
            if (known := [x for x in whole if name in x.values])
        },
    )


def _repeat(pairs: Sequence[tuple[int, float]]) -> RepeatedValue:
    """Mean, range and drift of one quantity from its days and values."""
    days, values = np.array(pairs, dtype=np.float64).T
    n = values.size
    spread = float(values.std(ddof=1)) if n > 1 else None
    mean_range = None if spread is None else float(stdtrit(n - 1, 0.975)) * spread / n**0.5
    drift, drifts = None, False
    if n >= FEWEST_FOR_DRIFT and np.unique(days).size >= FEWEST_DATES:
        centred = days - days.mean()
        slope = float(centred @ values / (centred @ centred))
        rest = values - values.mean() - slope * centred
        error = float(np.sqrt(rest @ rest / (n - 2) / (centred @ centred)))
        drift, drifts = slope * float(np.ptp(days)), abs(slope) > float(stdtrit(n - 2, 0.995)) * error
    return RepeatedValue(
        passages=n,
        mean=float(values.mean()),
        lowest=float(values.min()),
        highest=float(values.max()),
        spread=spread,
        mean_range=mean_range,
        drift=drift,
        drifts=drifts,
    )
