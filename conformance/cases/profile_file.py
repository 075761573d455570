"""Profiles: rules for the assessment of a record without a case, for example for the acceptance of a line."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.cases.limits import QuantityName, own_source
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NO_TRUST,
    InputTable,
    Problems,
    cross_check,
    find_missing_source,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.trust import LimitTrust
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.sidecar_tables import EventKind


class SpeedFormula(InputTable):
    """Bound as a function of the speed v [km/h]: per_speed_squared v^2 + constant."""

    per_speed_squared: Annotated[float, Field(ge=-1e6, le=1e6)]
    """Factor of v^2, in the unit of the quantity per (km/h)^2."""
    constant: Annotated[float, Field(ge=-1e9, le=1e9)]
    """Bound at speed 0, in the unit of the quantity."""
    above_km_h: Annotated[float | None, Field(ge=0)] = None
    """Speed above which the formula is valid [km/h]; default: every speed."""

    def at(self, speed_km_h: float) -> float:
        """Bound at a speed [km/h]."""
        return self.per_speed_squared * speed_km_h**2 + self.constant


class NamedBound(InputTable):
    """Bound from the record: the value of a key of its `line` table, times a factor."""

    given: Literal["uplift_space_mm"]
    """Key of the table [line] of the record."""
    factor: Annotated[float, Field(gt=0, le=100)] = 1.0
    """Factor on the value of this key [-]."""


def _kind_of_bound(bound: object) -> str:
    """Kind of a bound, which pydantic validates and reports alone."""
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
    """Bounds of one quantity for every pantograph: stated bounds, or a tolerance on the measured value."""

    quantity: QuantityName
    lower: RuleBound | None = None
    """Lower bound: number, formula or key of the record."""
    upper: RuleBound | None = None
    """Upper bound: number, formula or key of the record."""
    tolerance: Tolerance | None = None
    """Largest difference from the measured value, in the unit of the quantity."""
    tolerance_pct: Tolerance | None = None
    """Largest difference from the measured value, relative to it [%]."""
    trust: LimitTrust = NO_TRUST
    """Trust in the rule."""
    source: str | list[str] = NO_SOURCE
    """Source of the rule: keys of sources.toml, or free text."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""

    @cross_check
    def _consistent(self) -> Problems:
        yield from find_missing_source(self.trust, self.source)
        if self.quantity in QUANTITIES and QUANTITIES[self.quantity].scope == "mass_drop":
            yield validation_problem(
                "quantity", f"{self.quantity} is not a quantity of a run", "Give a quantity of a contact-force record."
            )
        stated = self.lower is not None or self.upper is not None
        kinds = stated + (self.tolerance is not None) + (self.tolerance_pct is not None)
        if kinds != 1:
            yield validation_problem(
                "",
                f"the rule for {self.quantity} has {'several kinds of bounds' if kinds else 'no bound'}",
                "Give one kind: lower and upper, tolerance or tolerance_pct.",
            )

    @property
    def compares(self) -> bool:
        """Whether the bounds are a tolerance on the value of a measured record."""
        return self.tolerance is not None or self.tolerance_pct is not None


class ExclusionRule(InputTable):
    """Stretches of the line that a measured record may leave out of the statistics of the contact force."""

    kinds: Annotated[tuple[EventKind, ...], Field(strict=False, min_length=1)]
    """Kinds of events that may be left out."""
    largest_share_pct: Annotated[float, Field(gt=0, le=50)]
    """Largest share of the analysis section that may be left out [%]."""


