"""Grading a record by the rules of a profile."""

import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import BoundMissing, Profile, Rule, resolve_bounds
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.grading.case_grading import criterion_name, finite_values, grade_criterion
from pantocheck.conformance.grading.extended_band import find_unvalidated
from pantocheck.conformance.grading.verdicts import Verdict, worst_verdict
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.trust import Trust, limit_counts
from pantocheck.conformance.quantities.bands import amplitude_spectrum
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.signals import EXTENDED_CUTOFF_HZ
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.results_building import build_results, utc_now
from pantocheck.conformance.results.results_format import (
    CaseResult,
    Criterion,
    FilterFacts,
    Results,
    RunFacts,
    SystemIdentity,
    Traces,
)
from pantocheck.conformance.results.traces import build_signal_traces


@dataclass(frozen=True)
class _Graded:
    """Criteria, and rules that could not be applied and need not be."""

    criteria: tuple[Criterion, ...]
    left_out: tuple[str, ...]


def assess_record(
    subject: AssessedRecord,
    profile: Profile,
    trust: Trust = "secondary",
    measured: AssessedRecord | None = None,
    limits: Sequence[Limit] = (),
) -> Results:
    """Grade a record by a profile.

    Parameters
    ----------
    subject : AssessedRecord
        The record.
    profile : Profile
        Its rules.
    trust : Trust
        Lowest trust of the rules that carry a verdict.
    measured : AssessedRecord or None
        The record to compare with, for a profile that compares.
    limits : Sequence[Limit]
        a user's own, in place of the rules of the same quantity.

    Raises
    ------
    InputError
        a measured record is missing or of no use, or does not fit the record.
    """
    _check_pair(subject, measured, profile)
    graded = _graded(subject, profile, trust, measured, limits)
    verdict = worst_verdict(item.verdict for item in graded.criteria)
    digest = hashlib.sha256("\n".join([subject.digest, measured.digest if measured else "", profile.model_dump_json()])
                            .encode()).hexdigest()  # fmt: skip
    told = [one for one in (subject, measured) if one is not None]
    case = CaseResult(
        id=f"{profile.name}/{re.sub(r'[^A-Za-z0-9._-]', '_', subject.name)}",
        title=f"{profile.title}: {subject.name}",
        verdict=verdict,
        reason=None,
        notes=[*(_of(one, note, told) for one in told for note in one.notes), *filter(None, [_note(profile.note)])],
        warnings=[
            *(_of(one, warning, told) for one in told for warning in one.warnings),
            *graded.left_out,
            *_turning(graded.criteria, measured),
            *find_unvalidated(subject.values),
        ],
        inputs=[group for one in told for group in one.inputs],
        input_digest=f"sha256:{digest}",
        criteria=list(graded.criteria),
        quantities={str(of): finite_values(values) for of, values in subject.values.values.items() if values},
        skipped={str(of): reasons for of, reasons in subject.values.skipped.items() if reasons},
        spread={},
        uncertainty={str(of): values for of, values in subject.uncertainty.items()},
        run=_run(subject, profile),
        traces=_traces(subject),
        uplift=[],
    )
    system = SystemIdentity(name=subject.system.name, version=subject.system.version, kind="record")
    return build_results([case], system, trust, utc_now())


def _check_pair(subject: AssessedRecord, measured: AssessedRecord | None, profile: Profile) -> None:
    if profile.compares and measured is None:
        raise InputError(
            f"profile '{profile.name}'",
            "compares with a measured record, and none is given",
            "Add --measured RECORD2 .",
        )
    if measured is None:
        return
    if not profile.compares:
        raise InputError(
            f"profile '{profile.name}'", "does not compare with a measured record", "Leave --measured out."
        )
    where, ours, theirs = f"measured record '{measured.name}'", subject.said.speed_km_h, measured.said.speed_km_h
    if subject.pantographs != measured.pantographs:
        raise InputError(
            where,
            f"it has {len(measured.pantographs)} pantographs, {subject.name} has {len(subject.pantographs)}",
            "Compare records of the same train.",
        )
    if abs(theirs / ours - 1) > profile.speed_tolerance_pct / 100:
        raise InputError(
            where, f"it is of {theirs:g} km/h, {subject.name} of {ours:g} km/h", "Compare records at the same speed."
        )


def _graded(
    subject: AssessedRecord, profile: Profile, trust: Trust, measured: AssessedRecord | None, limits: Sequence[Limit]
) -> _Graded:
    criteria: list[Criterion] = []
    left_out: list[str] = []
    own = {limit.target for limit in limits}
    for rule in profile.rule:
        owners = subject.pantographs if QUANTITIES[rule.quantity].scope == "pantograph" else (LINE,)
        for of in owners:
            if (rule.quantity, of, None) in own:
                continue
            try:
                criteria.append(_by_rule(rule, of, subject, measured, trust))
            except BoundMissing as reason:
                if rule.need == "if_known":
                    left_out.append(f"{rule.quantity} is not graded: {reason}")
                else:
                    criteria.append(_without_bound(rule, of, subject, trust, str(reason)))
    criteria += [_with_uncertainty(grade_criterion(limit, subject.values, trust), subject) for limit in limits]
    return _Graded(tuple(criteria), tuple(left_out))


