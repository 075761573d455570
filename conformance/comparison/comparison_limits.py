"""Limits of a comparison of a model with measured values: the file of the user, and the criteria that they make."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.comparison.drop_motion import MOTION_BANDS
from pantocheck.conformance.core.criterion import (
    EVERYWHERE,
    ComparedMotion,
    ComponentName,
    Criterion,
    CriterionPlace,
    Requirement,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.near_limit import ValueErrors
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NO_TRUST,
    InputTable,
    NonNegative,
    NonNegativeList,
    NumberList,
    Positive,
    Problems,
    cross_check,
    find_wrong_bounds,
    validation_problem,
)
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.comparison_format import (
    DROP_QUANTITIES,
    RESPONSE_QUANTITIES,
    STATIC_QUANTITIES,
    ComparedQuantityName,
)

RESPONSE_BANDS: tuple[tuple[float, float], ...] = ((0.5, 5.0), (5.0, 20.0), (20.0, 50.0))
"""Bands of responses [Hz]: the frame on its springs, the head, and the bending of the head and its strips."""

TimeWindow = tuple[float, float]

LIMIT_UNITS = {"pct": "%", "deg": "°", "mm_N": "mm/N", "mm": "mm"}
"""Units in reports, by the end of the name of a quantity."""


@dataclass(frozen=True)
class LimitKind:
    """Limits of one comparison: its quantities, and the keys that their limits need or may have."""

    name: str
    quantities: Sequence[str]
    required: tuple[str, ...]
    """Keys that state the place of the limit."""
    optional: tuple[str, ...] = ()
    bands: Sequence[tuple[float, float]] = ()
    """Bands that are compared [Hz]."""


STATICS = LimitKind("static values", STATIC_QUANTITIES, ("upper",))
RESPONSES = LimitKind(
    "responses", RESPONSE_QUANTITIES, ("band_Hz", "static_forces_N", "upper"), ("heights_m",), RESPONSE_BANDS
)
DROPS = LimitKind("drops", DROP_QUANTITIES, ("sensors", "window_s", "band_Hz"), ("motion", "lower"), MOTION_BANDS)

_PLACES = ("band_Hz", "static_forces_N", "heights_m", "sensors", "motion", "window_s", "lower")
"""Keys that belong to some kinds of limits only."""


class ComparisonLimit(InputTable):
    """Bounds of the difference between a model and measured values, and the places at which they hold."""

    quantity: ComparedQuantityName
    """Of drops: RMS of the model over that of the record, or correlation of their samples; of responses: RMS
    deviation over the band of modulus, phase or both (complex), or the largest deviation.
    """
    band_Hz: Annotated[tuple[Positive, Positive] | None, Field(strict=False)] = None
    """Edges of a compared band [Hz]; of drops: 0.3-5, 5-20, 20-50 or 0.3-20; of responses: 0.5-5, 5-20 or 20-50."""
    static_forces_N: Annotated[NonNegativeList | None, Field(max_length=50)] = None
    """Static forces that must be measured [N]; one without a response is a skip."""
    heights_m: Annotated[NumberList | None, Field(max_length=50)] = None
    """Heights of the head that must be measured under each static force [m]; default: every height that was
    measured.
    """
    sensors: Annotated[
        tuple[Annotated[int, Field(ge=1)], ...] | None, Field(strict=False, min_length=1, max_length=100)
    ] = None
    """Numbers of the sensors; a sensor without a record leaves its limit open (skip)."""
    motion: ComparedMotion | None = None
    """Compared motion; default: acceleration."""
    window_s: Annotated[tuple[NonNegative, Positive] | None, Field(strict=False)] = None
    """Start and end of a compared window after the release [s]."""
    lower: Annotated[float | None, Field(ge=-1, le=1e3)] = None
    """Lower bound, in the unit of the quantity."""
    upper: Annotated[float | None, Field(ge=-1, le=1e4)] = None
    """Upper bound, in the unit of the quantity."""
    source: Annotated[str, Field(min_length=1, max_length=500)] = NO_SOURCE
    """Source of the limit."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Reason for the bounds."""

    @property
    def kind(self) -> LimitKind:
        """Comparison to which the quantity belongs."""
        return next(kind for kind in (STATICS, RESPONSES, DROPS) if self.quantity in kind.quantities)

    @cross_check
    def _check_keys(self) -> Problems:
        kind = self.kind
        for key in kind.required:
            if getattr(self, key) is None:
                yield validation_problem(key, "missing", f"A limit of {self.quantity} needs it.")
        for key in _PLACES:
            if getattr(self, key) is not None and key not in (*kind.required, *kind.optional):
                yield validation_problem(key, f"is not a key of a limit of {self.quantity}", "Remove it.")

    @cross_check
    def _check_bounds(self) -> Problems:
        yield from find_wrong_bounds(self, needs_bound=self.kind is DROPS)
        if self.upper is not None and self.kind is RESPONSES and self.upper <= 0:
            yield validation_problem("upper", f"{self.upper:g} is not positive", "Give the largest accepted deviation.")

    @cross_check
    def _check_repetitions(self) -> Problems:
        for key in ("static_forces_N", "heights_m", "sensors"):
            values = getattr(self, key) or ()
            if len(set(values)) < len(values):
                yield validation_problem(key, f"{list(values)} repeats a value", "Name each value once.")

    @cross_check
    def _check_band(self) -> Problems:
        if self.band_Hz is not None and self.kind.bands and self.band_Hz not in self.kind.bands:
            names = ", ".join(str(list(band)) for band in self.kind.bands)
            yield validation_problem("band_Hz", f"{list(self.band_Hz)} is not a compared band", f"Give one of {names}.")


