"""Variation of a line after it was built: temperature, and tolerances of tensions and dropper lengths."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import Feature
from pantocheck.conformance.input_files.sourced_table import InputTable, SourcedTable, is_absent, validation_problem

VARIATION = Feature("variation")

LengthChange = Annotated[float, Field(ge=-0.2, le=0.2)]


class WireVariation(InputTable):
    """Change of the tension of a wire after the line was built."""

    ends: Annotated[
        Literal["weight", "anchor"],
        Field(
            description="weight: the tension does not depend on the temperature; anchor: both ends are rigid anchors, "
            "and the tension changes with the temperature"
        ),
        VARIATION,
    ] = "weight"
    axial_stiffness_EA_N: Annotated[
        float | None, Field(gt=0, le=1e9, description="axial stiffness EA; needed with ends = 'anchor' [N]"), VARIATION
    ] = None
    expansion_coefficient_1_K: Annotated[
        float | None,
        Field(gt=0, le=1e-4, description="thermal expansion coefficient; needed with ends = 'anchor' [1/K]"),
        VARIATION,
    ] = None
    tension_change_share: Annotated[
        float, Field(ge=-0.5, le=0.5, description="tolerance of the tension: share of it that is added [-]"), VARIATION
    ] = 0.0

    @cross_check
    def _check_anchors(self) -> Problems:
        if self.ends == "anchor":
            for key in ("axial_stiffness_EA_N", "expansion_coefficient_1_K"):
                if getattr(self, key) is None:
                    yield validation_problem(
                        key, "missing for a wire with rigid anchors", "Give it, or set ends = 'weight'."
                    )


class ListedLengthChanges(InputTable):
    """Change of the length of every dropper."""

    length_change_m: Annotated[
        tuple[Annotated[tuple[LengthChange, ...], Field(strict=False, max_length=100)], ...],
        Field(strict=False, max_length=1000, description="added lengths, one list per span in the order of x_m [m]"),
    ]


class RandomLengthChanges(InputTable):
    """Random changes of the lengths of the droppers, uniformly distributed within a tolerance."""

    tolerance_m: Annotated[float, Field(ge=0, le=0.2, description="largest change of a length [m]")]
    seed: Annotated[int, Field(ge=0, le=2**31 - 1, description="seed of the changes")]


def _form_of_changes(table: Any) -> str:
    if isinstance(table, dict):
        return "RandomLengthChanges" if "tolerance_m" in table else "ListedLengthChanges"
    return type(table).__name__


DropperVariation = Annotated[
    Annotated[ListedLengthChanges, Tag("ListedLengthChanges")]
    | Annotated[RandomLengthChanges, Tag("RandomLengthChanges")],
    Discriminator(_form_of_changes),
]


class SupportVariation(InputTable):
    """Random changes of the stagger at the supports, uniformly distributed within a tolerance."""

    stagger_tolerance_m: Annotated[
        float, Field(ge=0, le=0.5, description="largest lateral change of the contact wire at a support [m]")
    ]
    seed: Annotated[int, Field(ge=0, le=2**31 - 1, description="seed of the changes")]


class Variation(SourcedTable):
    """Variation of a line after it was built with its nominal data; its droppers keep their lengths."""

    temperature_change_K: Annotated[
        float, Field(ge=-100, le=200, description="change of the temperature of the wires [K]"), VARIATION
    ] = 0.0
    contact_wire: WireVariation = WireVariation()
    messenger_wire: WireVariation = WireVariation()
    droppers: Annotated[
        DropperVariation | None,
        Field(description="changes of the lengths of the droppers", exclude_if=is_absent),
        VARIATION,
    ] = None
    supports: Annotated[
        SupportVariation | None,
        Field(description="changes of the stagger of the contact wire", exclude_if=is_absent),
        VARIATION,
    ] = None
