"""Mass drops of a case: what is hung where, how it is let go, and what is recorded."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    SourcedTable,
    validation_problem,
)

WireName = Annotated[Literal["contact_wire", "messenger_wire"], Field(description="wire, as in the line file")]
Place = Annotated[NonNegative, Field(le=1e5, description="place along the line, from its beginning [m]")]
DampingFileName = Annotated[str, Field(min_length=1, max_length=500)]
DampingModels = Annotated[
    dict[str, DampingFileName],
    Field(max_length=10, description="damping files, relative to the case, by the name they have in the report"),
]


class Sensor(InputTable):
    """A sensor on a wire; it feels the vertical motion."""

    wire: WireName
    x_m: Place


class DropTest(InputTable):
    """One drop."""

    mass_kg: Annotated[Positive, Field(le=200, description="mass that hangs on the wire until it is released [kg]")]
    wire: WireName
    x_m: Place
    release_s: Annotated[
        NonNegative, Field(le=5, description="time over which the weight fades linearly; 0: at once [s]")
    ] = 0.0


class MassDrop(SourcedTable):
    """Drops of one line with one set of sensors, and up to which frequency their modes are identified."""

    drop: Annotated[tuple[DropTest, ...], Field(strict=False, min_length=1, max_length=20)]
    sensor: Annotated[tuple[Sensor, ...], Field(strict=False, min_length=1, max_length=100)]
    record_s: Annotated[Positive, Field(le=900, description="length of the record after the release [s]")]
    hanging_s: Annotated[Positive, Field(ge=1, le=60, description="rest recorded before the release [s]")] = 5.0
    rate_Hz: Annotated[Positive, Field(ge=10, le=5000, description="samples per second of the record [Hz]")] = 100.0
    quantity: Annotated[
        Literal["acceleration", "velocity", "displacement"], Field(description="what the sensors measure")
    ] = "acceleration"
    noise_rms: Annotated[
        NonNegative,
        Field(le=10, description="white noise added to every sensor, rms, in the SI unit of the quantity; the same "
              "case has the same noise"),
    ] = 0.0  # fmt: skip
    highest_Hz: Annotated[Positive, Field(le=200, description="modes are identified up to here [Hz]")] = 10.0
    compared: Annotated[DampingModels, Field(default_factory=dict)]

    @model_validator(mode="after")
    def _observable(self) -> "MassDrop":
        if self.highest_Hz > 0.4 * self.rate_Hz:
            raise validation_problem(
                "highest_Hz",
                f"{self.highest_Hz:g} Hz cannot be seen at {self.rate_Hz:g} samples per second",
                f"Give at most {0.4 * self.rate_Hz:g} Hz, or a rate_Hz of {2.5 * self.highest_Hz:g}.",
            )
        return self
