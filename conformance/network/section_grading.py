"""Grading of one run by sections of its track: the same rules and signals as the assessment of a record."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import Criterion, judge_criteria
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.assessed_record import AssessedRecord, evaluate_by_profile, prepare_by_profile
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.rule_grading import RuleGrading
from pantocheck.conformance.network.run_collection import StoredRun
from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.quantities.line_signals import supports_inside
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.quantities.uncertainty import Uncertainty
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_preparation import PreparedRecord
from pantocheck.conformance.records.record_reading import read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples
from pantocheck.conformance.records.usable_sections import find_usable_sections, place_samples
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.results.network_format import SectionPassage, TrackSection

NETWORK_QUANTITIES = (
    *("mean_force_N", "std_force_N", "cov_20", "statistical_max_N", "statistical_min_N", "max_force_N", "min_force_N"),
    *("contact_loss_pct", "arc_share_pct", "contact_height_range_mm", "max_uplift_at_support_mm"),
)
"""Quantities that a table of sections shows, as far as they were measured."""

END_TOLERANCE_M = 1.0
"""Part of a section by which the stated track of a run may miss its end [m]: rounding of kilometres."""

MARGIN_S, MARGIN_M = 3.0, 200.0
"""Samples on either side of a section that are prepared with it [s, m].

