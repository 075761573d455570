"""Table `[study]` of a case file. A study compares several runs of the case."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    PositiveList,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)

# Mass drops of a case: mass, position, release and sensors.
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


class DropStatements(SourcedTable):
    """Inputs of single findings on mass drops."""

    repeat_release_s: Annotated[NonNegative, Field(le=5)]
    """Release of the first drop when it is repeated, with other noise [s]."""
    half_power_points: Annotated[int, Field(ge=1, le=100)]
    half_power_frequency_Hz: Annotated[Positive, Field(le=200)]
    half_power_damping_ratio: Annotated[Positive, Field(lt=1)]
    """Spectral lines in the half-power band, and frequency [Hz] and damping ratio [-] of a mode: record length."""
    stagger_m: Annotated[Positive, Field(le=1)]
    """Stagger of the contact wire for the computed lateral modes; the drops are on the line without it [m]."""


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
    statements: Annotated[DropStatements | None, Field(exclude_if=is_absent)] = None
    """Inputs of findings that need more than the drops."""

    @cross_check
    def _observable(self) -> Problems:
        if self.highest_Hz > 0.4 * self.rate_Hz:
            yield validation_problem(
                "highest_Hz",
                f"{self.highest_Hz:g} Hz is not observable with rate_Hz = {self.rate_Hz:g}",
                f"Give at most {0.4 * self.rate_Hz:g} Hz, or rate_Hz = {2.5 * self.highest_Hz:g}.",
            )


Interval = Annotated[tuple[float, float], Field(strict=False)]


class Printed(InputTable):
    """Printed values of a pantograph under a damping model, for comparison with the computed values."""

    model: Annotated[str, Field(max_length=100)]
    """Name of the damping model."""
    pantograph: Annotated[int, Field(ge=1, le=20)]
    """Number in running order."""
    values: Annotated[dict[str, float], Field(min_length=1, max_length=50)]
    """Values by name of quantity."""


class DampingChange(SourcedTable):
    """Study of a changed damping: the passage runs with an earlier damping and with the damping of the case."""

    kind: Literal["damping-change"]
    before: Annotated[DampingModels, Field(min_length=1, max_length=1)]
    """Damping file of the earlier run."""
    after: Annotated[str, Field(max_length=100)]
    """Name of the damping of the case."""
    span: Annotated[int, Field(ge=1)]
    """Number of the span for the figure of the force, from 1."""
    printed: Annotated[tuple[Printed, ...], Field(strict=False, max_length=40)] = ()


class ReleaseVelocity(SourcedTable):
    """Study of a release: velocity of a sensor in several time windows, under several damping models."""

    kind: Literal["release-velocity"]
    models: Annotated[DampingModels, Field(min_length=4)]
    """Damping files by name: reference model, fitted Rayleigh damping, the same with modal damping, and any further
    models, which are drawn.
    """
    test: Annotated[str, Field(max_length=100)]
    """Name of the model whose drop takes the place of a record."""
    windows_s: Annotated[tuple[Interval, ...], Field(strict=False, min_length=1, max_length=6)]
    """Start and end of each window, after the release [s]."""
    sensor: Annotated[int, Field(ge=1)] = 1
    """Number of the sensor, from 1."""

    @cross_check
    def _ordered(self) -> Problems:
        for i, (start, end) in enumerate(self.windows_s, 1):
            if not 0 <= start < end:
                yield validation_problem(
                    f"windows_s[{i}]", f"runs from {start:g} s to {end:g} s", "Give [start, end], 0 <= start < end."
                )


class DropperDamping(SourcedTable):
    """Study of the dropper damping: the passage runs once for each stiffness coefficient of the droppers."""

    kind: Literal["dropper-damping"]
    coefficients_s: Annotated[PositiveList, Field(min_length=4)]
    """Stiffness coefficients, ascending [s]."""
    x_m: Place

    @cross_check
    def _ascending(self) -> Problems:
        if list(self.coefficients_s) != sorted(set(self.coefficients_s)):
            yield validation_problem(
                "coefficients_s", "the values are not in ascending order", "List every value once, from small to large."
            )


class DropperOscillation(SourcedTable):
    """Study of the dropper damping after a release: the drop runs once for each stiffness coefficient."""

    kind: Literal["dropper-oscillation"]
    coefficients_s: Annotated[tuple[NonNegative, ...], Field(strict=False, min_length=3, max_length=20)]
    """Stiffness coefficients from 0, ascending [s]."""

    @cross_check
    def _ascending_from_zero(self) -> Problems:
        if list(self.coefficients_s) != sorted(set(self.coefficients_s)) or self.coefficients_s[0] != 0:
            yield validation_problem(
                "coefficients_s", "the values do not ascend from 0", "List every value once, from 0 to the largest."
            )


class SteadyArmDamper(SourcedTable):
    """Study of dampers at the steady arms: damping is identified with and without them, by frequency band."""

    kind: Literal["steady-arm-damper"]
    damper_N_s_m: Annotated[Positive, Field(le=1e6)]
    """Vertical damper between wire and ground [N s/m]."""
    bands_Hz: Annotated[tuple[Interval, ...], Field(strict=False, min_length=1, max_length=40)]
    """Lower and upper edge of each band [Hz]."""


class DampingSensitivity(SourcedTable):
    """Study of the sensitivity to damping: the passage runs under several damping models; they are not graded."""

    kind: Literal["damping-sensitivity"]
    models: Annotated[DampingModels, Field(min_length=1)]


Study = Annotated[
    DampingChange | DampingSensitivity | ReleaseVelocity | DropperDamping | DropperOscillation | SteadyArmDamper,
    Field(discriminator="kind", description="kind of study"),
]
