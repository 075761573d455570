"""Formats of comparisons: sources, criteria, and the JSON files on static values, frequency responses and runs."""

from typing import Annotated, Literal, get_args

from pydantic import Field, WrapSerializer

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.core.json_file import Rounded, RoundedModel, round_tree
from pantocheck.conformance.core.results_part import Suite
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.pantograph.response_record import HeadPoint, ResponseKind
from pantocheck.conformance.results.motion_format import LineScene
from pantocheck.conformance.results.supported_frequency import SupportedFrequency

NumberPair = tuple[Rounded, Rounded]
ComparedValue = Rounded | tuple[Rounded, ...]

StaticValue = Literal["elasticity", "contact_wire_height"]
"""Value measured along a line."""

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

    name: str
    """Title of a model, name of a table, or name of a run."""
    source: str = ""
    """File, test report or kind of the source; empty: not stated."""
    digest: str | None
    """SHA-256 of the content; null: a simulation, or not read."""


RoundedCriterion = Annotated[Criterion, WrapSerializer(lambda criterion, dump: round_tree(dump(criterion)))]
"""Difference between a model and a measurement, against a limit of the user.

Its components are the change of the value with half the element length and half the time step. Its `limit_uncertainty`
is the half-width of the 95 % interval of the value by the measurement."""


class ModelComparison(RoundedModel):
    """Common part of the comparisons of a model with measured values."""

    suite: Suite
    model: ComparedSource
    """Line or pantograph."""
    verdict: Verdict
    """Worst verdict of the criteria; info: no limit is given."""
    criteria: tuple[RoundedCriterion, ...]
    warnings: tuple[str, ...]
    """Caveats for the reader of the report."""


class SpanDifferences(RoundedModel):
    """Differences between model and measurement in one span."""

    number: int
    """Number of the span, from 1."""
    start_m: Rounded
    end_m: Rounded
    values: int
    """Number of measured values."""
    measured: NumberPair | None
    """Lowest and highest measured value; null: no value."""
    model: NumberPair | None
    """Lowest and highest value of the model, same positions."""
    mean_difference: Rounded | None
    """Mean of model minus measurement."""
    largest_difference: Rounded | None
    """Model minus measurement where it is largest."""


class ComparedValues(RoundedModel):
    """Measured values of one kind beside those of the model, in one unit; lists have one item per measured value."""

    name: StaticValue
    unit: Literal["mm/N", "mm"]
    row: tuple[int, ...]
    """Row of the table, from 1 below the head line."""
    position_m: tuple[Rounded, ...]
    measured: tuple[Rounded, ...]
    model: tuple[Rounded, ...]
    difference: tuple[Rounded, ...]
    """Model minus measurement."""
    missing_rows: tuple[int, ...]
    """Rows without this value."""
    outlier_rows: tuple[int, ...]
    """Rows whose difference lies far from that of the other rows; they count."""
    mean_difference: Rounded | None
    """Mean of model minus measurement, evaluated section; null: no value in it."""
    rms_difference: Rounded | None
    """RMS of model minus measurement, evaluated section; null: no value in it."""
    spans: tuple[SpanDifferences, ...]
    curve_position_m: tuple[Rounded, ...]
    """Positions along the spans with values."""
    curve: tuple[Rounded, ...]
    """Values of the model at these positions."""


class StaticComparison(ModelComparison):
    """Content of static_comparison.json: static values measured along a line beside those of its model."""

    schema_: Annotated[Literal["pantocheck.static-comparison/1"], Field(alias="schema")] = (
        "pantocheck.static-comparison/1"
    )
    record: ComparedSource
    record_state: Literal["unconfirmed"] = "unconfirmed"
    """State of the record: static values have no second channel that confirms them."""
    element_m: Rounded
    force_N: tuple[Rounded, ...]
    """Static forces of the elasticity."""
    evaluated_spans: tuple[int, int]
    evaluated_m: NumberPair
    """Start and end of the evaluated section."""
    largest_distance_m: Rounded | None
    values: tuple[ComparedValues, ...]
    note: str | None


class BandDeviation(RoundedModel):
    """Deviations in one frequency band; empty without a measured value."""

    band_Hz: NumberPair
    rows: int
    """Number of measured values in the band."""
    missing: str | None
    """Missing data; null: the band is complete."""
    deviations: dict[ResponseQuantity, Rounded]
    """RMS and largest deviations [%, degrees]; empty: no value."""
    uncertainty: dict[ResponseQuantity, Rounded]
    """Half-width of their 95 % intervals by the measurement; empty: not stated."""
    largest_modulus_at_Hz: Rounded | None
    largest_phase_at_Hz: Rounded | None
    beyond_uncertainty_pct: Rounded | None
    """Share of deviations above the uncertainty of the measurement; 5 % with noise alone."""