class ComparisonLimits(InputTable):
    """File of the limits of a comparison."""

    schema_: Annotated[Literal["pantocheck.comparison-limits/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.comparison-limits/1"."""
    limit: Annotated[tuple[ComparisonLimit, ...], Field(strict=False, min_length=1, max_length=1000)]


def read_comparison_limits(path: Path | None, kind: LimitKind) -> tuple[ComparisonLimit, ...]:
    """Read the limits of one kind of comparison.

    Args:
        path: File of limits; None: no limits.
        kind: The kind of comparison.

    Returns:
        The limits.

    Raises:
        InputError: The file cannot be read, does not fit the format, or has a quantity of another comparison.
    """
    limits = () if path is None else read_model(path, ComparisonLimits, "limits").limit
    for number, limit in enumerate(limits, 1):
        if path is not None and limit.kind is not kind:
            raise InputError(
                f"limits '{path.name}', key limit[{number}].quantity",
                f"{limit.quantity!r} does not belong to a comparison of {kind.name}",
                f"Give one of {', '.join(kind.quantities)}.",
            )
    return limits


def unit_of_difference(quantity: str) -> str:
    """Unit of a quantity in reports; empty for a ratio."""
    return next((unit for end, unit in LIMIT_UNITS.items() if quantity.endswith(f"_{end}")), "")


def grade_difference(
    limit: ComparisonLimit,
    value: float | None,
    where: CriterionPlace = EVERYWHERE,
    *,
    missing: str | None,
    discretisation: float | None = None,
    measurement: float | None = None,
    place: str = "",
    source: str = "",
) -> Criterion:
    """Grade a difference by a limit at one of its places. The limits of the user always count.

    Args:
        limit: The limit.
        value: Graded value, in the unit of the quantity; None if there is none.
        where: Place of the value.
        missing: Data that the criterion needs and the record does not have; None if it is complete.
        discretisation: Change of the value with a finer mesh, which widens the value; None if it is not known.
        measurement: Half-width of the 95 % interval by the measurement, which widens the limit; None if not stated.
        place: Place in words, behind the distance beyond the limit.
        source: Source of the limit in the report.
    """
    requirement = Requirement(
        quantity=limit.quantity,
        pantograph=LINE,
        where=where,
        unit=unit_of_difference(limit.quantity),
        lower=limit.lower,
        upper=limit.upper,
        trust=NO_TRUST,
        source=source,
    )
    components: dict[ComponentName, float] = {} if discretisation is None else {"discretisation": discretisation}
    errors = ValueErrors(components=components, limit_uncertainty=measurement)
    return build_criterion(requirement, value, missing, NO_TRUST, errors, place)
