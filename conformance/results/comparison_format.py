"""Formats of comparisons: sources, criteria, and the JSON files on static values, frequency responses and runs."""

from typing import Annotated, Literal, get_args

from pydantic import ConfigDict, Field

from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.results.figure_data import Chart
from pantocheck.conformance.results.suite_part import Suite

Range = tuple[Rounded, Rounded]
ComparedValue = Rounded | tuple[Rounded, ...]

StaticValue = Literal["elasticity", "contact_wire_height"]
"""Value measured along a line."""

HeadPoint = Literal["head_centre", "left_strip", "right_strip", "other"]
"""Point of the head: its centre, one of its contact strips, or another one."""

ResponseKind = Literal["apparent_mass", "impedance", "dynamic_stiffness", "receptance", "mobility", "accelerance"]

ComparedMotion = Literal["velocity", "acceleration"]

StaticQuantity = Literal["elasticity_difference_mm_N", "elasticity_difference_pct", "contact_wire_height_difference_mm"]
"""Largest absolute difference between model and measurement, in the unit at the end."""

ResponseQuantity = Literal[
    "modulus_deviation_pct",
    "phase_deviation_deg",
    "complex_deviation_pct",
    "largest_modulus_deviation_pct",
    "largest_phase_deviation_deg",
]
"""RMS deviation over a band, or the largest one."""

DropQuantity = Literal["rms_ratio", "correlation"]

ComparedQuantityName = StaticQuantity | ResponseQuantity | DropQuantity

STATIC_QUANTITIES: tuple[StaticQuantity, ...] = get_args(StaticQuantity)
RESPONSE_QUANTITIES: tuple[ResponseQuantity, ...] = get_args(ResponseQuantity)
DROP_QUANTITIES: tuple[DropQuantity, ...] = get_args(DropQuantity)


class ComparedSource(RoundedModel):
    """Model, record, results or system of a comparison."""

    name: Annotated[str, Field(description="title of a model, name of a table, or name of a run")]
    source: Annotated[str, Field(description="file, test report or kind of the source; empty: not stated")] = ""
    digest: Annotated[str | None, Field(description="SHA-256 of the content; null: a simulation, or not read")]


class CriterionPlace(RoundedModel):
    """Place at which a criterion of a comparison holds; a key that does not apply is null."""

    record: Annotated[str | None, Field(description="name of the table of a response; null: no such response")] = None
    static_force_N: Rounded | None = None
    height_m: Rounded | None = None
    sensor: int | None = None
    motion: ComparedMotion | None = None
    window_s: Range | None = None
    band_Hz: Range | None = None


class ComparisonCriterion(RoundedModel):
    """Difference between a model and a measurement, against a limit of the user."""

    quantity: ComparedQuantityName
    unit: str
    where: CriterionPlace
    value: Annotated[Rounded | None, Field(description="null: no measured value")]
    lower: Rounded | None
    upper: Rounded | None
    source: Annotated[str | None, Field(description="source of the limit; null: not stated")]
    verdict: Verdict
    reason: Annotated[str | None, Field(description="data that are missing, or distance beyond the limit")]
    margin: Rounded | None
    discretisation: Annotated[
        Rounded | None,
        Field(description="change of the value with half the element length and half the time step; null: not known"),
    ]
    measurement: Annotated[
        Rounded | None,
        Field(description="half-width of the 95 % interval of the value by the measurement; null: not stated"),
    ]
    close: Annotated[tuple[str, ...], Field(description="remark on a value closer to its limit than its uncertainty")]


class ModelComparison(RoundedModel):
    """Common part of the comparisons of a model with measured values."""

    model_config = ConfigDict(populate_by_name=True)

    suite: Suite
    model: Annotated[ComparedSource, Field(description="line or pantograph")]
    verdict: Annotated[Verdict, Field(description="worst verdict of the criteria; info: no limit is given")]
    criteria: tuple[ComparisonCriterion, ...]
    warnings: Annotated[tuple[str, ...], Field(description="caveats for the reader of the report")]