def _by_rule(rule: Rule, of: int, subject: AssessedRecord, measured: AssessedRecord | None, trust: Trust) -> Criterion:
    compared = measured.values.values.get(of, {}).get(rule.quantity) if measured is not None else None
    value = compared if isinstance(compared, float) and math.isfinite(compared) else None
    lower, upper = resolve_bounds(rule, subject.said.speed_km_h, subject.line.model_dump(), value)
    static = QUANTITIES[rule.quantity].scope == "static"
    if static and rule.need == "if_known" and rule.quantity not in subject.values.values[LINE]:
        raise BoundMissing("the record does not give it")
    limit = Limit(
        quantity=rule.quantity,
        pantograph=of or None,
        lower=lower,
        upper=upper,
        trust=rule.trust,
        source=_source(rule, value, measured),
        note=rule.note,
    )
    return _with_uncertainty(grade_criterion(limit, subject.values, trust), subject)


def _source(rule: Rule, value: float | None, measured: AssessedRecord | None) -> str:
    text = source_text(rule.source)
    if not rule.compares or value is None or measured is None:
        return text
    allowed = f"{rule.tolerance:g} {QUANTITIES[rule.quantity].unit}" if rule.tolerance else f"{rule.tolerance_pct:g} %"
    return f"{text}; {allowed} about the measured {value:.4g} of {measured.name}"


def _without_bound(rule: Rule, of: int, subject: AssessedRecord, trust: Trust, reason: str) -> Criterion:
    """A rule that has no bound for this record: skipped, with its value told."""
    verdict: Verdict = "skip" if limit_counts(rule.trust, trust) else "info"
    value = subject.values.values.get(of, {}).get(rule.quantity)
    return Criterion(
        quantity=rule.quantity,
        pantograph=of,
        value=value if isinstance(value, float) and math.isfinite(value) else None,
        unit=QUANTITIES[rule.quantity].unit,
        lower=None,
        upper=None,
        verdict=verdict,
        trust=rule.trust,
        source=source_text(rule.source),
        margin=None,
        discretisation_error=None,
        reason=reason,
    )


def _with_uncertainty(item: Criterion, subject: AssessedRecord) -> Criterion:
    found = subject.uncertainty.get(item.pantograph, {}).get(item.quantity)
    return item if found is None or item.value is None else item.model_copy(update={"uncertainty": found})


def _turning(criteria: Sequence[Criterion], measured: AssessedRecord | None) -> list[str]:
    """Verdicts that a longer record could turn are named."""
    found = []
    for item in criteria:
        theirs = measured.uncertainty.get(item.pantograph, {}).get(item.quantity, 0.0) if measured is not None else 0.0
        reach = math.hypot(item.uncertainty or 0.0, theirs)
        if item.value is None or reach == 0 or item.lower is item.upper is None:
            continue
        distance = min(abs(item.value - bound) for bound in (item.lower, item.upper) if bound is not None)
        if distance < reach:
            found.append(
                f"{criterion_name(item)} lies {distance:.2g} {item.unit} from a limit, less "
                f"than its uncertainty of {reach:.2g} {item.unit}: a longer record could turn the verdict"
            )
    return found


def _run(subject: AssessedRecord, profile: Profile) -> RunFacts:
    signals, run = subject.signals, subject.said.run
    stretch = subject.said.evaluated_m if signals is None else signals.evaluated
    return RunFacts(
        simulated_s=run.simulated_s if signals is None else signals.seconds,
        wall_s=run.wall_s,
        dt_s=run.dt_s,
        element_m=run.element_m,
        speed_km_h=subject.said.speed_km_h,
        rate_Hz=None if signals is None else signals.rate,
        filter=FilterFacts(**profile.filter.model_dump()),
        evaluated_m=None if stretch is None else (stretch[0], stretch[1]),
    )


def _traces(subject: AssessedRecord) -> dict[str, Traces]:
    traces: dict[str, Traces] = {}
    if subject.signals is None:
        return traces
    supports = getattr(subject.said, "support_position_m", None) or ()
    start, end = subject.signals.evaluated
    for of, pooled in subject.signals.pantographs.items():
        if not pooled.parts:
            continue
        highest = min(
            EXTENDED_CUTOFF_HZ, HIGHEST_SHARE_OF_RATE * pooled.parts[0].rate, pooled.filter_applied_Hz or np.inf
        )
        # Stretches of different lengths have different spectral lines: only one of them can be drawn.
        one = len(pooled.parts) == 1
        spectrum = amplitude_spectrum(pooled.delivered, pooled.parts[0].rate, highest) if one else (_NONE, _NONE)
        within = [x for x in supports if start <= x <= end]
        traces[str(of)] = build_signal_traces(pooled, pooled.position, within, spectrum)
    return traces


_NONE = np.empty(0)


def _of(one: AssessedRecord, text: str, all_of_them: list[AssessedRecord]) -> str:
    """A remark with the record it is about, if there are two."""
    return text if len(all_of_them) == 1 else f"{one.name}: {text}"


def _note(text: str | None) -> str | None:
    return text.strip() if text else None
