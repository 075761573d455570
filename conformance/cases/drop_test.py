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

    mass_kg: Annotated[Positive, Field(le=200)]
    """Mass on the wire before the release [kg]."""
    wire: WireName
    x_m: Place
    release_s: Annotated[NonNegative, Field(le=5)] = 0.0
    """Time in which the weight decreases linearly to zero [s]; 0: at once."""


class MassDrop(SourcedTable):
    """Mass drops on a line with one set of sensors, and the frequency range of their identification."""

    drop: Annotated[tuple[DropTest, ...], Field(strict=False, min_length=1, max_length=20)]
    sensor: Annotated[tuple[Sensor, ...], Field(strict=False, min_length=1, max_length=100)]
    record_s: Annotated[Positive, Field(le=900)]
    """Duration of the record after the release [s]."""
    hanging_s: Annotated[Positive, Field(ge=1, le=60)] = 5.0
    """Duration of the record before the release, with hanging mass [s]."""
    rate_Hz: Annotated[Positive, Field(ge=10, le=5000)] = 100.0
    """Sampling rate of the record [Hz]."""
    quantity: Literal["acceleration", "velocity", "displacement"] = "acceleration"
    """Measured quantity."""
    noise_rms: Annotated[NonNegative, Field(le=10)] = 0.0
    """RMS of the white noise of each sensor [SI unit of quantity]; each drop has its own noise, the same in every
    run.
    """
    highest_Hz: Annotated[Positive, Field(le=200)] = 10.0
    """Highest frequency of the identified modes [Hz]."""
    compared: Annotated[DampingModels, Field(default_factory=dict)]

    @cross_check
    def _observable(self) -> Problems:
        if self.highest_Hz > 0.4 * self.rate_Hz:
            yield validation_problem(
                "highest_Hz",
                f"{self.highest_Hz:g} Hz is not observable with rate_Hz = {self.rate_Hz:g}",
                f"Give at most {0.4 * self.rate_Hz:g} Hz, or rate_Hz = {2.5 * self.highest_Hz:g}.",
            )