After 3 s the response of a filter at 20 Hz has decayed by more than sixteen digits.
"""


@dataclass(frozen=True)
class GradedPassage:
    """Passage over a section with its force."""

    passage: SectionPassage
    km: RealArray
    force: RealArray
    """Kilometre and filtered force, in running order, (n,) [km, N]; empty if the force is not known."""
    all_values: ValuesByOwner
    """All quantities, by pantograph (0: the line)."""


def grade_run(
    run: StoredRun, sections: Sequence[TrackSection], profile: Profile, trust: Trust
) -> Iterator[GradedPassage]:
    """Grade the sections that a run passes, one after the other.

    Args:
        run: Run of a collection.
        sections: Sections of its line and track.
        profile: Profile with the rules.
        trust: Lowest trust of the rules that count.

    Raises:
        InputError: The files of the run are damaged.
    """
    samples, sidecar, _ = read_samples(run.sidecar)
    facts, track = run.facts, sidecar.track
    assert track is not None  # required by the import
    placed = place_samples(samples, sidecar)
    first, time, regular = placed.position[0], placed.time, _is_regular(placed.time)
    low, high = sorted((facts.from_km, facts.to_km))
    for section in sections:
        if not (section.from_km < high and section.to_km > low):
            continue
        start, end = sorted(map(track.place, (section.from_km, section.to_km)))
        tolerance = END_TOLERANCE_M / 1000
        whole = low <= section.from_km + tolerance and high >= section.to_km - tolerance
        speed = _mean_speed(first, time, start, end) if whole else None
        values: ValuesByOwner = {}
        criteria: list[Criterion] = []
        reason, subject = "the run passes a part of the section", None
        if speed is not None:
            part = select_stretch(placed.samples, placed.position, time, (start, end)) if regular else samples
            own = sidecar.model_copy(update={"evaluated_m": (start, end), "speed_km_h": speed})
            try:
                subject = _evaluate(part, own, profile, run)
            except RecordInvalid as error:
                reason = f"{error.channel}: {error.found}"
            else:
                values = subject.values.values
                criteria = RuleGrading(subject, None, trust).grade_profile(profile, ())
        elif whole:
            reason = "the record does not reach both ends of the section"
        for number, name in enumerate(facts.pantographs, 1):
            passage = SectionPassage(
                section=section,
                run=facts.run,
                date=facts.date,
                direction=facts.kilometres,
                pantograph=name,
                speed_km_h=speed,
                whole=whole,
                verdict="skip",
                reason=reason,
                values={},
            )
            km = force = np.empty(0)
            if subject is not None and subject.prepared is not None:
                passage = _judge(passage, [c for c in criteria if c.pantograph in (LINE, number)], profile, values)
                passage = passage.model_copy(update={"clocks": "; ".join(_list_clocks(subject.prepared))})
                signals = subject.prepared.pantographs[number]
                with suppress(QuantityUnavailable):
                    force, place = signals.graded, signals.position[signals.inside]
                    km = track.zero_km + track.direction * place / 1000
            yield GradedPassage(passage, km, force, values)


def _list_clocks(prepared: PreparedRecord) -> Iterator[str]:
    """Names of further sources with the state or the uncertainty of their clocks."""
    for part in prepared.alignments:
        if supports_inside(part.source.supports, prepared.section).any():
            yield f"{part.source.name} {part.state}"
    for name, _, clock in prepared.place_clocks:
        yield f"{name} within {clock.uncertainty:.2g} s"


def _is_regular(time: RealArray) -> bool:
    """Whether the samples between gaps are evenly spaced, so that a part of the record is prepared like the whole."""
    step = float(np.median(np.diff(time)))
    parts = find_usable_sections(time, np.ones(time.size, dtype=bool))
    return all(
        np.abs(time[part] - np.linspace(time[part[0]], time[part[-1]], part.size)).max() <= 0.01 * step
        for part in parts
    )


def _mean_speed(position: RealArray, time: RealArray, start: float, end: float) -> float | None:
    """Mean speed over a section, to 0.1 km/h; None if the record does not reach its ends."""
    if position[0] > start + END_TOLERANCE_M or position[-1] < end - END_TOLERANCE_M:
        return None
    begin, finish = np.interp((start, end), position, time)
    return round(3.6 * (end - start) / float(finish - begin), 1)


def select_stretch(
    samples: RecordSamples, position: RealArray, time: RealArray, section: tuple[float, float]
) -> RecordSamples:
    """Samples of a section with the margin that its preparation needs.

    A record with further clocks, or whose time or position is an integral over its whole length, stays whole.

    Args:
        samples: Samples with time and position.
        position: Position of each pantograph, (p, n) [m].
        time: Time, (n,) [s].
        section: Ends of the section [m].
    """
    if samples.sources.uplift or samples.sources.clocks or samples.time is None or samples.position is None:
        return samples
    inside = (position.max(axis=0) >= section[0] - MARGIN_M) & (position.min(axis=0) <= section[1] + MARGIN_M)
    begin, finish = time[np.flatnonzero(inside)[[0, -1]]]
    first, last = np.searchsorted(time, begin - MARGIN_S), np.searchsorted(time, finish + MARGIN_S, "right")
    return samples.select(slice(int(first), int(last)))


def _evaluate(samples: RecordSamples, sidecar: RecordSidecar, profile: Profile, run: StoredRun) -> AssessedRecord:
    """Record of one section, without the uncertainty of a single passage: a group has that of its repeats."""
    prepared, events, warnings = prepare_by_profile(samples, sidecar, profile, sidecar.line)
    return AssessedRecord(
        name=run.facts.run,
        header=sidecar,
        line=sidecar.line,
        digest=run.facts.run,
        record_digest=run.facts.run,
        force_digest=None,
        values=evaluate_by_profile(prepared, samples, sidecar, sidecar.line),
        uncertainty=Uncertainty(),
        prepared=prepared,
        notes=prepared.notes,
        warnings=(*prepared.warnings, *warnings),
        events=events,
    )


def _judge(
    passage: SectionPassage, criteria: Sequence[Criterion], profile: Profile, values: ValuesByOwner
) -> SectionPassage:
    """Passage with its verdict, by the rule of the assessment of a record."""
    record = RecordFacts(state="unconfirmed", reason="", demanded=profile.verification == "demanded")
    number = max((criterion.pantograph for criterion in criteria), default=1) or 1
    found = {**values.get(LINE, {}), **values.get(number, {})}
    reasons = [f"{c.quantity}: {c.reason}" for c in criteria if c.verdict not in ("pass", "info") and c.reason]
    return passage.model_copy(
        update={
            "verdict": judge_case([judge_criteria(criteria)], record),
            "reason": "; ".join(reasons),
            "values": {name: x for name in NETWORK_QUANTITIES if isinstance(x := found.get(name), float)},
        }
    )


def list_grid(line: str, track: str, ends: Sequence[tuple[float, float]], length_km: float) -> list[TrackSection]:
    """Sections of equal length between whole multiples of it, over the whole track between the first and last end.

    Args:
        line, track: Names of line and track.
        ends: Lower and higher kilometre of each run.
        length_km: Length of a section [km].
    """
    first = int(np.floor(min(low for low, _ in ends) / length_km + 1e-6))
    last = int(np.ceil(max(high for _, high in ends) / length_km - 1e-6))
    marks = [round(number * length_km, 6) for number in range(first, max(last, first + 1) + 1)]
    return [TrackSection(line=line, track=track, name="", from_km=low, to_km=high) for low, high in pairwise(marks)]