class HeadResponse(RoundedModel):
    """Frequency response as modulus and phase; the phase has no jumps of 360 degrees."""

    frequency_Hz: tuple[Rounded, ...]
    modulus: tuple[Rounded, ...]
    """In the unit of the response."""
    phase_deg: tuple[Rounded, ...]


class ComparedResponse(ComparedSource):
    """A measured response beside that of the model; lists have one item per measured value, by increasing frequency."""

    kind: ResponseKind
    unit: str
    static_force_N: Rounded
    height_m: Rounded | None
    excited_at: HeadPoint
    measured_at: HeadPoint
    is_graded: bool
    """Force and motion at the centre of the head; others are informative."""
    note: str | None
    row: tuple[int, ...]
    """Row of the table, from 1 below the head line."""
    missing_rows: tuple[int, ...]
    """Rows without a value."""
    measured: HeadResponse
    modulus_uncertainty_pct: tuple[Rounded, ...]
    """Half-width of the 95 % interval; empty: not stated."""
    phase_uncertainty_deg: tuple[Rounded, ...]
    """Half-width of the 95 % interval; empty: not stated."""
    modulus_deviation_pct: tuple[Rounded, ...]
    """100 ln of modulus of the dynamic stiffness, model over measurement."""
    phase_deviation_deg: tuple[Rounded, ...]
    """Phase of the dynamic stiffness, model minus measurement."""
    model: HeadResponse
    """Response of the model at many frequencies."""
    bands: tuple[BandDeviation, ...]
    supported_to_Hz: Rounded | None = None
    """Highest frequency up to which this response supports the model; null: not even the first rows do."""


class ResponseComparison(ModelComparison):
    """Content of response_comparison.json: measured frequency responses of a head beside those of its model."""

    schema_: Annotated[Literal["pantocheck.response-comparison/1"], Field(alias="schema")] = (
        "pantocheck.response-comparison/1"
    )
    record_state: Literal["unconfirmed"] = "unconfirmed"
    """A frequency response has no second channel that confirms it."""
    responses: tuple[ComparedResponse, ...]

    @property
    def supported_to_Hz(self) -> float | None:
        """Highest frequency that every response at the centre of the head supports; None: one supports none."""
        highest = [response.supported_to_Hz or 0.0 for response in self.responses if response.is_graded]
        return min(highest, default=0.0) or None


class ComparedQuantity(RoundedModel):
    """Values of one quantity; lists have one item per subject."""

    name: str
    values: tuple[ComparedValue | None, ...]
    """null: not known."""
    uncertainty: tuple[ComparedValue | None, ...]
    """Half-width of the 95 % interval; null: not known."""
    difference: tuple[Rounded | None, ...]
    """Value minus that of the first subject; of several numbers, the largest in absolute value."""
    beyond_uncertainty: tuple[bool | None, ...]
    """Whether the difference exceeds the joint half-width of both values; null: not known."""


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
    section_m: NumberPair
    """Compared stretch."""
    highest_Hz: Rounded
    """Frequency up to which both forces are known."""
    correlation: Rounded
    mean_difference_N: Rounded
    rms_difference_N: Rounded
    bands: tuple[BandAgreement, ...]
    spans: tuple[SpanAgreement, ...]


class ComparedOwner(RoundedModel):
    """Comparison of one pantograph, or of the line."""

    number: int
    """Number of the pantograph; 0: the line."""
    quantities: tuple[ComparedQuantity, ...]
    agreements: tuple[ForceAgreement, ...] = ()
    reasons: tuple[str, ...] = ()
    """Reasons why forces were not compared."""
    charts: tuple[Chart, ...] = ()


class ComparedCase(RoundedModel):
    """Comparison of one case, or of records that state no common case."""

    id: str
    """Id of the case; empty: the records state none."""
    notes: tuple[str, ...]
    supported: tuple[tuple[SupportedFrequency, ...], ...] = ()
    """Highest frequencies that the parts of the model of each subject support; empty for a record."""
    owners: tuple[ComparedOwner, ...]


class RunComparison(RoundedModel):
    """Content of comparison.json."""

    schema_: Annotated[Literal["pantocheck.comparison/1"], Field(alias="schema")] = "pantocheck.comparison/1"
    suite: Suite
    subjects: tuple[ComparedSource, ...]
    """The first one is that with which the others are compared."""
    cases: tuple[ComparedCase, ...]
    scenes: Annotated[tuple[LineScene, ...], Field(exclude_if=lambda scenes: not scenes)] = ()
    """Passages of the subjects over each other; missing: fewer than two subjects of a case have shapes of wires."""
