"""Assessment of a record by a profile: acceptance of a line, or a simulation against a line test."""

import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.comparison.force_difference import pair_forces
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import judge_criteria
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.packed_samples import SignalSamples
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.assessed_record import (
    SECTION_NOT_STATED,
    AssessedRecord,
    find_equal_pantograph,
    find_span_length,
    join_digests,
)
from pantocheck.conformance.grading.case_conformity import find_case_conformity
from pantocheck.conformance.grading.case_identity import compare_profile_with_library, profile_limits_digest
from pantocheck.conformance.grading.case_verdict import EVERY_CASE, Participation, judge_case
from pantocheck.conformance.grading.contact_loss_list import build_contact_losses, find_force_places
from pantocheck.conformance.grading.results_building import (
    build_results,
    key_by_owner,
    list_components,
    select_finite,
    utc_now,
)
from pantocheck.conformance.grading.rule_grading import RuleGrading
from pantocheck.conformance.grading.source_facts import build_source_facts
from pantocheck.conformance.grading.validity_warnings import warn_of_unvalidated_band
from pantocheck.conformance.quantities.line_signals import supports_inside
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.evaluated_signals import pack_signals
from pantocheck.conformance.records.traces import build_pantograph_traces, build_spectrum, thin_series
from pantocheck.conformance.results.case_facts_format import (
    ForceStatistics,
    MeasuredPantograph,
    MeasuredRun,
    RecordFacts,
    SpanStatistics,
)
from pantocheck.conformance.results.results_format import CaseResult, Results, RunFacts, SystemIdentity

LARGEST_SECTION_SHIFT = 0.5
"""Largest difference between the ends of two analysis sections, in spans or shorter sections: with more, another place
counts."""


# Measured run beside a simulated one: filtered forces at the same positions, spectra, and statistics by span.


def list_run_supports(record: AssessedRecord) -> tuple[float, ...]:
    """Positions of the supports that a record states or implies [m]; empty if it does neither."""
    if record.prepared is None:
        return ()
    return record.prepared.line.line_supports or tuple(getattr(record.header, "support_position_m", None) or ())


def compare_measured_run(
    simulated: AssessedRecord, measured: AssessedRecord, supports: Sequence[float]
) -> MeasuredRun | None:
    """Compare a measured run with a simulated one at the same positions.

    Args:
        simulated: Record of the simulated passage.
        measured: Record of the same passage.
        supports: Positions of the supports, for the statistics span by span [m].

    Returns:
        The measured run; None if one of the records is a summary.
    """
    if simulated.prepared is None or measured.prepared is None:
        return None
    others = measured.prepared.pantographs
    pairs = {number: (own, others[number]) for number, own in simulated.prepared.pantographs.items()}
    compared = {str(number): _compare_forces(*pair, supports) for number, pair in pairs.items()}
    return MeasuredRun(
        name=measured.name,
        cutoff_Hz=pairs[1][0].force.low_pass.cutoff_Hz,
        quantities=key_by_owner(select_finite(measured.values.values)),
        uncertainty=key_by_owner(select_finite(measured.uncertainty.combined)),
        pantographs={number: part for number, part in compared.items() if part is not None},
    )


def _compare_forces(
    simulated: PantographSignals, measured: PantographSignals, supports: Sequence[float]
) -> MeasuredPantograph | None:
    """Forces of one pantograph; None if the runs share no track that is long enough for the filter."""
    try:
        forces = pair_forces(measured, simulated, simulated.force.low_pass.cutoff_Hz)
        spectra = (build_spectrum(simulated), build_spectrum(measured))
    except QuantityUnavailable:
        return None
    limits = np.asarray(supports, dtype=np.float64)
    within = np.unique(limits[supports_inside(limits, (forces.position[0], forces.position[-1]))])
    return MeasuredPantograph(
        position_m=thin_series(forces.position),
        simulated_N=thin_series(forces.second),
        measured_N=thin_series(forces.first),
        simulated_spectrum=spectra[0],
        measured_spectrum=spectra[1],
        spans=[
            SpanStatistics(
                start_m=float(start),
                end_m=float(end),
                simulated=_describe_force(span.second),
                measured=_describe_force(span.first),
            )
            for start, end in pairwise(within)
            for span in [forces.select(start, end)]
        ],
    )


