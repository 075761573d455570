"""Assessed record: a record or a summary, with its quantities and their uncertainty."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.profile_file import ExclusionRule, Profile
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.table_sidecar import record_digest
from pantocheck.conformance.grading.record_uncertainty import assess_uncertainty
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value, build_empty_evaluation
from pantocheck.conformance.quantities.filters import is_same_cutoff
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.uncertainty import Uncertainty
from pantocheck.conformance.records.events import RecordEvent, covered_share
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_preparation import PreparedRecord, prepare_record
from pantocheck.conformance.records.record_reading import build_record_error, list_tables, open_record, read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.records.samples import RecordSamples
from pantocheck.conformance.records.sidecar_tables import LineTable, SystemTable
from pantocheck.conformance.records.usable_sections import list_line_supports
from pantocheck.conformance.results.case_facts_format import EventFacts
from pantocheck.conformance.results.results_format import InputGroup

FEWEST_STATISTICS = 3
"""Smallest number of equal statistics that show a copy; rounded means of two records may be equal by chance."""

SAME_STATISTIC = 1e-6
"""Relative difference up to which two statistics are equal: those of independent records differ in earlier digits."""

ASSUMED_SPAN_M = 60.0
"""Assumed length of a span if the record does not state it [m]."""

PLAUSIBLE_SPANS_M = (20.0, 120.0)
"""Shortest and longest distance of two supports that is taken for a span [m]."""


@dataclass(frozen=True)
class AssessedRecord:
    """A record prepared for grading by a profile."""

    name: str
    """Name of the file."""
    header: RecordSidecar | RecordSummary
    """The sidecar, or the summary itself."""
    line: LineTable
    """Facts on the line, from the record and the command line."""
    digest: str
    """SHA-256 of all files that were read and of the facts on the line, in hexadecimal."""
    record_digest: str
    """SHA-256 of the files of the record."""
    force_digest: str | None
    """SHA-256 of the samples of the force, in any format of file; None for a summary."""
    values: Evaluation
    """Quantities, including those that follow from the line."""
    uncertainty: Uncertainty
    """Half-widths of the 95 % intervals by component."""
    prepared: PreparedRecord | None
    """Signals of the quantities; None for a summary."""
    notes: tuple[str, ...]
    """Remarks for the reader of the report."""
    warnings: tuple[str, ...]
    """Caveats for the reader of the report."""
    events: tuple[EventFacts, ...] = ()
    """Events of the analysis section."""

    @property
    def pantographs(self) -> tuple[int, ...]:
        """Numbers of the pantographs, from 1."""
        return tuple(owner for owner in self.values.values if owner != LINE)

    @property
    def system(self) -> SystemTable:
        """System that made the record; named after the file if the record does not state it."""
        return self.header.system or SystemTable(name=self.name)

    @property
    def inputs(self) -> list[InputGroup]:
        """Source of the numbers, if the record states it."""
        if not isinstance(self.header, RecordSummary):
            return []
        source = source_text(self.header.source)
        return [InputGroup(group=f"record {self.name}", trust=self.header.trust, source=source)]


def load_assessed_record(path: Path, profile: Profile, line: LineTable) -> AssessedRecord:
    """Read a record and compute its quantities for a profile.

    Args:
        path: Sidecar, table beside its sidecar, or summary record.
        profile: Profile with the filter and the speed tolerance.
        line: Facts on the line that replace those of the record.

    Raises:
        InputError: The record cannot be read, is impossible, or was filtered in another way than the profile requires.
    """
    header = open_record(path)
    known_line = header.line.model_copy(update=line.model_dump(exclude_none=True))
    if isinstance(header, RecordSummary):
        return _assess_summary(path, header, profile, known_line)
    samples, sidecar, table = read_samples(path)
    try:
        prepared, events, exclusion_warnings = prepare_by_profile(samples, sidecar, profile, known_line)
    except RecordInvalid as error:
        raise build_record_error(table, error) from None
    tables = list_tables(path, sidecar)
    files = map(file_digest, (path.with_suffix(".toml"), *tables))
    digest = join_digests(*files, known_line.model_dump_json())
    force_digest = hash_force(samples)
    return AssessedRecord(
        name=path.stem,
        header=sidecar,
        line=known_line,
        digest=digest,
        record_digest=record_digest(path, *tables),
        force_digest=force_digest,
        values=evaluate_by_profile(prepared, samples, sidecar, known_line),
        uncertainty=assess_uncertainty(prepared, find_span_length(known_line, sidecar), force_digest),
        prepared=prepared,
        notes=prepared.notes,
        warnings=(*prepared.warnings, *exclusion_warnings),
        events=events,
    )


def prepare_by_profile(
    samples: RecordSamples, sidecar: RecordSidecar, profile: Profile, line: LineTable
) -> tuple[PreparedRecord, tuple[EventFacts, ...], tuple[str, ...]]:
    """Signals of a record over its analysis section by the filter, supports and exclusions of a profile.

    Args:
        samples: Samples as read.
        sidecar: Sidecar of the record.
        profile: Profile with the filter and the speed tolerance.
        line: Facts on the line.

    Returns:
        prepared: Signals over the analysis section.
        events: Events of the analysis section.
        warnings: Sentences on stretches that are left out or not.

    Raises:
        RecordInvalid: The record is impossible, or has no usable part.
    """
    prepared = prepare_record(samples, sidecar, profile.filter, profile.speed_tolerance_pct)
    supports = list_line_supports(sidecar.support_position_m or (), line.span_m, prepared.section)
    prepared = prepared.with_supports(supports)
    excluded, events, warnings = apply_exclusions(prepared.events, prepared.section, profile.exclusion)
    pantographs = {
        number: replace(signals, shortest_loss_s=profile.shortest_contact_loss_s)
        for number, signals in prepared.pantographs.items()
    }
    return replace(prepared, excluded=excluded, pantographs=pantographs), events, warnings


def evaluate_by_profile(
    prepared: PreparedRecord, samples: RecordSamples, sidecar: RecordSidecar, line: LineTable
) -> Evaluation:
    """Quantities of a prepared record, including those that follow from the line; other parameters as above."""
    missing = find_missing_statement(samples, sidecar)
    evaluation = prepared.evaluation if missing is None else build_empty_evaluation(missing, prepared.pantographs)
    return _add_line_quantities(evaluation, line, sidecar.speed_km_h)


SECTION_NOT_STATED = "the analysis section is not stated: add evaluated_m to the sidecar"
"""Reason why a record is not evaluated, or not compared."""


def find_missing_statement(samples: RecordSamples, sidecar: RecordSidecar) -> str | None:
    """Find the reason why no quantity of a record is evaluated; None if section and speed are stated.

    Without them, a record that was cut short or ran at another speed could not be told from a complete one.

    Args:
        samples: Samples as read.
        sidecar: Sidecar of the record.
    """
    if sidecar.evaluated_m is None:
        return SECTION_NOT_STATED
    if samples.speed is None and (samples.time is None or samples.position is None):
        return "the speed of the train is not recorded: add speed_m_s, or both time_s and position_1_m"
    return None


def _assess_summary(path: Path, summary: RecordSummary, profile: Profile, line: LineTable) -> AssessedRecord:
    cutoff = profile.filter.cutoff_Hz
    if not is_same_cutoff(summary.filter_cutoff_Hz, cutoff):
        raise InputError(
            f"summary record '{path.name}', key filter_cutoff_Hz",
            f"the force was filtered at {summary.filter_cutoff_Hz:g} Hz, profile {profile.name} requires {cutoff:g} Hz",
            "Compute the statistics with the filter of the profile.",
        )
    return AssessedRecord(
        name=path.stem,
        header=summary,
        line=line,
        digest=join_digests(file_digest(path.with_suffix(".toml")), line.model_dump_json()),
        record_digest=record_digest(path),
        force_digest=None,
        values=_add_line_quantities(summary.evaluation, line, summary.speed_km_h),
        uncertainty=Uncertainty(),
        prepared=None,
        notes=(f"{path.stem} is a summary record: its values are graded as given.",),
        warnings=summary.contradictions,
    )


def find_span_length(line: LineTable, header: RecordSidecar | RecordSummary) -> float:
    """Length of a span [m]: as stated, or from the supports."""
    if line.span_m is not None:
        return line.span_m
    distances = np.diff(np.unique(getattr(header, "support_position_m", None) or ()))
    shortest, longest = PLAUSIBLE_SPANS_M
    plausible = distances[(distances >= shortest) & (distances <= longest)]
    return float(np.median(plausible)) if plausible.size else ASSUMED_SPAN_M


def _add_line_quantities(evaluation: Evaluation, line: LineTable, speed_km_h: float) -> Evaluation:
    """Quantities with the wave speed of the line and the speed relative to it, if the wave speed is known."""
    values: dict[str, Value] = dict(evaluation.values[LINE])
    wave_speed = line.wave_speed_m_s if line.wave_speed_m_s is not None else values.get("wave_speed_m_s")
    if isinstance(wave_speed, float) and wave_speed > 0:
        values |= {"wave_speed_m_s": wave_speed, "speed_over_wave_speed": speed_km_h / 3.6 / wave_speed}
    skipped = dict(evaluation.skipped[LINE])
    if "speed_over_wave_speed" not in values:
        skipped["speed_over_wave_speed"] = "the wave speed of the line is not known: add wave_speed_m_s"
    ordered = {name: values[name] for name in QUANTITIES if name in values}
    return Evaluation({**evaluation.values, LINE: ordered}, {**evaluation.skipped, LINE: skipped})


def hash_force(samples: RecordSamples) -> str:
    """SHA-256 of the force, rounded to 1 mN: units and formats of files change the last digits only."""
    return hashlib.sha256((np.round(samples.force, 3) + 0.0).tobytes()).hexdigest()  # + 0.0: -0.0 is 0.0


def find_equal_pantograph(subject: AssessedRecord, other: AssessedRecord) -> int | None:
    """Pantograph whose samples or statistics are the same in two records; None if the records are independent.

    Statistics of two independent records never agree to six digits. A copy agrees in all of them, in any format.
    """
    if subject.force_digest is not None and subject.force_digest == other.force_digest:
        return subject.pantographs[0]
    for number in subject.pantographs:
        statistics, others = subject.values.values[number], other.values.values.get(number, {})
        pairs = [(value, others[name]) for name, value in statistics.items() if value != 0 and name in others]
        if len(pairs) >= FEWEST_STATISTICS and all(
            np.allclose(value, same, SAME_STATISTIC, 0) for value, same in pairs
        ):
            return number
    return None


def join_digests(*parts: str) -> str:
    """SHA-256 of texts and digests, in hexadecimal."""
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


# Stretches that a measured record leaves out of the evaluation, as far as the profile permits it.
#
# An exclusion can hide the places of large forces. It therefore needs a stated reason, a kind that the profile permits,
# and a bounded share; without them the whole analysis section is evaluated. No profile of the library permits one.
Stretches = tuple[tuple[float, float], ...]


def apply_exclusions(
    events: Sequence[RecordEvent], section: tuple[float, float], rule: ExclusionRule | None
) -> tuple[Stretches, tuple[EventFacts, ...], tuple[str, ...]]:
    """Decide which events of a record are left out.

    Args:
        events: Events of the analysis section.
        section: Start and end of the analysis section [m].
        rule: Rule of the profile; None: nothing may be left out.

    Returns:
        excluded: Stretches that are left out [m, m].
        facts: Every event, with the reason why it is left out or not.
        warnings: Sentences on stretches that are left out, and on exclusions that are not applied.
    """
    wanted = [event for event in events if event.reason is not None]
    permitted = [event for event in wanted if rule is not None and event.kind in rule.kinds]
    share = 100 * covered_share([(event.start, event.end) for event in permitted], section)
    applied = rule is not None and bool(permitted) and share <= rule.largest_share_pct
    refusal = (
        "the profile permits no exclusion"
        if rule is None
        else f"{share:.3g} % of the section would be left out, the profile permits {rule.largest_share_pct:g} %"
    )
    facts = []
    for event in events:
        excluded = applied and event in permitted
        reason = refusal if rule is None or event in permitted else f"the profile permits no exclusion of {event.kind}"
        remark = "" if event.reason is None else event.reason if excluded else f"evaluated: {reason}"
        facts.append(
            EventFacts(
                kind=event.kind,
                name=event.name,
                start_m=event.start,
                end_m=event.end,
                excluded=excluded,
                remark=remark,
            )
        )
    return (
        tuple((event.start, event.end) for event in permitted) if applied else (),
        tuple(facts),
        tuple(_warn(facts, wanted, share, applied=applied)),
    )


def _warn(facts: Sequence[EventFacts], wanted: Sequence[RecordEvent], share: float, *, applied: bool) -> list[str]:
    """Sentences for the reader of the report."""
    warnings = []
    if applied:
        places = "; ".join(
            f"{fact.kind.replace('_', ' ')} {fact.name} {fact.start_m:.1f}-{fact.end_m:.1f} m ({fact.remark})".replace(
                "  ", " "
            )
            for fact in facts
            if fact.excluded
        )
        warnings.append(f"{share:.3g} % of the analysis section is left out of the force statistics: {places}")
    refused = {fact.remark.removeprefix("evaluated: ") for fact in facts if fact.remark and not fact.excluded}
    if wanted and refused:
        warnings.append(f"stretches that the record wants to leave out are evaluated: {'; '.join(sorted(refused))}")
    return warnings
