"""Criterion: a value against its limits, with the components of its uncertainty, in results.json and in comparisons."""

from collections.abc import Iterable
from typing import Annotated, Literal, Self, get_args

from pydantic import Field, model_validator

from pantocheck.conformance.core.findings import GradedFinding, PublishedFinding
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart
from pantocheck.conformance.core.sourced_table import NonNegative
from pantocheck.conformance.core.trust import Computed, LimitTrust
from pantocheck.conformance.core.verdicts import Verdict, judge_parts, worst_verdict

BASELINE = "baseline"
"""Quantity of a criterion that states why a comparison with a baseline is impossible."""

ComponentName = Literal["discretisation", "start", "section", "length", "sampling", "resolution", "line", "alignment"]
"""Component of an uncertainty: mesh and time step; start and run-in; place of the analysis section; length, sampling
rate and resolution of the record; line as measured; clocks of the sources of a record, missing for a single one.
"""

COMPONENT_NAMES: tuple[ComponentName, ...] = get_args(ComponentName)


ComparedMotion = Literal["velocity", "acceleration"]

LimitTarget = tuple[str, int, int | None]
"""Quantity, pantograph (0: the line) and item (None: the only one, or the first) of a limit."""


class CriterionPlace(ResultsPart):
    """Place of a value that is compared with a measured one; a key that does not apply is null."""

    record: str | None = None
    """Name of the table of a response; null: no such response."""
    static_force_N: FiniteNumber | None = None
    height_m: FiniteNumber | None = None
    sensor: int | None = None
    motion: ComparedMotion | None = None
    window_s: tuple[FiniteNumber, FiniteNumber] | None = None
    band_Hz: tuple[FiniteNumber, FiniteNumber] | None = None


EVERYWHERE = CriterionPlace()
"""A value without such a place."""


class Requirement(ResultsPart):
    """Limits of one number, whichever table states them: of a case, profile, comparison, dossier or baseline."""

    quantity: str
    """Name of the quantity, of a difference, or of a parameter."""
    pantograph: int
    """Number of the pantograph; 0: the line."""
    item: int | None = None
    """Number among several values (dropper, mode), from 1."""
    where: Annotated[CriterionPlace, Field(exclude_if=lambda place: place == EVERYWHERE)] = EVERYWHERE
    """Place of a compared value; left out of the file if there is none."""
    unit: str
    lower: FiniteNumber | None
    upper: FiniteNumber | None
    """Limits in the unit; both null if they are not known."""
    trust: LimitTrust | Computed | None
    """Trust of the limits; null: the bounds are values of a baseline, without a published source."""
    source: str
    """Source of the limits."""
    baseline: float | None = None
    """Earlier value, if the limits bound the drift from it."""
    finding: PublishedFinding | None = None
    """Finding of a publication that the limits grade; null: none."""

    @property
    def target(self) -> LimitTarget:
        """Quantity, pantograph and item."""
        return self.quantity, self.pantograph, self.item


class Criterion(Requirement):
    """A value against its limits."""

    value: FiniteNumber | None
    verdict: Verdict
    margin: float | None
    discretisation_error: NonNegative | None
    """Change when element length and time step are halved."""
    spread: NonNegative | None = None
    """Largest change when the analysis section is shifted span by span; it is not part of `uncertainty`."""
    reason: str | None
    """Data that are missing, or distance beyond a limit."""
    uncertainty: NonNegative | None = None
    """Half-width of the 95 % interval: it holds 95 % of the joint sample of all components."""
    conformity: Annotated[float | None, Field(ge=0, le=1)] = None
    """Probability that the value lies inside its limits, from `draws`; null: not known."""
    draws: Annotated[list[FiniteNumber], Field(exclude_if=lambda draws: not draws)] = []
    """Joint sample of the value; draws of the same number belong together in all criteria of a case. Missing: none."""
    components: dict[ComponentName, NonNegative] = {}
    limit_uncertainty: NonNegative | None = 0.0
    """Half-width of the 95 % interval of a limit from a measured record; null: the record states none."""
    close: list[str] = []
    """Remark on a value whose `uncertainty` and `limit_uncertainty` combined exceed its distance from a limit."""
    readings: Annotated[list[str], Field(exclude_if=lambda remarks: not remarks)] = []
    """Remarks on the documented readings and contacts under which the value lies on the other side of a limit."""
    finding: GradedFinding | None = None
    doubt: Annotated[str | None, Field(exclude_if=lambda text: text is None)] = None
    """Reason why a pass does not count: the user widened a limit of the library, or chose a tolerance that tests
    nothing. Missing: it counts.
    """

    @property
    def is_drift(self) -> bool:
        """Whether the criterion compares with a baseline, or states that a comparison is impossible."""
        return self.baseline is not None or self.quantity == BASELINE

    @property
    def is_close(self) -> bool:
        """Whether a counted value is closer to a limit than its uncertainty, so that its verdict could be reversed."""
        return bool(self.close) and self.verdict in ("pass", "undecided", "fail")

    @property
    def depends_on_reading(self) -> bool:
        """Whether another documented reading or contact would reverse the verdict of a counted value."""
        return bool(self.readings) and self.verdict in ("pass", "fail")

    @property
    def error(self) -> float | None:
        """Uncertainty of the value or, where it is not known, its discretisation error."""
        return self.discretisation_error if self.uncertainty is None else self.uncertainty

    @model_validator(mode="after")
    def _demand_trust(self) -> Self:
        if self.trust is None and not self.is_drift:
            raise ValueError("a criterion without trust must compare with a baseline")
        return self


def judge_criteria(criteria: Iterable[Criterion]) -> Verdict:
    """Worst of the criteria that count; at best `info` where a pass does not count."""
    rows = list(criteria)
    verdict = judge_parts(row.verdict for row in rows)
    return worst_verdict([verdict, "info"]) if any(row.doubt is not None for row in rows) else verdict


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