def _describe_force(force: RealArray) -> ForceStatistics:
    return ForceStatistics(
        mean_N=float(force.mean()), std_N=float(force.std()), max_N=float(force.max()), min_N=float(force.min())
    )


def assess_record(
    subject: AssessedRecord,
    profile: Profile,
    trust: Trust = "secondary",
    measured: AssessedRecord | None = None,
    limits: Sequence[Limit] = (),
    participation: Participation = EVERY_CASE,
) -> Results:
    """Grade a record by a profile.

    Args:
        subject: Graded record.
        profile: Profile with the rules.
        trust: Lowest trust of the rules that count.
        measured: Measured record, for a profile that compares.
        limits: The user's own limits, which replace the rules of the same quantity.
        participation: Accepted unconfirmed records.

    Raises:
        InputError: A measured record is missing, not needed, or does not fit the record.
    """
    check_pair(subject, measured, profile)
    case = grade_record(subject, profile, trust, measured, limits, participation.decision)
    system = SystemIdentity(name=subject.system.name, version=subject.system.version, kind="record")
    return build_results([case], system, trust, utc_now(), participation)


def grade_record(
    subject: AssessedRecord,
    profile: Profile,
    trust: Trust,
    measured: AssessedRecord | None = None,
    limits: Sequence[Limit] = (),
    rule: DecisionRule = SIMPLE,
) -> CaseResult:
    """Result of a record by the rules of a profile; parameters as in `assess_record`."""
    grading = RuleGrading(subject, measured, trust, rule)
    criteria = grading.grade_profile(profile, limits)
    records = [record for record in (subject, measured) if record is not None]
    digest = join_digests(subject.digest, measured.digest if measured else "", profile.model_dump_json())
    reason = (
        "the checks of force against motion and of position against uplift need the pantograph and the line of a case, "
        "and a profile has none"
    )
    record = RecordFacts(
        state="unconfirmed",
        reason=reason,
        demanded=profile.verification == "demanded",
        digest=subject.record_digest,
        case_digest=subject.header.case_digest,
        measured_digest=None if measured is None else measured.record_digest,
    )
    return CaseResult(
        id=f"{profile.name}/{re.sub(r'[^A-Za-z0-9._-]', '_', subject.name)}",
        title=f"{profile.title}: {subject.name}",
        verdict=judge_case([judge_criteria(criteria)], record),
        criteria_verdict=None,
        reason=None,
        notes=[*_name_sources(records, "notes"), *([profile.note.strip()] if profile.note else [])],
        warnings=[*_name_sources(records, "warnings"), *warn_of_unvalidated_band(subject.values)],
        inputs=[group for record in records for group in record.inputs],
        input_digest=f"sha256:{digest}",
        limits_digest=profile_limits_digest(profile, limits),
        stated_limits_digest=profile_limits_digest(profile),
        limit_changes=grading.list_limit_changes(profile, limits),
        library=compare_profile_with_library(profile),
        profile=profile.name,
        steps=["line_test"] if profile.compares else [],
        criteria=criteria,
        conformity=find_case_conformity(criteria),
        quantities=key_by_owner(select_finite(subject.values.values)),
        skipped=key_by_owner(subject.values.skipped),
        spread={},
        uncertainty=key_by_owner(select_finite(subject.uncertainty.combined)),
        uncertainty_components=list_components(subject.uncertainty),
        uncertainty_basis=subject.uncertainty.basis,
        record=record,
        run=_run_facts(subject, profile),
        events=list(subject.events) or None,
        sources=build_source_facts(subject.prepared, None if measured is None else measured.prepared),
        contact_losses=None if subject.prepared is None else build_contact_losses(subject.prepared.pantographs),
        traces={}
        if subject.prepared is None
        else build_pantograph_traces(
            subject.prepared.pantographs, getattr(subject.header, "support_position_m", None) or ()
        ),
        uplift=[],
        signals=_pack(subject),
        comparison=None if measured is None else compare_measured_run(subject, measured, list_run_supports(subject)),
        places={} if subject.prepared is None else find_force_places(subject.prepared.pantographs),
    )


