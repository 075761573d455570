"""Format of the covariance file of a line update: properties of the built line, and the held-out passage."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.json_file import Rounded, RoundedModel
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.damping_format import FittedProperty, JointCovariance


class UsedData(RoundedModel):
    """Measurements of one kind."""

    name: str
    """Kind, or name of the file of a passage."""
    values: int
    """Number of values."""
    misfit: Rounded
    """Squared residual over its expectation [-]; above 1, it widens the covariance."""


class HeldOutValue(RoundedModel):
    """Quantity of the passage that took no part in the update."""

    pantograph: int
    quantity: str
    measured: Rounded
    predicted: Rounded
    """Value of the updated line."""
    stated: Rounded
    """Value of the line as stated."""
    line_std: Rounded
    """Standard deviation of the prediction by the line."""
    model_std: Rounded
    """Standard deviation by simulation and measurement."""


class LineUpdate(RoundedModel):
    """Content of the covariance file."""

    schema_: Annotated[Literal["pantocheck.line-update/1"], Field(alias="schema")] = "pantocheck.line-update/1"
    line: str
    """Title of the line."""
    data: tuple[UsedData, ...]
    moved_droppers: int = 0
    """Number of droppers whose height was measured."""
    properties: tuple[FittedProperty, ...]
    covariance: JointCovariance
    held_out: tuple[HeldOutValue, ...] = ()
    probability: Rounded | None = None
    """Probability of the distance of the held-out passage if the updated line is correct [-]."""
    verdict: Verdict
    """pass or fail by the held-out passage alone, at a level of 1 %; info without one."""
