"""Tables of studies: cases that compare several runs and grade the comparison."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from pantocheck.conformance.cases.drop_test import DampingModels, Place
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    Positive,
    PositiveList,
    SourcedTable,
    validation_problem,
)

Interval = Annotated[tuple[float, float], Field(strict=False)]


class Printed(InputTable):
    """Published values of a pantograph under a damping model, shown beside the computed values."""

    model: Annotated[str, Field(max_length=100, description="name of the damping model")]
    pantograph: Annotated[int, Field(ge=1, le=20, description="number in running order")]
    values: Annotated[dict[str, float], Field(min_length=1, max_length=50, description="values by name of quantity")]


class DampingChange(SourcedTable):
    """Change of a passage from an earlier damping to the damping of the case."""

    kind: Literal["damping-change"]
    before: Annotated[DampingModels, Field(min_length=1, max_length=1, description="damping file of the earlier run")]
    after: Annotated[str, Field(max_length=100, description="name of the damping of the case")]
    span: Annotated[int, Field(ge=1, description="number of the span whose force is drawn, from 1")]
    printed: Annotated[tuple[Printed, ...], Field(strict=False, max_length=40)] = ()


class ReleaseVelocity(SourcedTable):
    """Velocity of a sensor after a release under several damping models, in time windows."""

    kind: Literal["release-velocity"]
    models: Annotated[DampingModels, Field(min_length=2)]
    windows_s: Annotated[
        tuple[Interval, ...],
        Field(
            strict=False, min_length=1, max_length=6, description="start and end of each window, after the release [s]"
        ),
    ]
    sensor: Annotated[int, Field(ge=1, description="number of the sensor, from 1")] = 1

    @model_validator(mode="after")
    def _ordered(self) -> "ReleaseVelocity":
        for i, (start, end) in enumerate(self.windows_s, 1):
            if not 0 <= start < end:
                raise validation_problem(
                    f"windows_s[{i}]", f"{start:g} s to {end:g} s is not a window", "Give [from, to]."
                )
        return self


class DropperDamping(SourcedTable):
    """Passage of the case for stiffness coefficients of the droppers over many orders of magnitude."""

    kind: Literal["dropper-damping"]
    coefficients_s: Annotated[PositiveList, Field(min_length=4, description="stiffness coefficients, ascending [s]")]
    x_m: Place

    @model_validator(mode="after")
    def _ascending(self) -> "DropperDamping":
        if list(self.coefficients_s) != sorted(set(self.coefficients_s)):
            raise validation_problem(
                "coefficients_s", "not in ascending order", "List every value once, from small to large."
            )
        return self


class SteadyArmDamper(SourcedTable):
    """Identified damping with and without a vertical damper at every steady arm, by frequency band."""

    kind: Literal["steady-arm-damper"]
    damper_N_s_m: Annotated[Positive, Field(le=1e6, description="vertical damper between wire and ground [N s/m]")]
    bands_Hz: Annotated[
        tuple[Interval, ...],
        Field(strict=False, min_length=1, max_length=40, description="lower and upper edge of each band [Hz]"),
    ]


class DampingSensitivity(SourcedTable):
    """Passage of the case under several damping models, for comparison without verdict."""

    kind: Literal["damping-sensitivity"]
    models: Annotated[DampingModels, Field(min_length=1)]


Study = Annotated[
    DampingChange | DampingSensitivity | ReleaseVelocity | DropperDamping | SteadyArmDamper,
    Field(discriminator="kind", description="kind of comparison"),
]