def _pack(subject: AssessedRecord) -> SignalSamples | None:
    """Signals of the quantities; None for a summary, and for a record without quantities."""
    prepared = subject.prepared
    if prepared is None or not any(subject.values.values.get(number) for number in prepared.pantographs):
        return None
    return pack_signals(prepared.pantographs, prepared.line, None, excluded=prepared.excluded)


def check_pair(subject: AssessedRecord, measured: AssessedRecord | None, profile: Profile) -> None:
    """Check that a measured record belongs to a record, and is not a copy of it; parameters as in `assess_record`.

    Raises:
        InputError: A measured record is missing, not needed, or does not fit the record.
    """
    where = f"profile '{profile.name}'"
    if measured is None:
        if profile.compares:
            raise InputError(where, "compares with a measured record, but there is none", "Add --measured RECORD2.")
        return
    if not profile.compares:
        raise InputError(where, "does not compare with a measured record", "Remove --measured.")
    where = f"measured record '{measured.name}'"
    speed, measured_speed = subject.header.speed_km_h, measured.header.speed_km_h
    if subject.pantographs != measured.pantographs:
        count, measured_count = len(subject.pantographs), len(measured.pantographs)
        raise InputError(
            where,
            f"it has {count_noun(measured_count, 'pantograph')}, {subject.name} has {count}",
            "Compare records of the same train.",
        )
    if not abs(measured_speed / speed - 1) <= profile.speed_tolerance_pct / 100:
        raise InputError(
            where,
            f"its speed is {measured_speed:g} km/h, that of {subject.name} is {speed:g} km/h",
            "Compare records at the same speed.",
        )
    if (number := find_equal_pantograph(subject, measured)) is not None:
        raise InputError(
            where,
            f"its contact force of pantograph {number} is that of {subject.name}: one record is a copy of the other",
            "Compare a simulated record with an independent measured record.",
        )
    spans = [find_span_length(record.line, record.header) for record in (subject, measured)]
    if (sections := describe_other_section(subject, measured, min(spans))) is not None:
        raise InputError(where, sections, "Compare records of the same section: state the same evaluated_m.")


def describe_other_section(simulated: AssessedRecord, measured: AssessedRecord, span_m: float) -> str | None:
    """Describe the analysis sections of two records whose ends differ by more than half a span; None: they agree.

    In a section shorter than a span, the length of the shorter section takes the place of the span.

    Args:
        simulated: Record of the simulated passage.
        measured: Record of the measured passage.
        span_m: Length of a span [m].
    """
    own, other = simulated.header.evaluated_m, measured.header.evaluated_m
    if own is None or other is None:
        # A record with samples then has no quantities, and says so.
        summaries = [record.header for record in (simulated, measured) if record.prepared is None]
        return SECTION_NOT_STATED if any(header.evaluated_m is None for header in summaries) else None
    allowed = LARGEST_SECTION_SHIFT * min(span_m, own[1] - own[0], other[1] - other[0])
    if max(abs(a - b) for a, b in zip(own, other, strict=True)) <= allowed:
        return None
    return (
        f"the analysis section of the measured run: {other[0]:g} to {other[1]:g} m; "
        f"of the simulated run: {own[0]:g} to {own[1]:g} m"
    )


def _run_facts(subject: AssessedRecord, profile: Profile) -> RunFacts:
    prepared, run = subject.prepared, subject.header.run
    section = subject.header.evaluated_m if prepared is None else prepared.section
    return RunFacts(
        simulated_s=run.simulated_s if prepared is None else prepared.seconds,
        wall_s=run.wall_s,
        dt_s=run.dt_s,
        element_m=run.element_m,
        speed_km_h=subject.header.speed_km_h,
        rate_Hz=None if prepared is None else prepared.rate,
        filter=profile.filter,
        evaluated_m=None if section is None else (section[0], section[1]),
    )


def _name_sources(records: Sequence[AssessedRecord], field: str) -> list[str]:
    """Notes or warnings of records; if there are several records, each text begins with the name of its record."""
    texts = [(record.name, text) for record in records for text in getattr(record, field)]
    return [text if len(records) == 1 else f"{name}: {text}" for name, text in texts]
