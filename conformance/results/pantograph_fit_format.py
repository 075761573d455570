"""Format of the report on a fitted pantograph: a chain of lumped masses from measured frequency responses."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.results.comparison_format import ResponseComparison
from pantocheck.conformance.results.suite_part import Suite

Determination = Literal["fixed", "determined", "weakly_determined", "not_distinguished_from_zero"]
"""How well the measured band determines a parameter."""

ChainKey = Literal["masses_kg", "stiffness_N_m", "damping_N_s_m"]
"""Lists of a chain, as in a pantograph file."""


class ChainParameter(RoundedModel):
    """Fitted value of a chain."""

    key: ChainKey
    number: Annotated[int, Field(description="number of the mass or element, from 1 at the base")]
    value: Rounded
    half_width: Annotated[Rounded, Field(description="half-width of the 95 % interval; 0: fixed")]
    determination: Determination


class ChainCandidate(RoundedModel):
    """Fit of a chain with one number of masses."""

    masses: int
    free_parameters: int
    complex_deviation_pct: Annotated[Rounded, Field(description="RMS of the complex deviation over all rows")]
    variance_ratio: Annotated[
        Rounded | None,
        Field(description="sum of squares over degrees of freedom; 1 with noise alone; null: no uncertainty is stated"),
    ]
    information_criterion: Annotated[Rounded, Field(description="BIC; the lowest value is the best")]
    starts: int
    best_starts: Annotated[int, Field(description="starts that ended in the best minimum")]


class CorrelatedPair(RoundedModel):
    """Two parameters that the measured band hardly distinguishes."""

    first: str
    second: str
    correlation: Rounded


class PantographFit(RoundedModel):
    """Content of the JSON report beside a fitted pantograph file."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.pantograph-fit/1"], Field(alias="schema")] = "pantocheck.pantograph-fit/1"
    suite: Suite
    title: Annotated[str, Field(description="title of the fitted pantograph")]
    masses: int
    band_Hz: Annotated[tuple[Rounded, Rounded], Field(description="lowest and highest frequency in the fit")]
    rows: Annotated[int, Field(description="number of measured values in the fit")]
    is_noise_stated: bool
    parameters: tuple[ChainParameter, ...]
    natural_frequencies_Hz: Annotated[
        tuple[Rounded, ...], Field(description="undamped natural frequencies with a fixed base and a free head")
    ]
    correlations: tuple[CorrelatedPair, ...]
    candidates: tuple[ChainCandidate, ...]
    comparison: Annotated[ResponseComparison, Field(description="fitted pantograph beside the measured responses")]
    warnings: tuple[str, ...]
