"""Format of the report on a fitted pantograph: a chain of lumped masses from measured frequency responses."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.json_file import Rounded, RoundedModel
from pantocheck.conformance.core.results_part import Suite
from pantocheck.conformance.pantograph.chain_fit import Determination
from pantocheck.conformance.results.comparison_format import ResponseComparison

ChainKey = Literal["masses_kg", "stiffness_N_m", "damping_N_s_m"]
"""Lists of a chain, as in a pantograph file."""


class ChainParameter(RoundedModel):
    """Fitted value of a chain."""

    key: ChainKey
    number: int
    """Number of the mass or element, from 1 at the base."""
    value: Rounded
    half_width: Rounded
    """Half-width of the 95 % interval; 0: fixed."""
    determination: Determination


class ChainCandidate(RoundedModel):
    """Fit of a chain with one number of masses."""

    masses: int
    free_parameters: int
    complex_deviation_pct: Rounded
    """RMS of the complex deviation over all rows."""
    variance_ratio: Rounded | None
    """Sum of squares over degrees of freedom; 1 with noise alone; null: no uncertainty is stated."""
    information_criterion: Rounded
    """BIC; the lowest value is the best."""
    starts: int
    best_starts: int
    """Starts that ended in the best minimum."""


class CorrelatedPair(RoundedModel):
    """Two parameters that the measured band hardly distinguishes."""

    first: str
    second: str
    correlation: Rounded


class PantographFit(RoundedModel):
    """Content of the JSON report beside a fitted pantograph file."""

    schema_: Annotated[Literal["pantocheck.pantograph-fit/1"], Field(alias="schema")] = "pantocheck.pantograph-fit/1"
    suite: Suite
    title: str
    """Title of the fitted pantograph."""
    masses: int
    band_Hz: tuple[Rounded, Rounded]
    """Lowest and highest frequency in the fit."""
    rows: int
    """Number of measured values in the fit."""
    is_noise_stated: bool
    parameters: tuple[ChainParameter, ...]
    natural_frequencies_Hz: tuple[Rounded, ...]
    """Undamped natural frequencies with a fixed base and a free head."""
    correlations: tuple[CorrelatedPair, ...]
    candidates: tuple[ChainCandidate, ...]
    comparison: ResponseComparison
    """Fitted pantograph beside the measured responses."""
    warnings: tuple[str, ...]
