"""Format of static_comparison.json: static values measured along a line beside those of its model."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.comparison.static_record import StaticValue
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.results.suite_part import Suite


class SpanDifferences(RoundedModel):
    """Differences between model and measurement in one span."""

    number: Annotated[int, Field(description="number of the span, from 1")]
    start_m: Rounded
    end_m: Rounded
    values: Annotated[int, Field(description="number of measured values")]
    measured: Annotated[
        tuple[Rounded, Rounded] | None, Field(description="lowest and highest measured value; null: no value")
    ]
    model: Annotated[
        tuple[Rounded, Rounded] | None, Field(description="lowest and highest value of the model, same positions")
    ]
    mean_difference: Annotated[Rounded | None, Field(description="mean of model minus measurement")]
    largest_difference: Annotated[Rounded | None, Field(description="model minus measurement where it is largest")]


class ComparedValues(RoundedModel):
    """Measured values of one kind beside those of the model, in one unit; lists have one item per measured value."""

    name: StaticValue
    unit: Literal["mm/N", "mm"]
    row: Annotated[tuple[int, ...], Field(description="row of the table, from 1 below the head line")]
    position_m: tuple[Rounded, ...]
    measured: tuple[Rounded, ...]
    model: tuple[Rounded, ...]
    difference: Annotated[tuple[Rounded, ...], Field(description="model minus measurement")]
    missing_rows: Annotated[tuple[int, ...], Field(description="rows without this value")]
    outlier_rows: Annotated[
        tuple[int, ...], Field(description="rows whose difference lies far from that of the other rows; they count")
    ]
    mean_difference: Annotated[Rounded, Field(description="mean of model minus measurement, evaluated section")]
    rms_difference: Annotated[Rounded, Field(description="RMS of model minus measurement, evaluated section")]
    spans: tuple[SpanDifferences, ...]
    curve_position_m: Annotated[tuple[Rounded, ...], Field(description="positions along the spans with values")]
    curve: Annotated[tuple[Rounded, ...], Field(description="values of the model at these positions")]


class StaticCriterion(RoundedModel):
    """Largest difference between model and measurement in the evaluated section, against the tolerance of the user."""

    quantity: str
    unit: str
    value: Annotated[Rounded | None, Field(description="largest absolute difference; null: no measured value")]
    tolerance: Rounded
    verdict: Verdict
    reason: Annotated[str | None, Field(description="data that are missing, or distance beyond the tolerance")]
    margin: Rounded | None
    discretisation: Annotated[Rounded | None, Field(description="change of the value with elements of half the length")]
    measurement: Annotated[
        Rounded, Field(description="half-width of the 95 % interval of a measured value; 0: unknown")
    ]
    close: Annotated[
        tuple[str, ...], Field(description="remark on a value closer to its tolerance than its uncertainty")
    ]


class StaticComparison(RoundedModel):
    """Content of static_comparison.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.static-comparison/1"], Field(alias="schema")] = (
        "pantocheck.static-comparison/1"
    )
    suite: Suite
    line: Annotated[str, Field(description="title of the line")]
    line_digest: Annotated[str, Field(description="SHA-256 of the content of the line file")]
    record: Annotated[str, Field(description="name of the table")]
    record_digest: Annotated[str, Field(description="SHA-256 of sidecar and table")]
    record_state: Annotated[
        Literal["unverified"], Field(description="a table of static values has no second channel that confirms it")
    ] = "unverified"
    verdict: Annotated[Verdict, Field(description="worst verdict of the criteria; info: no tolerance is given")]
    element_m: Rounded
    force_N: Annotated[tuple[Rounded, ...], Field(description="static forces of the elasticity")]
    evaluated_spans: tuple[int, int]
    evaluated_m: Annotated[tuple[Rounded, Rounded], Field(description="start and end of the evaluated section")]
    largest_distance_m: Rounded | None
    values: tuple[ComparedValues, ...]
    criteria: tuple[StaticCriterion, ...]
    note: str | None
