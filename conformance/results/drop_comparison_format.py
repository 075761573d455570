"""Format of drop_comparison.json: a recorded mass drop beside its simulation under one or more damping models."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.criterion import ComparedMotion
from pantocheck.conformance.core.json_file import Rounded, RoundedModel
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.results.comparison_format import ComparedSource, ModelComparison, NumberPair
from pantocheck.conformance.results.damping_format import LineComparison

CurveValues = tuple[float, ...]


class ComparedDrop(RoundedModel):
    """Mass drop of the record."""

    mass_kg: Rounded
    wire: str
    """CW contact wire, MW messenger wire."""
    position_m: Rounded
    release_duration_s: Rounded
    """Time in which the weight decreases to zero."""
    planned_release_s: Rounded | None
    """Planned release, in the time of the record; null: not stated."""
    release_s: Rounded
    """Release in the time of the record, by the best fit of the model."""
    release_correlation: Rounded
    """Correlation of record and first model at this release."""


class ComparedPlace(RoundedModel):
    """Place on the line whose motion is compared."""

    name: str
    """Name of the channel, or `mass`."""
    sensor: int | None
    """Number of the sensor; null: no sensor, only the models are shown."""
    wire: str
    position_m: Rounded


class ComparedModel(RoundedModel):
    """Damping model of a simulation."""

    name: str
    source: str
    """Name of the damping file, or of the line."""
    damping: Damping
    last_slack_s: Rounded | None
    """Last time after the release with a slack dropper; null: none was slack."""


class ModelAgreement(RoundedModel):
    """Motion of a model beside the record."""

    model: str
    rms: Rounded
    """RMS of the model [m/s or m/s2]."""
    rms_ratio: Rounded | None
    """RMS of the model over `record_rms`; null: no record, or too much noise."""
    correlation: Rounded | None
    """Correlation of the samples; null: as the ratio."""


class WindowStatistics(RoundedModel):
    """Motion of one place in one window and band."""

    place: str
    motion: ComparedMotion
    window_s: NumberPair
    band_Hz: NumberPair
    record_rms: Rounded | None
    """RMS of the record without its noise [m/s or m/s2]; null: no record."""
    noise_rms: Rounded | None
    """RMS of the record at rest before the release; null: not known."""
    models: tuple[ModelAgreement, ...]


class EnergyCurve(RoundedModel):
    """Mean square of the velocity in short windows against time."""

    place: str
    time_s: CurveValues
    """Middle of each window after the release [s]."""
    record: CurveValues | None
    """Mean square of the velocity of the record [m2/s2]."""
    models: dict[str, CurveValues]
    """Mean square by model [m2/s2]."""
    differences: dict[str, CurveValues]
    """Mean square of model minus record [m2/s2]."""


class MotionCurve(RoundedModel):
    """Motion of a place in a window, below 20 Hz."""

    place: str
    motion: ComparedMotion
    window_s: NumberPair
    time_s: CurveValues
    record: CurveValues | None
    """Record [m/s or m/s2]; null: no record."""
    models: dict[str, CurveValues]
    """Motion by model [m/s or m/s2]."""


class DropComparison(ModelComparison):
    """Content of drop_comparison.json."""

    schema_: Annotated[Literal["pantocheck.drop-comparison/1"], Field(alias="schema")] = "pantocheck.drop-comparison/1"
    record: ComparedSource
    """Test and run, its file, and the SHA-256 of the file."""
    line_comparison: LineComparison
    """Line of the record beside the line of the models."""
    drop: ComparedDrop
    rate_Hz: Rounded
    """Sampling rate of the comparison."""
    element_m: Rounded
    time_step_s: Rounded
    windows_s: tuple[NumberPair, ...]
    """Windows after the release."""
    bands_Hz: tuple[NumberPair, ...]
    """Compared bands."""
    models: tuple[ComparedModel, ...]
    """Damping models; the first one is graded."""
    places: tuple[ComparedPlace, ...]
    statistics: tuple[WindowStatistics, ...]
    energies: tuple[EnergyCurve, ...]
    curves: tuple[MotionCurve, ...]
