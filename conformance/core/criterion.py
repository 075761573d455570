"""Criterion of results.json: a value against its limits, with the components of its uncertainty."""

from typing import Literal, Self, get_args

from pydantic import model_validator

from pantocheck.conformance.core.findings import GradedFinding
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart
from pantocheck.conformance.core.trust import Computed, Trust
from pantocheck.conformance.core.verdicts import Verdict

BASELINE = "baseline"
"""Quantity of a criterion that states why a comparison with a baseline is impossible."""

ComponentName = Literal["discretisation", "start", "section", "length"]
"""Component of an uncertainty: mesh and time step; start and run-in; place of the analysis section; record length."""

COMPONENT_NAMES: tuple[ComponentName, ...] = get_args(ComponentName)


class Criterion(ResultsPart):
    """A value against its limits. `pantograph` is 0 for the line; `item` counts droppers or modes from 1.

    `discretisation_error` is the change when element length and time step are halved. `spread` is the largest change
    when the analysis section is shifted span by span; it is not part of `uncertainty`. `uncertainty` is the half-width
    of the 95 % interval, the root of the sum of squares of `components`; before `components` existed, it was that from
    the length of the record.
    `limit_uncertainty` is that of a limit from a measured record. `close` has a remark if both combined exceed the
    distance from the nearer limit.
    `baseline` is the value of earlier results, if the limits bound the drift from it.
    """

    quantity: str
    pantograph: int
    item: int | None = None
    value: FiniteNumber | None
    unit: str
    lower: FiniteNumber | None
    upper: FiniteNumber | None
    verdict: Verdict
    trust: Trust | Computed | None
    """Trust of the limits; null: the bounds are values of a baseline, without a published source."""
    source: str
    margin: float | None
    discretisation_error: float | None
    spread: float | None = None
    reason: str | None
    uncertainty: float | None = None
    components: dict[ComponentName, float] = {}
    limit_uncertainty: float = 0.0
    close: list[str] = []
    baseline: float | None = None
    finding: GradedFinding | None = None
    """Finding of a publication that the limits grade; null: none."""

    @property
    def is_drift(self) -> bool:
        """Whether the criterion compares with a baseline, or states that a comparison is impossible."""
        return self.baseline is not None or self.quantity == BASELINE

    @property
    def is_close(self) -> bool:
        """Whether a counted value is closer to a limit than its uncertainty, so that its verdict could be reversed."""
        return bool(self.close) and self.verdict in ("pass", "fail")

    @property
    def error(self) -> float | None:
        """Uncertainty of the value or, where it is not known, its discretisation error."""
        return self.discretisation_error if self.uncertainty is None else self.uncertainty

    @model_validator(mode="after")
    def _demand_trust(self) -> Self:
        if self.trust is None and not self.is_drift:
            raise ValueError("a criterion without trust must compare with a baseline")
        return self


class CaseVerification(ResultsPart):
    """Comparison with the converged solution of the same equations, up to 50 Hz.

    The limits of its criteria are computed: they never decide the verdict by the EN 50318 criteria.
    """

    verdict: Verdict
    reason: str | None
    """Reason why there are no criteria."""
    confirmed_by: str
    """Second formulation that confirms the converged values."""
    digest: str
    """SHA-256 of the converged values and of the tolerances."""
    omitted: list[str]
    """Quantities without a confirmed value, with the reason."""
    criteria: list[Criterion]
