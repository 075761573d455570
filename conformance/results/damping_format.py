"""Format of damping.json: a damping model fitted to identified modes."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.json_file import Rounded, RoundedModel


class Coefficient(RoundedModel):
    """Fitted coefficient of Rayleigh damping, in [s] for the stiffness matrix, in [1/s] for the mass matrix."""

    kind: str
    """Kind of component."""
    matrix: str
    """Matrix of the coefficient: stiffness or mass."""
    value: Rounded
    low_95: Rounded
    """Lower bound of the 95 % confidence interval."""
    high_95: Rounded
    """Upper bound of the 95 % confidence interval."""
    determined: bool = False
    """false: below a threshold; do not use it in a simulation."""
    reason: str = ""
    """Thresholds that are not reached; empty: all are reached."""


class LineDifference(RoundedModel):
    """Difference between the line of the record and the line of the fit."""

    fact: str
    """Compared property: span, tension or sensor."""
    record: str
    """Value for the line of the record, with unit."""
    line: str
    """Value for the line of the fit, with unit."""


class LineComparison(RoundedModel):
    """Comparison of the line of the record with the line of the fit."""

    state: Literal["consistent", "unconfirmed", "contradicted"]
    """consistent: all properties agree; unconfirmed: some are missing; contradicted: some differ."""
    differences: tuple[LineDifference, ...]
    missing: tuple[str, ...]
    """Properties of the line that the modes do not state."""
    refuted: tuple[LineDifference, ...] = ()
    """Properties of the line that the natural frequencies contradict, whatever the record states."""


class FittedProperty(RoundedModel):
    """Property of the line that was fitted together with the damping."""

    name: str
    """Name, as the key of its tolerance in a line file."""
    factor: Rounded
    """Found over stated value [-]; that of a tension holds for the stated mass per length."""
    low_95: Rounded
    """Lower bound of the 95 % interval of the factor [-]."""
    high_95: Rounded
    """Upper bound of the 95 % interval of the factor [-]."""
    tolerance: Rounded
    """Standard deviation of the stated value before the fit [-]."""
    determined: bool
    """false: the modes do not determine it; it stays at its stated value within the tolerance."""


class JointCovariance(RoundedModel):
    """Covariance of the factors of the fitted properties and of the coefficients."""

    names: tuple[str, ...]
    rows: tuple[tuple[Rounded, ...], ...]
    """Square matrix; coefficients in [s] and [1/s], factors without unit."""


class GroupResidual(RoundedModel):
    """Residual of the damping ratios of one group of span modes, and its test."""

    group: int
    modes: int
    """Number of modes in the fit."""
    mean: Rounded
    """Mean of (measured - fitted) / measured [-]."""
    rms: Rounded
    """Root mean square of the same [-]."""
    chi_square: Rounded
    """Squared residual over its covariance; its expectation is the number of modes."""
    probability: Rounded
    """Probability of such a residual if the model carries the group [-]."""
    explained: bool
    """false: the wires do not explain the group, at a level of 1 % for all groups together."""


class Matching(RoundedModel):
    """Numbers of usable and of matched modes, and the agreement of their shapes."""

    modes: int
    """Number of usable modes: certain, vertical and in a group."""
    matched: int
    """Number of usable modes with a computed counterpart."""
    matched_share: Rounded
    """Matched modes over usable modes [-]."""
    median_mac: Rounded | None
    """Median MAC of the matched modes with at least two sensors [-]; null: no such mode."""
    lowest_mac: Rounded | None
    """Lowest MAC of the matched modes with at least two sensors [-]."""


class MeasuredBand(RoundedModel):
    """Median measured damping ratio of a group of span modes, and its frequency band."""

    from_Hz: Rounded
    to_Hz: Rounded
    damping_ratio: Rounded


class Observability(RoundedModel):
    """Observability of one coefficient in the measured modes."""

    kind: str
    """Kind of component."""
    matrix: str
    """Matrix of the coefficient: stiffness or mass."""
    largest_share: Rounded
    """Damping ratio due to the plausible value over measured ratio [-]; largest of all modes."""
    variance_inflation: Rounded | None
    """Variance inflation factor 1 / (1 - R^2) with the fitted coefficients [-]; null: infinite."""
    std: Rounded | None
    """Lowest possible standard deviation, in the unit of the coefficient; null: infinite."""
    plausible: float
    """Plausible value, in the unit of the coefficient."""
    plausible_over_std: Rounded
    """Plausible value over standard deviation [-]."""
    residual_without: Rounded
    """Residual of a fit without the coefficient over that with it [-]; 1: not fitted."""
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
    mac: Rounded
    """Modal assurance criterion of the shapes at the sensors [-]."""
    group: int | None
    measured: Rounded
    """Measured damping ratio [-]."""
    fitted: Rounded
    """Damping ratio of the fitted model [-]."""
    used: bool
    """false: outlier of its group or overlapping, left out of the fit."""
    overlapping: bool
    """true: another mode lies within the half-power bandwidth."""


class WireShape(RoundedModel):
    """Computed shape of one wire."""

    wire: str
    """CW (contact wire) or MW (messenger wire)."""
    position_m: tuple[float, ...]
    value: tuple[float, ...]
    """Deflection over the largest deflection of the mode [-]."""


class MeasuredDeflection(RoundedModel):
    """Measured component of a shape at one sensor."""

    wire: str
    position_m: float
    value: Rounded
    """Real part in the scale of the computed shape [-]."""


class PairedShape(RoundedModel):
    """Shapes of an identified mode and of its computed counterpart."""

    measured_Hz: Rounded
    group: int
    mac: Rounded
    """Modal assurance criterion of the shapes at the sensors [-]."""
    sensors: tuple[MeasuredDeflection, ...]
    curves: tuple[WireShape, ...]


class PairedShapes(RoundedModel):
    """Shapes of the pairs of the first groups of span modes."""

    supports_m: tuple[float, ...] = ()
    """Positions of the supports [m]."""
    modes: tuple[PairedShape, ...] = ()


class MeasuredRatios(RoundedModel):
    """Measured damping ratios of the paired modes."""

    frequency_Hz: tuple[Rounded, ...]
    damping_ratio: tuple[Rounded, ...]
    std: tuple[Rounded, ...]


class FittedModels(RoundedModel):
    """Measured damping ratios, and those of several damping models at the computed modes."""

    measured: MeasuredRatios
    frequency_Hz: tuple[Rounded, ...]
    """Frequencies of the computed modes [Hz]."""
    models: dict[str, tuple[Rounded, ...]]
    """Damping ratios by name of the model."""


class StatedDamping(RoundedModel):
    """Rayleigh damping of a kind of component that is not fitted, as the line states it."""

    kind: str
    stiffness_coefficient_s: Rounded
    mass_coefficient_1_s: Rounded


class DampingResults(RoundedModel):
    """Content of damping.json."""

    schema_: Annotated[Literal["pantocheck.damping/1"], Field(alias="schema")] = "pantocheck.damping/1"
    modes_file: str
    """File of the identified modes."""
    warnings: tuple[str, ...]
    """Caveats for the use of the coefficients."""
    line: LineComparison
    """Comparison of the lines of record and fit."""
    matching: Matching
    residual: Rounded
    """RMS of (measured - fitted) / measured, all modes of the fit [-]."""
    coefficients: tuple[Coefficient, ...]
    properties: tuple[FittedProperty, ...] = ()
    """Properties of the line that were fitted together with the coefficients."""
    covariance: JointCovariance | None = None
    groups: tuple[GroupResidual, ...] = ()
    """Residuals of the groups: how far the form of the model carries."""
    stated: tuple[StatedDamping, ...] = ()
    """Damping of other components, as the line of the fit states it."""
    modal: tuple[MeasuredBand, ...]
    """Frequency bands of the first groups of span modes."""
    observability: tuple[Observability, ...]
    thresholds: Thresholds
    pairs: tuple[PairedMode, ...]
    shapes: PairedShapes = PairedShapes()
    comparison: FittedModels
    unpaired: tuple[Rounded, ...]
    """Frequencies of the measured modes without computed counterpart [Hz]."""