class SpanDifferences(RoundedModel):
    """Differences between model and measurement in one span."""

    number: Annotated[int, Field(description="number of the span, from 1")]
    start_m: Rounded
    end_m: Rounded
    values: Annotated[int, Field(description="number of measured values")]
    measured: Annotated[Range | None, Field(description="lowest and highest measured value; null: no value")]
    model: Annotated[Range | None, Field(description="lowest and highest value of the model, same positions")]
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


class StaticComparison(ModelComparison):
    """Content of static_comparison.json: static values measured along a line beside those of its model."""

    schema_: Annotated[Literal["pantocheck.static-comparison/1"], Field(alias="schema")] = (
        "pantocheck.static-comparison/1"
    )
    record: ComparedSource
    record_state: Annotated[
        Literal["unverified"], Field(description="a table of static values has no second channel that confirms it")
    ] = "unverified"
    element_m: Rounded
    force_N: Annotated[tuple[Rounded, ...], Field(description="static forces of the elasticity")]
    evaluated_spans: tuple[int, int]
    evaluated_m: Annotated[Range, Field(description="start and end of the evaluated section")]
    largest_distance_m: Rounded | None
    values: tuple[ComparedValues, ...]
    note: str | None


class BandDeviation(RoundedModel):
    """Deviations in one frequency band; empty without a measured value."""

    band_Hz: Range
    rows: Annotated[int, Field(description="number of measured values in the band")]
    missing: Annotated[str | None, Field(description="missing data; null: the band is complete")]
    deviations: Annotated[
        dict[ResponseQuantity, Rounded], Field(description="RMS and largest deviations [%, degrees]; empty: no value")
    ]
    uncertainty: Annotated[
        dict[ResponseQuantity, Rounded],
        Field(description="half-width of their 95 % intervals by the measurement; empty: not stated"),
    ]
    largest_modulus_at_Hz: Rounded | None
    largest_phase_at_Hz: Rounded | None
    beyond_uncertainty_pct: Annotated[
        Rounded | None,
        Field(description="share of deviations above the uncertainty of the measurement; 5 % with noise alone"),
    ]


class HeadResponse(RoundedModel):
    """Frequency response as modulus and phase; the phase has no jumps of 360 degrees."""

    frequency_Hz: tuple[Rounded, ...]
    modulus: Annotated[tuple[Rounded, ...], Field(description="in the unit of the response")]
    phase_deg: tuple[Rounded, ...]


class ComparedResponse(ComparedSource):
    """A measured response beside that of the model; lists have one item per measured value, by increasing frequency."""

    kind: ResponseKind
    unit: str
    static_force_N: Rounded
    height_m: Rounded | None
    excited_at: HeadPoint
    measured_at: HeadPoint
    is_graded: Annotated[bool, Field(description="force and motion at the centre of the head; others are informative")]
    note: str | None
    row: Annotated[tuple[int, ...], Field(description="row of the table, from 1 below the head line")]
    missing_rows: Annotated[tuple[int, ...], Field(description="rows without a value")]
    measured: HeadResponse
    modulus_uncertainty_pct: Annotated[
        tuple[Rounded, ...], Field(description="half-width of the 95 % interval; empty: not stated")
    ]
    phase_uncertainty_deg: Annotated[
        tuple[Rounded, ...], Field(description="half-width of the 95 % interval; empty: not stated")
    ]
    modulus_deviation_pct: Annotated[
        tuple[Rounded, ...], Field(description="100 ln of modulus of the dynamic stiffness, model over measurement")
    ]
    phase_deviation_deg: Annotated[
        tuple[Rounded, ...], Field(description="phase of the dynamic stiffness, model minus measurement")
    ]
    model: Annotated[HeadResponse, Field(description="response of the model at many frequencies")]
    bands: tuple[BandDeviation, ...]


class ResponseComparison(ModelComparison):
    """Content of response_comparison.json: measured frequency responses of a head beside those of its model."""

    schema_: Annotated[Literal["pantocheck.response-comparison/1"], Field(alias="schema")] = (
        "pantocheck.response-comparison/1"
    )
    record_state: Annotated[
        Literal["unverified"], Field(description="a frequency response has no second channel that confirms it")
    ] = "unverified"
    responses: tuple[ComparedResponse, ...]


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
