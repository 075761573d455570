"""Limits: a quantity, its bounds, and who says so."""

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from pantocheck.conformance.input_files.sourced_table import InputTable, validation_problem
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.registry import QUANTITIES

FiniteBound = Annotated[float, Field(ge=-1e12, le=1e12)]


class Limit(InputTable):
    """Bounds of one quantity; a quantity of the line or of a static check belongs to no pantograph."""

    quantity: Annotated[str, Field(description="name of a quantity", json_schema_extra={"enum": list(QUANTITIES)})]
    pantograph: Annotated[
        int | None,
        Field(ge=1, le=20, description="number in running order; left out: the first, or none for a line quantity"),
    ] = None
    item: Annotated[
        int | None, Field(ge=1, description="which one of a list-valued quantity (dropper, mode), from 1")
    ] = None
    lower: Annotated[
        FiniteBound | None, Field(description="smallest value that passes, in the unit of the quantity")
    ] = None
    upper: Annotated[
        FiniteBound | None, Field(description="largest value that passes, in the unit of the quantity")
    ] = None
    trust: Annotated[Trust, Field(description="how far the limit can be trusted")]
    source: Annotated[str | list[str], Field(description="where it was read: keys of sources.toml, or free text")]
    note: Annotated[str | None, Field(description="what a reader should know about it", max_length=4000)] = None

    @field_validator("quantity")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in QUANTITIES:
            raise validation_problem("", f"there is no quantity {name!r}", suggest_names(name, list(QUANTITIES)))
        return name

    @model_validator(mode="after")
    def _consistent(self) -> "Limit":
        if self.lower is None and self.upper is None:
            raise validation_problem("", "a limit without a lower and an upper bound", "Give lower, upper or both.")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise validation_problem("lower", f"{self.lower:g} is above upper = {self.upper:g}", "Exchange them.")
        if QUANTITIES[self.quantity].scope != "pantograph" and self.pantograph is not None:
            raise validation_problem(
                "pantograph", f"{self.quantity} belongs to the line, not to a pantograph", "Leave pantograph out."
            )
        return self

    @property
    def owner(self) -> int:
        """Number of the pantograph that the limit is for, from 1; 0 for the line."""
        if QUANTITIES[self.quantity].scope != "pantograph":
            return 0
        return self.pantograph or 1

    @property
    def target(self) -> tuple[str, int, int | None]:
        """What is limited; a limit for the same target replaces another."""
        return self.quantity, self.owner, self.item


class LimitOverride(Limit):
    """A limit that a user lays over cases."""

    case: Annotated[str, Field(description="id or glob of the cases it is for", max_length=200)] = "*"


class LimitsFile(InputTable):
    """A file of a user's own limits, for `--limits`."""

    limit: Annotated[tuple[LimitOverride, ...], Field(strict=False, min_length=1, max_length=10_000)]
