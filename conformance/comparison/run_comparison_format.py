"""Format of comparison.json: quantities and contact forces of several runs side by side."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.results.comparison_format import ComparedSource, Range
from pantocheck.conformance.results.figure_data import Chart
from pantocheck.conformance.results.suite_part import Suite

ComparedValue = Rounded | tuple[Rounded, ...]


class ComparedQuantity(RoundedModel):
    """Values of one quantity; lists have one item per subject."""

    name: str
    values: Annotated[tuple[ComparedValue | None, ...], Field(description="null: not known")]
    uncertainty: Annotated[
        tuple[ComparedValue | None, ...], Field(description="half-width of the 95 % interval; null: not known")
    ]
    difference: Annotated[
        tuple[Rounded | None, ...],
        Field(description="value minus that of the first subject; of several numbers, the largest in absolute value"),
    ]
    beyond_uncertainty: Annotated[
        tuple[bool | None, ...],
        Field(description="whether the difference exceeds the joint half-width of both values; null: not known"),
    ]


class BandAgreement(RoundedModel):
    """RMS values of the first force, of the other force, and of their difference in a frequency band."""

    low_Hz: Rounded
    high_Hz: Rounded
    first_N: Rounded
    other_N: Rounded
    difference_N: Rounded


class SpanAgreement(RoundedModel):
    """Difference of the forces in one span."""

    start_m: Rounded
    end_m: Rounded
    mean_difference_N: Rounded
    rms_difference_N: Rounded
    first_std_N: Rounded
    other_std_N: Rounded


class ForceAgreement(RoundedModel):
    """Agreement of the force of a subject with that of the first subject."""

    subject: str
    section_m: Annotated[Range, Field(description="compared stretch")]
    highest_Hz: Annotated[Rounded, Field(description="frequency up to which both forces are known")]
    correlation: Rounded
    mean_difference_N: Rounded
    rms_difference_N: Rounded
    bands: tuple[BandAgreement, ...]
    spans: tuple[SpanAgreement, ...]


class ComparedOwner(RoundedModel):
    """Comparison of one pantograph, or of the line."""

    number: Annotated[int, Field(description="number of the pantograph; 0: the line")]
    quantities: tuple[ComparedQuantity, ...]
    agreements: tuple[ForceAgreement, ...] = ()
    reasons: Annotated[tuple[str, ...], Field(description="reasons why forces were not compared")] = ()
    charts: tuple[Chart, ...] = ()


class ComparedCase(RoundedModel):
    """Comparison of one case, or of records that state no common case."""

    id: Annotated[str, Field(description="id of the case; empty: the records state none")]
    notes: tuple[str, ...]
    owners: tuple[ComparedOwner, ...]


class RunComparison(RoundedModel):
    """Content of comparison.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.comparison/1"], Field(alias="schema")] = "pantocheck.comparison/1"
    suite: Suite
    subjects: Annotated[
        tuple[ComparedSource, ...], Field(description="the first one is that with which the others are compared")
    ]
    cases: tuple[ComparedCase, ...]
