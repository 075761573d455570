"""Format of damping.json: a damping model fitted to identified modes."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel


class Coefficient(RoundedModel):
    """Fitted coefficient of Rayleigh damping [s] for stiffness, [1/s] for mass."""

    kind: Annotated[str, Field(description="kind of component")]
    matrix: Annotated[str, Field(description="matrix that the coefficient multiplies: stiffness or mass")]
    value: Rounded
    low_95: Annotated[Rounded, Field(description="lower bound of the 95 % confidence interval")]
    high_95: Annotated[Rounded, Field(description="upper bound of the 95 % confidence interval")]
    determined: Annotated[bool, Field(description="false: below a threshold, not for use in a simulation")] = False
    reason: Annotated[str, Field(description="thresholds that are not reached; empty: determined")] = ""


class LineDifference(RoundedModel):
    """Difference between the line of the record and the line of the fit."""

    fact: Annotated[str, Field(description="span, tension or sensor")]
    record: Annotated[str, Field(description="value of the record, with its unit")]
    line: Annotated[str, Field(description="value of the line of the fit, with its unit")]


class LineComparison(RoundedModel):
    """Comparison of the line of the record with the line of the fit."""

    state: Annotated[
        Literal["verified", "unverified", "contradicted"],
        Field(description="verified: all facts agree; unverified: some are missing; contradicted: some differ"),
    ]
    differences: tuple[LineDifference, ...]
    missing: Annotated[tuple[str, ...], Field(description="facts that the modes do not state")]


class Matching(RoundedModel):
    """Identified modes that the fit can use, and those with a counterpart in the model of the line."""

    modes: Annotated[int, Field(description="identified modes that are certain, vertical and in a group")]
    matched: Annotated[int, Field(description="number of them with a computed counterpart")]
    matched_share: Annotated[Rounded, Field(description="matched over modes [-]")]
    median_mac: Annotated[
        Rounded | None,
        Field(description="median MAC of the matched modes with two sensors or more [-]; null: no such mode"),
    ]
    lowest_mac: Annotated[Rounded | None, Field(description="lowest MAC of the same modes [-]")]


class MeasuredBand(RoundedModel):
    """Median measured damping ratio of a group of span modes, and its frequency band."""

    from_Hz: Rounded
    to_Hz: Rounded
    damping_ratio: Rounded


class Observability(RoundedModel):
    """Observability of one coefficient: whether the modes determine it."""

    kind: Annotated[str, Field(description="kind of component")]
    matrix: Annotated[str, Field(description="matrix that the coefficient multiplies: stiffness or mass")]
    largest_share: Annotated[
        Rounded, Field(description="largest share of the plausible value in the damping ratio of a mode [-]")
    ]
    variance_inflation: Annotated[
        Rounded | None, Field(description="1 / (1 - R^2) of the coefficient on the fitted ones; null: infinite")
    ]
    std: Annotated[
        Rounded | None, Field(description="lowest standard deviation, the fitted ones unknown too; null: infinite")
    ]
    plausible: Annotated[float, Field(description="plausible value, in the unit of the coefficient")]
    plausible_over_std: Annotated[Rounded, Field(description="plausible value over standard deviation [-]")]
    residual_without: Annotated[
        Rounded, Field(description="factor on the residual of the fit without the coefficient; 1: not fitted")
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
    used: Annotated[bool, Field(description="false: an outlier of its group, not used in the fit")]


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


class DampingResults(RoundedModel):
    """Content of damping.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.damping/1"], Field(alias="schema")] = "pantocheck.damping/1"
    modes_file: Annotated[str, Field(description="source of the identified modes")]
    warnings: Annotated[tuple[str, ...], Field(description="caveats for the user of the coefficients")]
    line: Annotated[LineComparison, Field(description="whether the fit used the line of the record")]
    matching: Matching
    residual: Annotated[Rounded, Field(description="RMS of (measured - fitted) / measured over the modes used [-]")]
    coefficients: tuple[Coefficient, ...]
    modal: Annotated[tuple[MeasuredBand, ...], Field(description="bands of the first groups of span modes")]
    observability: tuple[Observability, ...]
    thresholds: Thresholds
    pairs: tuple[PairedMode, ...]
    comparison: ModelComparison
    unpaired: Annotated[
        tuple[Rounded, ...], Field(description="frequencies of measured modes without a counterpart [Hz]")
    ]
