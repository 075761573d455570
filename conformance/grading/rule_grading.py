"""Grading of a record by the rules of a profile: each rule gives a criterion for every pantograph it applies to."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit, is_per_pantograph
from pantocheck.conformance.cases.profile_file import (
    BoundMissing,
    Profile,
    Rule,
    list_profiles,
    load_profile,
    resolve_bounds,
)
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.grading.case_identity import describe_limit_change
from pantocheck.conformance.grading.criterion_grading import GradedValues, grade_limit, skip_unlimited
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.quantities.registry import unit_of


@dataclass(frozen=True)
class RuleGrading:
    """Grading of a record by rules."""

    subject: AssessedRecord
    """Graded record."""
    measured: AssessedRecord | None
    """Measured record for rules that compare."""
    trust: Trust
    """Lowest trust of the rules that count."""
    decision: DecisionRule = SIMPLE
    """Decision rule."""

    def grade_profile(self, profile: Profile, limits: Sequence[Limit]) -> list[Criterion]:
        """Criteria of the rules of a profile, and of the user's own limits, which replace rules of the same quantity.

        A rule whose quantity or bound is not known is skipped: a record never decides which rules apply to it.
        """
        replaced = {limit.target for limit in limits}
        rules = [
            self._grade_rule(rule, owner)
            for rule, owner in self._pair_owners(profile)
            if (rule.quantity, owner, None) not in replaced
        ]
        return [*rules, *map(self._grade_limit, limits)]

    @property
    def _values(self) -> GradedValues:
        return GradedValues(self.subject.values, uncertainty=self.subject.uncertainty)

    def list_limit_changes(self, profile: Profile, limits: Sequence[Limit]) -> list[str]:
        """Sentences on the rules that the user's limits weaken or give another trust."""
        own = {limit.target: limit for limit in limits}
        changes = []
        for rule, owner in self._pair_owners(profile):
            if (limit := own.get((rule.quantity, owner, None))) is not None:
                with suppress(BoundMissing):
                    changes.append(describe_limit_change(self._resolve_rule(rule, owner), limit))
        return [change for change in changes if change is not None]

    def _pair_owners(self, profile: Profile) -> Iterator[tuple[Rule, int]]:
        """Every rule with every pantograph that it applies to."""
        for rule in profile.rule:
            owners = self.subject.pantographs if is_per_pantograph(rule.quantity) else (LINE,)
            yield from ((rule, owner) for owner in owners)

    def _grade_rule(self, rule: Rule, owner: int) -> Criterion:
        try:
            self._check_centre(rule, owner)
            limit = self._resolve_rule(rule, owner)
            return self._grade_limit(limit, _doubt_tolerance(rule, limit))
        except BoundMissing as reason:
            value = _finite_value(self.subject, owner, rule.quantity)
            unavailable = self.subject.values.skipped.get(owner, {}).get(rule.quantity) if value is None else None
            reasons = "; ".join(filter(None, (unavailable, str(reason))))
            return skip_unlimited(
                rule.quantity,
                reasons,
                source_text(rule.source),
                owner=owner,
                value=value,
                trust=rule.trust,
                lowest_trust=self.trust,
            )

    def _check_centre(self, rule: Rule, owner: int) -> None:
        """Check that the record of a measured value bounds its error; by the same rule, no value passes without it.

        Raises:
            BoundMissing: The effect of the sampling rate, resolution or clocks on the measured value is not known.
        """
        if not rule.compares or self.measured is None:
            return
        unknown = self.measured.uncertainty.list_unknown(owner, rule.quantity)
        if names := [name for name in BOUNDED_COMPONENTS if name in unknown]:
            raise BoundMissing(
                f"the uncertainty of the measured value of {self.measured.name} is not complete: "
                f"{', '.join(names)} not known"
            )

    def _grade_limit(self, limit: Limit, doubt: str | None = None) -> Criterion:
        return grade_limit(limit, self._values, self.trust, self._limit_uncertainty(limit), self.decision, doubt)

    def _resolve_rule(self, rule: Rule, owner: int) -> Limit:
        """Limit that follows from a rule for this record."""
        compared = None if self.measured is None else _finite_value(self.measured, owner, rule.quantity)
        lower, upper = resolve_bounds(rule, self.subject.header.speed_km_h, self.subject.line.model_dump(), compared)
        return Limit(
            quantity=rule.quantity,
            pantograph=owner or None,
            lower=lower,
            upper=upper,
            trust=rule.trust,
            source=self._source(rule, compared),
            note=rule.note,
        )

    def _limit_uncertainty(self, limit: Limit) -> float | None:
        if self.measured is None:
            return 0.0
        known = self.measured.uncertainty.list_components(limit.owner, limit.quantity)
        combined = self.measured.uncertainty.combine(limit.owner, limit.quantity)
        return combined if known and isinstance(combined, float) else None

    def _source(self, rule: Rule, compared: float | None) -> str:
        source = source_text(rule.source)
        if not rule.compares or compared is None or self.measured is None:
            return source
        unit = unit_of(rule.quantity)
        tolerance = f"{rule.tolerance:g} {unit}" if rule.tolerance else f"{rule.tolerance_pct:g} %"
        return f"{source}; tolerance {tolerance} around the measured value {compared:.4g} of {self.measured.name}"


LARGEST_TOLERANCE = 0.5
"""Largest tolerance of a user relative to the measured value: a wider one tests nothing."""

LEAST_SHARE_PCT = 1.0
"""Share that stands for a smaller measured one, such as no contact loss [%]: no tolerance is half of zero."""


def _doubt_tolerance(rule: Rule, limit: Limit) -> str | None:
    """Reason why a pass by a tolerance does not count: it is the user's own and too wide. None: it counts."""
    if not rule.compares or rule.trust != "own" or limit.lower is None or limit.upper is None:
        return None
    width, value = (limit.upper - limit.lower) / 2, abs(limit.upper + limit.lower) / 2
    if unit_of(rule.quantity) == "%":
        value = max(value, LEAST_SHARE_PCT)
    if width <= LARGEST_TOLERANCE * value or _is_published(rule):
        return None
    share = f"{100 * width / value:.3g} %" if value else "more than any share"
    return f"the own tolerance of {width:.4g} {unit_of(rule.quantity)} is {share} of the measured value"


def _is_published(rule: Rule) -> bool:
    """Whether a profile of the library states a tolerance that is as wide."""
    published = [other for name in list_profiles() for other in load_profile(name).rule]
    same = [other for other in published if other.quantity == rule.quantity]
    return any(
        (rule.tolerance is not None and (other.tolerance or 0.0) >= rule.tolerance)
        or (rule.tolerance_pct is not None and (other.tolerance_pct or 0.0) >= rule.tolerance_pct)
        for other in same
    )


def _finite_value(record: AssessedRecord, owner: int, quantity: str) -> float | None:
    value = record.values.values.get(owner, {}).get(quantity)
    return value if isinstance(value, float) and math.isfinite(value) else None
