"""Profiles: rules by which a record is assessed without a case, as data: acceptance of a line, or a line test."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from pantocheck.conformance.cases.case_file import Filter
from pantocheck.conformance.cases.library import library_folder
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.sourced_table import InputTable, validation_problem
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.quantities.registry import QUANTITIES

PROFILE_SCHEMA = "pantocheck.profile/1"


class SpeedFormula(InputTable):
    """A bound that follows the speed v [km/h]: per_speed_squared v^2 + constant."""

    per_speed_squared: Annotated[
        float, Field(ge=-1e6, le=1e6, description="factor of v^2, in the unit of the quantity per (km/h)^2")
    ]
    constant: Annotated[float, Field(ge=-1e9, le=1e9, description="bound at rest, in the unit of the quantity")]
    above_km_h: Annotated[float | None, Field(ge=0, description="the formula holds above this speed")] = None

    def at(self, speed_km_h: float) -> float:
        """The bound at a speed."""
        return self.per_speed_squared * speed_km_h**2 + self.constant


class NamedBound(InputTable):
    """A bound that comes with the record: a key of its `line` table, times a factor."""

    given: Annotated[Literal["uplift_space_mm"], Field(description="key of the record's line table")]
    factor: Annotated[float, Field(gt=0, le=100, description="what it is multiplied by")] = 1.0


def _kind_of_bound(bound: object) -> str:
    """Which bound a file means: only that one is then checked, and complained of."""
    if isinstance(bound, SpeedFormula | NamedBound):
        return type(bound).__name__
    if isinstance(bound, dict):
        return "NamedBound" if "given" in bound else "SpeedFormula"
    return "number"


RuleBound = Annotated[
    Annotated[float, Field(ge=-1e9, le=1e9), Tag("number")]
    | Annotated[SpeedFormula, Tag("SpeedFormula")]
    | Annotated[NamedBound, Tag("NamedBound")],
    Discriminator(_kind_of_bound),
]
Tolerance = Annotated[float, Field(gt=0, le=1e9)]


class Rule(InputTable):
    """Bounds of one quantity, for every pantograph: stated, or around the value of a measured record."""

    quantity: Annotated[str, Field(description="name of a quantity", json_schema_extra={"enum": list(QUANTITIES)})]
    lower: Annotated[RuleBound | None, Field(description="smallest value that passes, or a formula")] = None
    upper: Annotated[RuleBound | None, Field(description="largest value that passes, or a formula")] = None
    tolerance: Annotated[
        Tolerance | None, Field(description="how far off the measured value it may be, in the unit of the quantity")
    ] = None
    tolerance_pct: Annotated[Tolerance | None, Field(description="the same in percent of the measured value")] = None
    need: Annotated[
        Literal["required", "if_known"],
        Field(description="required: without the quantity or its bound the verdict is skip; if_known: it is left out"),
    ] = "required"
    trust: Annotated[Trust, Field(description="how far the rule can be trusted")]
    source: Annotated[str | list[str], Field(description="where it was read: keys of sources.toml, or free text")]
    note: Annotated[str | None, Field(description="what a reader should know about it", max_length=4000)] = None

    @model_validator(mode="after")
    def _consistent(self) -> "Rule":
        if self.quantity not in QUANTITIES:
            raise validation_problem(
                "quantity",
                f"there is no quantity {self.quantity[:80]!r}",
                suggest_names(self.quantity[:80], list(QUANTITIES)),
            )
        if QUANTITIES[self.quantity].scope == "mass_drop":
            raise validation_problem("quantity", f"{self.quantity} is not of a run", "Choose another quantity.")
        stated = self.lower is not None or self.upper is not None
        if stated + (self.tolerance is not None) + (self.tolerance_pct is not None) != 1:
            raise validation_problem(
                "",
                f"{self.quantity} has not exactly one kind of bound",
                "Give lower/upper, tolerance or tolerance_pct.",
            )
        return self

    @property
    def compares(self) -> bool:
        """Whether the bounds are taken from a measured record."""
        return self.tolerance is not None or self.tolerance_pct is not None


class Profile(InputTable):
    """Rules for a record."""

    schema_: Annotated[Literal["pantocheck.profile/1"], Field(alias="schema", description="version of the format")]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]+$", max_length=100, description="what it is called")]
    title: Annotated[str, Field(max_length=200, description="what it is")]
    note: Annotated[str | None, Field(description="what a reader should know about it", max_length=4000)] = None
    speed_tolerance_pct: Annotated[
        float, Field(gt=0, le=50, description="where the speed is farther off the nominal one, the record is cut [%]")
    ] = 5.0
    filter: Filter = Filter()
    rule: Annotated[tuple[Rule, ...], Field(strict=False, min_length=1, max_length=1000)]

    @property
    def compares(self) -> bool:
        """Whether a measured record is needed to compare with."""
        return any(rule.compares for rule in self.rule)


class BoundMissing(ValueError):
    """A rule has no bound for this record: guessed, it would be a limit that nobody stated."""


def resolve_bounds(
    rule: Rule, speed_km_h: float, given: Mapping[str, float | None], measured: float | None
) -> tuple[float | None, float | None]:
    """Lower and upper limit of a rule for a record.

    Parameters
    ----------
    rule : Rule
        To be resolved.
    speed_km_h : float
        Of the record [km/h].
    given : Mapping[str, float or None]
        What the record says of its line, by key.
    measured : float or None
        Value of the measured record, for a rule that compares.

    Raises
    ------
    NoBound
        The speed is out of the formula's range, what the bound refers to is not known, or nothing lies between.
    """
    if rule.compares:
        if measured is None:
            raise BoundMissing("the measured record has no such quantity")
        reach = rule.tolerance or abs(measured) * (rule.tolerance_pct or 0.0) / 100
        return measured - reach, measured + reach
    lower, upper = (_resolved(bound, speed_km_h, given) for bound in (rule.lower, rule.upper))
    if lower is not None and upper is not None and lower > upper:
        raise BoundMissing(f"its lower bound of {lower:g} lies above its upper bound of {upper:g}")
    return lower, upper


def _resolved(bound: RuleBound | None, speed_km_h: float, given: Mapping[str, float | None]) -> float | None:
    if isinstance(bound, SpeedFormula):
        if bound.above_km_h is not None and speed_km_h <= bound.above_km_h:
            raise BoundMissing(f"the rule holds above {bound.above_km_h:g} km/h, the record is of {speed_km_h:g} km/h")
        value = bound.at(speed_km_h)
    elif isinstance(bound, NamedBound):
        known = given.get(bound.given)
        if known is None:
            raise BoundMissing(f"the record does not give {bound.given}")
        value = bound.factor * known
    else:
        return bound
    return value


def load_profile(name: str) -> Profile:
    """A profile of the library, or of a user's own file (a name that ends in .toml).

    Raises
    ------
    InputError
        There is no such profile, or it is wrong.
    """
    if name.endswith(".toml"):
        return read_model(Path(name), Profile, "profile")
    known = {path.stem: path for path in sorted((library_folder() / "profiles").glob("*.toml"))}
    if name not in known:
        raise InputError(f"profile '{name}'", "there is no such profile", suggest_names(name, list(known)))
    return read_model(known[name], Profile, "profile")
