"""Format of response_comparison.json: measured frequency responses of a pantograph head beside those of its model."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.comparison.response_deviation import ResponseQuantity
from pantocheck.conformance.comparison.response_kinds import ResponseKind
from pantocheck.conformance.comparison.response_sidecar import HeadPoint
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel
from pantocheck.conformance.results.suite_part import Suite

BandEdges = tuple[Rounded, Rounded]


class BandDeviation(RoundedModel):
    """Deviations in one frequency band; empty without a measured value."""

    band_Hz: BandEdges
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


class ComparedResponse(RoundedModel):
    """A measured response beside that of the model; lists have one item per measured value, by increasing frequency."""

    name: Annotated[str, Field(description="name of the table")]
    digest: Annotated[str, Field(description="SHA-256 of sidecar and table")]
    kind: ResponseKind
    unit: str
    static_force_N: Rounded
    height_m: Rounded | None
    excited_at: HeadPoint
    measured_at: HeadPoint
    is_graded: Annotated[bool, Field(description="force and motion at the centre of the head; others are informative")]
    source: Annotated[str, Field(description="test report, test rig and date")]
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


class ResponseCriterion(RoundedModel):
    """Deviation of the model in one band, against a limit of the user."""

    quantity: ResponseQuantity
    unit: Literal["%", "°"]
    band_Hz: BandEdges
    response: Annotated[str | None, Field(description="name of the table; null: no such response")]
    static_force_N: Rounded
    height_m: Rounded | None
    value: Rounded | None
    upper: Rounded
    source: Annotated[str, Field(description="source of the limit")]
    verdict: Verdict
    reason: Annotated[str | None, Field(description="missing data, or distance beyond the limit")]
    margin: Rounded | None
    measurement: Annotated[
        Rounded | None,
        Field(description="half-width of the 95 % interval of the value by the measurement; null: not stated"),
    ]
    close: Annotated[tuple[str, ...], Field(description="remark on a value closer to its limit than its uncertainty")]


class ResponseComparison(RoundedModel):
    """Content of response_comparison.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.response-comparison/1"], Field(alias="schema")] = (
        "pantocheck.response-comparison/1"
    )
    suite: Suite
    pantograph: Annotated[str, Field(description="title of the pantograph")]
    pantograph_digest: Annotated[str, Field(description="SHA-256 of the content of the pantograph file")]
    record_state: Annotated[
        Literal["unverified"], Field(description="a frequency response has no second channel that confirms it")
    ] = "unverified"
    verdict: Annotated[Verdict, Field(description="worst verdict of the criteria; info: no limit is given")]
    responses: tuple[ComparedResponse, ...]
    criteria: tuple[ResponseCriterion, ...]
    warnings: Annotated[tuple[str, ...], Field(description="caveats for the reader of the report")]
