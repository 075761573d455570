"""Changes along a line: stretches of a wire with other properties, and point masses."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field
from pydantic_core import PydanticCustomError

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import NO_FEATURE, Feature
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    SourcedTable,
    validation_problem,
)

Tension = Annotated[float, Field(ge=500, le=200e3, description="axial tension of one wire [N]")]
MassPerLength = Annotated[float, Field(ge=0.02, le=10, description="mass per length of one wire [kg/m]")]
BendingStiffness = Annotated[
    float, Field(ge=0, le=1e4, description="bending stiffness EI of one wire [N m2]"), Feature("bending_stiffness")
]

CHANGES = Feature("wire_changes")

MOST_CHANGES = 1000
"""Largest number of changes of a wire, and of point masses of a line."""


class WireChange(InputTable):
    """Stretch of a wire with other properties; those that are not given stay as they are."""

    from_m: Annotated[NonNegative, Field(description="start of the stretch [m]")]
    to_m: Annotated[Positive, Field(description="end of the stretch [m]")]
    tension_N: Annotated[Tension | None, CHANGES] = None
    mass_kg_m: Annotated[MassPerLength | None, CHANGES] = None
    bending_stiffness_N_m2: Annotated[BendingStiffness | None, CHANGES] = None

    @cross_check
    def _check_order(self) -> Problems:
        if self.to_m <= self.from_m:
            yield validation_problem(
                "to_m", f"{self.to_m:g} m is not after from_m = {self.from_m:g} m", "Give the end of the stretch."
            )


class ContactWireChange(WireChange):
    """Stretch of a contact wire with other properties; wear reduces mass and bending stiffness."""

    wear_share: Annotated[
        float | None,
        Field(
            ge=0,
            le=0.5,
            description="worn share of the cross-section [-]; mass and bending stiffness follow from it, unless given: "
            "the stiffness as that of a round bar worn flat from below",
        ),
        CHANGES,
    ] = None

    @cross_check
    def _check_wear(self) -> Problems:
        if self.wear_share is not None and self.mass_kg_m is not None:
            yield validation_problem(
                "mass_kg_m", "the mass of the worn wire is given twice", "Give either wear_share or mass_kg_m."
            )


class PointMassTable(SourcedTable):
    """Mass on a wire, such as a section insulator or a clamp; on parallel wires, on each of them."""

    x_m: Annotated[NonNegative, Field(description="position along the track [m]")]
    wire: Annotated[Literal["contact_wire", "messenger_wire"], Field(description="wire that carries the mass")]
    mass_kg: Annotated[float, Field(gt=0, le=200, description="mass on one wire [kg]")]
    name: Annotated[str | None, Field(description="name in reports", max_length=100), NO_FEATURE] = None


def check_changes(key: str, changes: Sequence[WireChange], length: float) -> Problems:
    """Problems of the changes of a wire: stretches outside of the line, or on top of each other.

    Parameters
    ----------
    key : str
        Dotted name of the list of changes.
    changes : sequence of WireChange
        Changes of one wire.
    length : float
        Length of the line [m].

    Yields
    ------
    PydanticCustomError
        One problem.
    """
    for number, change in enumerate(changes, 1):
        if change.to_m > length:
            yield _beyond_end(f"{key}[{number}].to_m", change.to_m, length)
    order = sorted(range(len(changes)), key=lambda n: changes[n].from_m)
    for before, after in pairwise(order):
        if changes[after].from_m < changes[before].to_m:
            yield validation_problem(
                f"{key}[{after + 1}].from_m",
                f"{changes[after].from_m:g} m lies in the stretch that ends at {changes[before].to_m:g} m",
                "Give stretches that do not overlap.",
            )


def check_point_masses(
    masses: Sequence[PointMassTable], length: float, overlaps: Sequence[tuple[float, float]]
) -> Problems:
    """Problems of the point masses of a line of a length [m] with overlaps from start to end [m, m]."""
    for number, mass in enumerate(masses, 1):
        if not 0.0 < mass.x_m < length:
            yield _beyond_end(f"point_mass[{number}].x_m", mass.x_m, length)
        for start, end in overlaps:
            if start < mass.x_m < end:
                yield validation_problem(
                    f"point_mass[{number}].x_m",
                    f"{mass.x_m:g} m lies in the overlap from {start:g} m to {end:g} m, where two sections have wires",
                    "Give a position outside of the overlaps.",
                )


def _beyond_end(key: str, position: float, length: float) -> PydanticCustomError:
    found = f"{position:g} m is not on the line, which ends at {length:g} m"
    return validation_problem(key, found, f"Give a position between 0 and {length:g} m.")
