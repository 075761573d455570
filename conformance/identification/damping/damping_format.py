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


class MeasuredBand(RoundedModel):
    """Median measured damping ratio of a group of span modes, and the band that it is used in."""

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
    """Lower limits of the keys of the same name for a coefficient to be observable."""

    largest_share: float
    plausible_over_std: float


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
    """Damping ratios measured and of the models at the computed modes."""

    measured: MeasuredRatios
    frequency_Hz: Annotated[tuple[Rounded, ...], Field(description="frequencies of the computed modes [Hz]")]
    models: Annotated[dict[str, tuple[Rounded, ...]], Field(description="damping ratios by name of the model")]


class DampingResults(RoundedModel):
    """File damping.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.damping/1"], Field(alias="schema")] = "pantocheck.damping/1"
    modes_file: Annotated[str, Field(description="source of the identified modes")]
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
