"""Assessment of a collection: passages over every section, their verdicts, repeats and worst places."""

import heapq
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np
from scipy.special import stdtrit

from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.core.figure_data import Series
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict, judge_parts, worst_verdict
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.network.run_collection import RefusedFile, StoredRun
from pantocheck.conformance.network.section_grading import (
    NETWORK_QUANTITIES,
    Prominence,
    grade_run,
    list_grid,
)
from pantocheck.conformance.network.track_places import find_known_place, list_tension_sections
from pantocheck.conformance.network.unusual_values import GroupedPassages, find_unusual
from pantocheck.conformance.results.network_format import (
    Direction,
    ForcePlace,
    GroupKey,
    KnownPlace,
    NetworkResults,
    RefusedImport,
    RepeatedValue,
    SectionGroup,
    SectionPassage,
    TrackSection,
    UnusualValue,
)

SPEED_CLASS_KM_H = 10.0
"""Width of a class of speeds [km/h]."""

SAME_PLACE_KM = 0.03
"""Largest distance of two deviations that belong to one place [km]: half a span."""

WORST_PLACES = 100
"""Number of places whose force is kept."""

TRACE_POINTS = 300
"""Largest number of points of such a force."""

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


@dataclass
class _Findings:
    """Passages and places of the runs that are graded so far; samples and traces of most places are not kept."""

    passages: list[SectionPassage] = field(default_factory=list)
    places: list[ForcePlace] = field(default_factory=list)
    traced: list[tuple[float, int]] = field(default_factory=list)
    """Heap of the deviations whose traces are kept, with the index of the place."""

    def add_place(self, passage: SectionPassage, found: Prominence) -> None:
        """Add a prominent place of a passage, and drop the trace of the least prominent one if there are too many."""
        place = ForcePlace(
            line=passage.section.line,
            track=passage.section.track,
            km=round(found.km, 4),
            run=passage.run,
            date=passage.date,
            direction=passage.direction,
            pantograph=passage.pantograph,
            force_N=round(found.force, 2),
            deviation=round(found.deviation, 2),
            found=1,
            passages=1,
            place="",
            explained=False,
            trace=_thin(found),
        )
        self.places.append(place)
        heapq.heappush(self.traced, (abs(place.deviation), len(self.places) - 1))
        if len(self.traced) > 4 * WORST_PLACES:  # several runs show the same place
            _, index = heapq.heappop(self.traced)
            self.places[index] = self.places[index].model_copy(update={"trace": None})


def _thin(found: Prominence) -> Series:
    step = max(1, -(-found.trace.size // TRACE_POINTS))
    x, y = (round_digits(values[::step], 6) for values in (found.trace_km, found.trace))
    return Series(label="filtered force", style="line", x=x, y=y)


def assess_network(
    runs: Iterable[StoredRun],
    refused: Sequence[RefusedFile],
    task: AssessmentTask,
    report: Callable[[StoredRun, list[SectionPassage]], None],
) -> NetworkResults:
    """Grade every section of a collection; one run at a time is in memory.

    Args:
        runs: Runs in the order of line and track.
        refused: Files that were refused.
        task: Rules and grouping.
        report: Function that receives the passages of each run when it is graded.

    Raises:
        InputError: There is no run, or the files of one are damaged.
    """
    found, sections, suspicious, count = _Findings(), list[TrackSection](), dict[str, tuple[str, ...]](), 0
    for (line, track), part in groupby(runs, key=lambda run: (run.facts.line, run.facts.track)):
        here = list(part)
        own = list_tension_sections(task.known_places, line, track)
        ends = [(min(x.facts.from_km, x.facts.to_km), max(x.facts.from_km, x.facts.to_km)) for x in here]
        own = own or list_grid(line, track, ends, task.length_km)
        sections += own
        for run in here:
            graded = list(grade_run(run, own, task.profile, task.trust))
            for item in graded:
                for prominence in item.places:
                    found.add_place(item.passage, prominence)
            passages = [item.passage for item in graded]
            found.passages += passages
            count += 1
            if run.facts.remarks:
                suspicious[run.facts.run] = run.facts.remarks
            report(run, passages)
    if not count:
        raise InputError("collection", "has no run", "Import files: pantocheck runs import FILE ... --out DIR.")
    rows = _group(found.passages, sections, task.by)
    groups = [group for group, _ in rows]
    verdict, reason = judge_network(groups, refused)
    lengths = {_key(section): section.to_km - section.from_km for section in sections}
    measured = {_key(group.section) for group in groups if group.passages}
    return NetworkResults(
        suite=build_suite(),
        profile=task.profile.name,
        trust=task.trust,
        by=task.by,
        verdict=verdict,
        reason=reason,
        runs=count,
        passages=len(found.passages),
        measured_km=round(sum(lengths[key] for key in measured), 6),
        total_km=round(sum(lengths.values()), 6),
        groups=tuple(groups),
        places=tuple(_join_places(found, task.known_places)),
        unusual=tuple(_compare_sections(rows)),
        known_places=task.known_places,
        refused=tuple(RefusedImport(file=item.file, reason=item.reason) for item in refused),
        suspicious=suspicious,
    )


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
        run=next((x.run for x in whole if x.verdict == verdict), whole[0].run) if whole else None,
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


def _join_places(found: _Findings, known: Sequence[KnownPlace]) -> Iterator[ForcePlace]:
    """Places with the deviations that lie close to each other, the worst first; traces of the first hundred."""
    passed = defaultdict[tuple[str, str], list[TrackSection]](list)
    for passage in found.passages:
        if passage.speed_km_h is not None:
            passed[passage.section.line, passage.section.track].append(passage.section)
    clusters: list[list[ForcePlace]] = []
    for place in sorted(found.places, key=lambda x: (x.line, x.track, x.km, x.run, x.pantograph)):
        last = clusters[-1][-1] if clusters else None
        near = last is not None and (last.line, last.track) == (place.line, place.track)
        if near and last is not None and place.km - last.km <= SAME_PLACE_KM:
            clusters[-1].append(place)
        else:
            clusters.append([place])
    joined = [_join(cluster, passed, known) for cluster in clusters]
    joined.sort(key=lambda x: (-abs(x.deviation), x.line, x.track, x.km))
    for rank, place in enumerate(joined):
        yield place if rank < WORST_PLACES else place.model_copy(update={"trace": None})


def _join(
    cluster: Sequence[ForcePlace],
    passed: Mapping[tuple[str, str], Sequence[TrackSection]],
    known: Sequence[KnownPlace],
) -> ForcePlace:
    worst = max(cluster, key=lambda place: abs(place.deviation))
    passages = sum(x.from_km <= worst.km < x.to_km for x in passed[worst.line, worst.track])
    name, explained = find_known_place(known, worst.line, worst.track, worst.km)
    shown = len({(place.run, place.pantograph) for place in cluster})
    changes = {"found": shown, "passages": max(passages, shown), "place": name, "explained": explained}
    return worst.model_copy(update=changes)
