"""Format of damping.json: a damping model fitted to identified modes."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel


class Coefficient(RoundedModel):
    """Fitted coefficient of Rayleigh damping, in [s] for the stiffness matrix, in [1/s] for the mass matrix."""

    kind: Annotated[str, Field(description="kind of component")]
    matrix: Annotated[str, Field(description="matrix of the coefficient: stiffness or mass")]
    value: Rounded
    low_95: Annotated[Rounded, Field(description="lower bound of the 95 % confidence interval")]
    high_95: Annotated[Rounded, Field(description="upper bound of the 95 % confidence interval")]
    determined: Annotated[bool, Field(description="false: below a threshold; do not use it in a simulation")] = False
    reason: Annotated[str, Field(description="thresholds that are not reached; empty: all are reached")] = ""


class LineDifference(RoundedModel):
    """Difference between the line of the record and the line of the fit."""

    fact: Annotated[str, Field(description="compared property: span, tension or sensor")]
    record: Annotated[str, Field(description="value for the line of the record, with unit")]
    line: Annotated[str, Field(description="value for the line of the fit, with unit")]


class LineComparison(RoundedModel):
    """Comparison of the line of the record with the line of the fit."""

    state: Annotated[
        Literal["verified", "unverified", "contradicted"],
        Field(description="verified: all properties agree; unverified: some are missing; contradicted: some differ"),
    ]
    differences: tuple[LineDifference, ...]
    missing: Annotated[tuple[str, ...], Field(description="properties of the line that the modes do not state")]


class Matching(RoundedModel):
    """Numbers of usable and of matched modes, and the agreement of their shapes."""

    modes: Annotated[int, Field(description="number of usable modes: certain, vertical and in a group")]
    matched: Annotated[int, Field(description="number of usable modes with a computed counterpart")]
    matched_share: Annotated[Rounded, Field(description="matched modes over usable modes [-]")]
    median_mac: Annotated[
        Rounded | None,
        Field(description="median MAC of the matched modes with at least two sensors [-]; null: no such mode"),
    ]
    lowest_mac: Annotated[
        Rounded | None, Field(description="lowest MAC of the matched modes with at least two sensors [-]")
    ]


class MeasuredBand(RoundedModel):
    """Median measured damping ratio of a group of span modes, and its frequency band."""

    from_Hz: Rounded
    to_Hz: Rounded
    damping_ratio: Rounded


class Observability(RoundedModel):
    """Observability of one coefficient in the measured modes."""

    kind: Annotated[str, Field(description="kind of component")]
    matrix: Annotated[str, Field(description="matrix of the coefficient: stiffness or mass")]
    largest_share: Annotated[
        Rounded,
        Field(description="damping ratio due to the plausible value over measured ratio [-]; largest of all modes"),
    ]
    variance_inflation: Annotated[
        Rounded | None,
        Field(description="variance inflation factor 1 / (1 - R^2) with the fitted coefficients [-]; null: infinite"),
    ]
    std: Annotated[
        Rounded | None,
        Field(description="lowest possible standard deviation, in the unit of the coefficient; null: infinite"),
    ]
    plausible: Annotated[float, Field(description="plausible value, in the unit of the coefficient")]
    plausible_over_std: Annotated[Rounded, Field(description="plausible value over standard deviation [-]")]
    residual_without: Annotated[
        Rounded,
        Field(description="residual of a fit without the coefficient over that with it [-]; 1: not fitted"),
    ]
    observable: bool


class Thresholds(RoundedModel):
    """Thresholds of the quantities of the same name.

    An observable coefficient reaches the first two thresholds, a determined coefficient all of them.
    """

    largest_share: float
    plausible_over_std: float
    matched_share: float
    median_mac: float


class PairedMode(RoundedModel):
    """Identified mode and its computed counterpart."""

    measured_Hz: Rounded
    computed_Hz: Rounded
    mac: Annotated[Rounded, Field(description="modal assurance criterion of the shapes at the sensors [-]")]
    group: int | None
    measured: Annotated[Rounded, Field(description="measured damping ratio [-]")]
    fitted: Annotated[Rounded, Field(description="damping ratio of the fitted model [-]")]
    used: Annotated[bool, Field(description="false: outlier of its group or overlapping, left out of the fit")]
    overlapping: Annotated[bool, Field(description="true: another mode lies within the half-power bandwidth")]


class WireShape(RoundedModel):
    """Computed shape of one wire."""

    wire: Annotated[str, Field(description="CW (contact wire) or MW (messenger wire)")]
    position_m: tuple[float, ...]
    value: Annotated[tuple[float, ...], Field(description="deflection over the largest deflection of the mode [-]")]


class MeasuredDeflection(RoundedModel):
    """Measured component of a shape at one sensor."""

    wire: str
    position_m: float
    value: Annotated[Rounded, Field(description="real part in the scale of the computed shape [-]")]


class PairedShape(RoundedModel):
    """Shapes of an identified mode and of its computed counterpart."""

    measured_Hz: Rounded
    group: int
    mac: Annotated[Rounded, Field(description="modal assurance criterion of the shapes at the sensors [-]")]
    sensors: tuple[MeasuredDeflection, ...]
    curves: tuple[WireShape, ...]


class PairedShapes(RoundedModel):
    """Shapes of the pairs of the first groups of span modes."""

    supports_m: Annotated[tuple[float, ...], Field(description="positions of the supports [m]")] = ()
    modes: tuple[PairedShape, ...] = ()


class MeasuredRatios(RoundedModel):
    """Measured damping ratios of the paired modes."""

    frequency_Hz: tuple[Rounded, ...]
    damping_ratio: tuple[Rounded, ...]
    std: tuple[Rounded, ...]


class ModelComparison(RoundedModel):
    """Measured damping ratios, and those of several damping models at the computed modes."""

    measured: MeasuredRatios
    frequency_Hz: Annotated[tuple[Rounded, ...], Field(description="frequencies of the computed modes [Hz]")]
    models: Annotated[dict[str, tuple[Rounded, ...]], Field(description="damping ratios by name of the model")]


class StatedDamping(RoundedModel):
    """Rayleigh damping of a kind of component that is not fitted, as the line states it."""

    kind: str
    stiffness_coefficient_s: Rounded
    mass_coefficient_1_s: Rounded


class DampingResults(RoundedModel):
    """Content of damping.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.damping/1"], Field(alias="schema")] = "pantocheck.damping/1"
    modes_file: Annotated[str, Field(description="file of the identified modes")]
    warnings: Annotated[tuple[str, ...], Field(description="caveats for the use of the coefficients")]
    line: Annotated[LineComparison, Field(description="comparison of the lines of record and fit")]
    matching: Matching
    residual: Annotated[Rounded, Field(description="RMS of (measured - fitted) / measured, all modes of the fit [-]")]
    coefficients: tuple[Coefficient, ...]
    stated: Annotated[
        tuple[StatedDamping, ...],
        Field(description="damping of other components, as the line of the fit states it"),
    ] = ()
    modal: Annotated[tuple[MeasuredBand, ...], Field(description="frequency bands of the first groups of span modes")]
    observability: tuple[Observability, ...]
    thresholds: Thresholds
    pairs: tuple[PairedMode, ...]
    shapes: PairedShapes = PairedShapes()
    comparison: ModelComparison
    unpaired: Annotated[
        tuple[Rounded, ...], Field(description="frequencies of the measured modes without computed counterpart [Hz]")
    ]
