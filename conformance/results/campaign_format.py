"""Format of campaign.json: facts, charts, maps and statistics of a campaign, from which its report is made."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart, Suite

CampaignEnding = Literal["complete", "failure share", "time budget", "interrupted"]
"""Reason of the end of a campaign."""


class ValueMap(ResultsPart):
    """Values over two inputs, with the limits whose contour is drawn."""

    caption: str
    alternative: str
    x_label: str
    y_label: str
    value_label: str
    x: list[float]
    y: list[float]
    values: list[list[FiniteNumber | None]]
    """One list per y; null: no result."""
    lower: FiniteNumber | None
    upper: FiniteNumber | None


class Estimate(ResultsPart):
    """Estimate from random designs with its interval."""

    value: FiniteNumber
    low: FiniteNumber
    high: FiniteNumber


class ValueStatistics(ResultsPart):
    """Statistics of a value over the random designs of one point of the grid."""

    label: str
    group: str
    """Case, system and grid inputs; empty if there is one group."""
    runs: int
    mean: Estimate
    """Mean with its interval of uncertainty (normal approximation)."""
    std: FiniteNumber
    quantiles: dict[str, FiniteNumber]
    """Quantiles 5, 50 and 95 %."""
    limit: str | None
    """Bounds of the limit; null: no limit."""
    exceedance: Estimate | None
    """Share of runs outside the limit, with its interval of uncertainty (Wilson 1927)."""


class InputShare(ResultsPart):
    """Sobol indices of one random input."""

    input: str
    first: Estimate
    """Share of the variance that the input causes alone."""
    total: Estimate
    """Share that the input causes, its interactions included."""


class SobolIndices(ResultsPart):
    """Sobol indices of a value over the random inputs, with 95 % intervals."""

    label: str
    group: str
    """Case, system and grid inputs; empty if there is one group."""
    runs: int
    """Number of the designs of each set."""
    shares: list[InputShare]


class ValueComparison(ResultsPart):
    """Differences of a value between runs of two campaigns with equal inputs, this campaign minus the other."""

    label: str
    runs: int
    """Number of pairs of runs."""
    mean: FiniteNumber
    rms: FiniteNumber
    largest: FiniteNumber
    place: str
    """Case and inputs of the largest difference."""


class CampaignResults(ResultsPart):
    """Evaluation of a campaign."""

    schema_: Annotated[Literal["pantocheck.campaign/1"], Field(alias="schema")] = "pantocheck.campaign/1"
    suite: Suite
    title: str
    ending: CampaignEnding
    cases: list[str]
    systems: list[str]
    inputs: dict[str, str]
    """Varied inputs with their ranges as text."""
    sources: dict[str, str] = {}
    """Source and trust of varied inputs, where they are stated."""
    contacts: dict[str, str] = {}
    """Contact of each base case, on which its values from 20 to 50 Hz are conditional."""
    total: int
    finished: int
    failed: int
    verdicts: dict[str, int]
    """Number of runs by verdict."""
    reasons: dict[str, int]
    """Most frequent reasons of runs without a result."""
    charts: list[Chart]
    maps: list[ValueMap]
    omitted_maps: int = 0
    """Number of further maps that are left out."""
    statistics: list[ValueStatistics]
    indices: list[SobolIndices] = []
    comparison: list[ValueComparison] = []
    """Comparison with another campaign, if requested."""
