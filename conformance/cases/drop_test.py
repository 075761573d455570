"""Mass drops of a case: mass, position, release and sensors."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    SourcedTable,
    validation_problem,
)

WireName = Annotated[Literal["contact_wire", "messenger_wire"], Field(description="wire, as in the line file")]
Place = Annotated[NonNegative, Field(le=1e5, description="position along the line [m]")]
DampingModels = Annotated[
    dict[str, Annotated[str, Field(min_length=1, max_length=500)]],
    Field(max_length=10, description="damping files, relative to the case file, by their name in the report"),
]


class Sensor(InputTable):
    """Sensor on a wire, for vertical motion."""

    wire: WireName
    x_m: Place


class DropTest(InputTable):
    """Release of one mass that hangs on a wire."""

    mass_kg: Annotated[Positive, Field(le=200, description="mass on the wire before the release [kg]")]
    wire: WireName
    x_m: Place
    release_s: Annotated[
        NonNegative, Field(le=5, description="time in which the weight decreases linearly to zero [s]; 0: at once")
    ] = 0.0


class MassDrop(SourcedTable):
    """Mass drops on a line with one set of sensors, and the frequency range of their identification."""

    drop: Annotated[tuple[DropTest, ...], Field(strict=False, min_length=1, max_length=20)]
    sensor: Annotated[tuple[Sensor, ...], Field(strict=False, min_length=1, max_length=100)]
    record_s: Annotated[Positive, Field(le=900, description="duration of the record after the release [s]")]
    hanging_s: Annotated[
        Positive, Field(ge=1, le=60, description="duration of the record before the release, with hanging mass [s]")
    ] = 5.0
    rate_Hz: Annotated[Positive, Field(ge=10, le=5000, description="sampling rate of the record [Hz]")] = 100.0
    quantity: Annotated[Literal["acceleration", "velocity", "displacement"], Field(description="measured quantity")] = (
        "acceleration"
    )
    noise_rms: Annotated[
        NonNegative,
        Field(
            le=10,
            description="RMS of the white noise of each sensor [SI unit of quantity]; each drop has its own noise, "
            "the same in every run",
        ),
    ] = 0.0
    highest_Hz: Annotated[Positive, Field(le=200, description="highest frequency of the identified modes [Hz]")] = 10.0
    compared: Annotated[DampingModels, Field(default_factory=dict)]

    @cross_check
    def _observable(self) -> Problems:
        if self.highest_Hz > 0.4 * self.rate_Hz:
            yield validation_problem(
                "highest_Hz",
                f"{self.highest_Hz:g} Hz is not observable with rate_Hz = {self.rate_Hz:g}",
                f"Give at most {0.4 * self.rate_Hz:g} Hz, or rate_Hz = {2.5 * self.highest_Hz:g}.",
            )
