"""Pantograph files: a chain of lumped masses from the base to the head."""

from typing import Annotated, Literal

from pantocheck.conformance.cases.base import (
    NonNegativeList,
    Positive,
    PositiveList,
    Sourced,
    Table,
    problem,
)
from pydantic import Field, model_validator


class Contact(Sourced):
    """Contact between the head and the contact wire: a one-sided penalty spring."""

    stiffness_N_m: Annotated[Positive, Field(le=1e8, description="stiffness of the contact [N/m]")]


class Chain(Sourced):
    """Lumped masses numbered from the base upwards; spring and damper i join mass i to mass i - 1 (1: to the base)."""

    names: Annotated[
        tuple[str, ...] | None,
        Field(strict=False, description="what the masses are called, e.g. frame and head"),
    ] = None
    masses_kg: Annotated[PositiveList, Field(max_length=20, description="lumped masses, base to head [kg]")]
    stiffness_N_m: Annotated[NonNegativeList, Field(max_length=20, description="springs, base to head [N/m]")]
    damping_N_s_m: Annotated[NonNegativeList, Field(max_length=20, description="dampers, base to head [N s/m]")]

    uplift_force_on: Annotated[
        int | str, Field(description="mass the uplift force acts on: its number from the base, or its name")
    ] = 1
    base_spring_unstretched: Annotated[
        Literal["working_height", "wire_height"],
        Field(
            description="height at which the spring to the base carries nothing: the static working height (the static "
            "contact force is then the uplift force) or the nominal height of the wire"
        ),
    ] = "working_height"

    @model_validator(mode="after")
    def _same_length(self) -> "Chain":
        n = len(self.masses_kg)
        for key in ("stiffness_N_m", "damping_N_s_m", "names"):
            value = getattr(self, key)
            if value is not None and len(value) != n:
                raise problem(key, f"{len(value)} values for {n} masses", "Give one value per mass, base to head.")
        return self

    @model_validator(mode="after")
    def _force_has_a_mass(self) -> "Chain":
        on, names = self.uplift_force_on, self.names or ()
        if isinstance(on, str) and on not in names:
            raise problem("uplift_force_on", f"no mass is called {on!r}", f"Names are: {', '.join(names) or 'none'}.")
        if isinstance(on, int) and not 1 <= on <= len(self.masses_kg):
            raise problem(
                "uplift_force_on", f"there is no mass {on}", f"Masses are numbered 1 to {len(self.masses_kg)}."
            )
        return self

    @property
    def uplift_mass(self) -> int:
        """Index from 0, base to head, of the mass the uplift force acts on."""
        if isinstance(self.uplift_force_on, str):
            return (self.names or ()).index(self.uplift_force_on)
        return self.uplift_force_on - 1


class Pantograph(Table):
    """A pantograph as simulators take it."""

    title: Annotated[str, Field(description="what it is", max_length=200)]
    chain: Chain
    contact: Contact
    note: Annotated[str | None, Field(description="why a choice is what it is", max_length=4000)] = None
