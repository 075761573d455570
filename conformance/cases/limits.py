"""Limits: a quantity, its bounds and their source."""

from collections.abc import Iterable
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field

from pantocheck.conformance.core.criterion import LimitTarget
from pantocheck.conformance.core.findings import PublishedFinding
from pantocheck.conformance.core.input_error import suggest_names
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NO_TRUST,
    InputTable,
    Problems,
    cross_check,
    find_missing_source,
    find_wrong_bounds,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.core.trust import LimitTrust
from pantocheck.conformance.quantities.registry import QUANTITIES

FiniteBound = Annotated[float, Field(ge=-1e12, le=1e12)]


def _check_quantity(name: str) -> str:
    if name not in QUANTITIES:
        raise validation_problem("", f"there is no quantity {name[:80]!r}", suggest_names(name[:80], list(QUANTITIES)))
    return name


QuantityName = Annotated[
    str,
    AfterValidator(_check_quantity),
    Field(description="name of a quantity", json_schema_extra={"enum": list(QUANTITIES)}),
]
"""Name of a quantity."""


def is_per_pantograph(name: str) -> bool:
    """Whether a quantity has one value for each pantograph."""
    return QUANTITIES[name].scope == "pantograph"


class Limit(InputTable):
    """Bounds of a quantity; a quantity of the line or of a static check has no pantograph."""

    quantity: QuantityName
    pantograph: Annotated[int | None, Field(ge=1, le=20)] = None
    """Number of the pantograph in running order; default: every pantograph; none for a quantity of the line."""
    item: Annotated[int | None, Field(ge=1)] = None
    """Number of the value in a quantity with several values (droppers, modes), from 1."""
    lower: FiniteBound | None = None
    """Lower bound, in the unit of the quantity."""
    upper: FiniteBound | None = None
    """Upper bound, in the unit of the quantity."""
    trust: LimitTrust = NO_TRUST
    """Trust in the limit."""
    source: str | list[str] = NO_SOURCE
    """Source of the limit: keys of sources.toml, or free text."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""
    finding: Annotated[PublishedFinding | None, Field(exclude_if=is_absent)] = None
    """Finding of a publication that this limit grades."""

    @cross_check
    def _consistent(self) -> Problems:
        yield from find_missing_source(self.trust, self.source)
        yield from find_wrong_bounds(self)
        if not is_per_pantograph(self.quantity) and self.pantograph is not None:
            yield validation_problem(
                "pantograph", f"{self.quantity} is not a quantity of a pantograph", "Leave the key pantograph out."
            )

    @property
    def owner(self) -> int:
        """Number of the pantograph of this limit, from 1; 0 for the line. A limit of every pantograph counts as 1."""
        if not is_per_pantograph(self.quantity):
            return 0
        return self.pantograph or 1

    @property
    def is_imposed(self) -> bool:
        """Whether the limit grades an imposed finding."""
        return self.finding is not None and self.finding.role == "imposed"

    @property
    def target(self) -> LimitTarget:
        """Quantity, pantograph and item of this limit; a later limit with the same target replaces it."""
        return self.quantity, self.owner, self.item


AnyLimit = TypeVar("AnyLimit", bound=Limit)

OWN_LIMIT = "own limit"
"""First source of a limit of the user; the sources that it names follow."""


def own_source(source: str | list[str]) -> list[str]:
    """Sources of a limit or tolerance of the user: first that it is own, then those that it names."""
    named = [source] if isinstance(source, str) else source
    return [OWN_LIMIT, *(text for text in named if text not in (NO_SOURCE, OWN_LIMIT))]


def own_limits(limits: Iterable[AnyLimit], library: Iterable[Limit] = ()) -> tuple[AnyLimit, ...]:
    """Limits of a user with the trust `own`, whatever they claim; those that the library states remain as they are.

    Args:
        limits: Limits of a user.
        library: Limits of the library for the same case.
    """
    published = [_content(limit) for limit in library]
    return tuple(
        limit
        if _content(limit) in published
        else limit.model_copy(update={"trust": "own", "source": own_source(limit.source)})
        for limit in limits
    )


def _content(limit: Limit) -> tuple[object, ...]:
    return limit.target, limit.lower, limit.upper, limit.trust, limit.source, limit.is_imposed


def repeat_limits(limits: Iterable[AnyLimit], pantographs: int) -> tuple[AnyLimit, ...]:
    """Give every pantograph of a train its own copy of each limit that names no pantograph.

    A limit that names its pantograph takes precedence. Without copies, a limit would judge the first pantograph alone,
    although the rear one usually has the larger standard deviation.

    Args:
        limits: Limits of a case, a record or a user.
        pantographs: Number of pantographs.

    Returns:
        Limits; with two or more pantographs, each limit of a pantograph names it.
    """
    limits = tuple(limits)
    if pantographs < 2:
        return limits
    named = {limit.target for limit in limits if limit.pantograph is not None}
    spread: list[AnyLimit] = []
    for limit in limits:
        if limit.pantograph is not None or limit.owner == 0:
            spread.append(limit)
            continue
        copies = (limit.model_copy(update={"pantograph": number}) for number in range(1, pantographs + 1))
        spread += [copy for copy in copies if copy.target not in named]
    return tuple(spread)


class LimitOverride(Limit):
    """Limit of a user for selected cases."""

    case: Annotated[str, Field(max_length=200)] = "*"
    """Id of the case, or pattern with * and ?"""


class LimitsFile(InputTable):
    """File with the limits of a user, for `--limits`."""

    limit: Annotated[tuple[LimitOverride, ...], Field(strict=False, min_length=1, max_length=10_000)]