class Profile(InputTable):
    """Rules for the assessment of a record."""

    schema_: Annotated[Literal["pantocheck.profile/1"], Field(alias="schema")]
    """Version of the format."""
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]+$", max_length=100)]
    """Name of the profile."""
    title: Annotated[str, Field(max_length=200)]
    """Title in reports."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""
    speed_tolerance_pct: Annotated[float, Field(gt=0, le=50)] = 5.0
    """Largest deviation from the nominal speed inside the analysis section [%]."""
    verification: Literal["shown", "demanded"] = "shown"
    """Use of the state of the record (consistent or unconfirmed); demanded: an unconfirmed record does not pass; shown:
    the report shows the state.
    """
    shortest_contact_loss_s: Annotated[float | None, Field(exclude_if=is_absent, gt=0, le=10)] = None
    """Shortest contact loss that counts for long_contact_loss_pct [s]."""
    exclusion: Annotated[ExclusionRule | None, Field(exclude_if=is_absent)] = None
    """Stretches that may be left out; default: none."""
    filter: Filter = Filter()
    rule: Annotated[tuple[Rule, ...], Field(strict=False, min_length=1, max_length=1000)]

    @property
    def compares(self) -> bool:
        """Whether a rule of the profile needs a measured record for comparison."""
        return any(rule.compares for rule in self.rule)


class BoundMissing(ValueError):
    """Bound missing for a record; an assumed bound would be a limit without a source."""


def resolve_bounds(
    rule: Rule, speed_km_h: float, line_values: Mapping[str, float | None], measured: float | None
) -> tuple[float | None, float | None]:
    """Lower and upper bound of a rule for a record.

    Args:
        rule: Rule of a profile.
        speed_km_h: Speed of the record [km/h].
        line_values: Line table of the record, by key.
        measured: Value of the measured record, for a rule with a tolerance.

    Returns:
        Lower and upper bound, in the unit of the quantity.

    Raises:
        BoundMissing: The formula is not valid at the speed, a value is missing, or the lower bound is above the upper
            bound.
    """
    if rule.compares:
        if measured is None:
            raise BoundMissing("the measured record does not have this quantity")
        tolerance = rule.tolerance or abs(measured) * (rule.tolerance_pct or 0.0) / 100
        return measured - tolerance, measured + tolerance
    lower, upper = (_resolve_bound(bound, speed_km_h, line_values) for bound in (rule.lower, rule.upper))
    if lower is not None and upper is not None and lower > upper:
        raise BoundMissing(f"the lower bound of the rule, {lower:g}, is above its upper bound, {upper:g}")
    return lower, upper


def _resolve_bound(bound: RuleBound | None, speed_km_h: float, line_values: Mapping[str, float | None]) -> float | None:
    if isinstance(bound, SpeedFormula):
        if bound.above_km_h is not None and speed_km_h <= bound.above_km_h:
            raise BoundMissing(
                f"the speed of the record is {speed_km_h:g} km/h; the rule is valid above {bound.above_km_h:g} km/h"
            )
        return bound.at(speed_km_h)
    if isinstance(bound, NamedBound):
        if (value := line_values.get(bound.given)) is None:
            raise BoundMissing(f"the record does not state {bound.given} in its table [line]")
        return bound.factor * value
    return bound


def list_profiles() -> dict[str, Path]:
    """Files of the profiles of the library, by name."""
    return {path.stem: path for path in sorted((library_folder() / "profiles").glob("*.toml"))}


def own_rules(rules: Iterable[Rule], published: Sequence[Rule]) -> tuple[Rule, ...]:
    """Rules of a user with the trust `own`, whatever they claim; one that the library states remains as it is."""
    return tuple(
        rule
        if any(rule == other.model_copy(update={"note": rule.note}) for other in published)
        else rule.model_copy(update={"trust": "own", "source": own_source(rule.source)})
        for rule in rules
    )


UNREAD = ("tsi", "50367", "50119")
"""Parts of names of documents; none of their rules was read in print."""

UNREAD_HINT = (
    "No rule of this document was read in print. acceptance-ac, acceptance-dc-3kv and acceptance-dc-1500v have the "
    "rules of secondary sources, which name no document. Write the rules of your copy into a file such as mine.toml, "
    f"and give --profile mine.toml; {DocumentationPage.RECORDS} shows one."
)


def load_profile(name: str) -> Profile:
    """Read a profile of the library by name, or a profile file by its path, which ends in .toml.

    Raises:
        InputError: The library has no profile of this name, or the file is invalid.
    """
    known = list_profiles()
    if name.endswith(".toml"):
        profile = read_model(Path(name), Profile, "profile")
        published = load_profile(profile.name).rule if profile.name in known else ()
        return profile.model_copy(update={"rule": own_rules(profile.rule, published)})
    if name not in known:
        hint = UNREAD_HINT if any(part in name.lower() for part in UNREAD) else suggest_names(name, list(known))
        raise InputError(f"profile '{name}'", "there is no profile with this name", hint)
    return read_model(known[name], Profile, "profile")
