"""Format of guide.json: every number of the verification and validation guide, from which its pages are made."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.results.figure_data import Chart
from pantocheck.conformance.results.results_format import Platform
from pantocheck.conformance.results.results_part import FiniteNumber, Number, ResultsPart
from pantocheck.conformance.results.suite_part import Suite


class CheckedValue(ResultsPart):
    """Computed value beside its expected value."""

    key: Annotated[str, Field(description="name, unique within its topic")]
    quantity: str
    unit: str
    computed: FiniteNumber
    expected: FiniteNumber
    kind: Annotated[Literal["relative", "absolute"], Field(description="kind of the deviation and of its tolerance")]
    deviation: Annotated[FiniteNumber, Field(description="computed minus expected, relative or in the unit")]
    tolerance: FiniteNumber
    reason: Annotated[str, Field(description="reason of the tolerance")]
    agrees: Annotated[bool, Field(description="whether the deviation lies within the tolerance")]


class ConvergenceStudy(ResultsPart):
    """Errors against a step that is refined, and the observed order beside the theoretical one."""

    key: Annotated[str, Field(description="name, unique within its topic")]
    quantity: Annotated[str, Field(description="quantity whose error is measured")]
    parameter: Annotated[str, Field(description="refined step with its unit")]
    steps: Annotated[list[FiniteNumber], Field(min_length=2, description="steps, the coarsest first")]
    errors: Annotated[list[FiniteNumber], Field(min_length=2, description="relative error at each step")]
    orders: Annotated[list[FiniteNumber], Field(description="order between each step and the next")]
    theory: Annotated[FiniteNumber, Field(description="theoretical order")]
    tolerance: Annotated[FiniteNumber, Field(description="largest difference of the last order from the theory")]
    reason: Annotated[str, Field(description="origin of the theoretical order, and reason of the tolerance")]
    agrees: Annotated[bool, Field(description="whether the last order lies within the tolerance")]


class Topic(ResultsPart):
    """Subject of the verification: its closed form, comparisons, convergence and figures."""

    title: str
    theory: Annotated[str, Field(description="closed form in words, with its source")]
    setting: Annotated[str, Field(description="line, element length and time step of the computation")]
    comparisons: list[CheckedValue] = []
    convergence: list[ConvergenceStudy] = []
    charts: list[Chart] = []


class PublishedRange(ResultsPart):
    """Criterion of a library case: published range, and computed value with its uncertainty."""

    quantity: str
    pantograph: Annotated[int, Field(description="number of the pantograph; 0: the line")]
    item: int | None
    lower: FiniteNumber | None
    upper: FiniteNumber | None
    value: FiniteNumber | None
    uncertainty: FiniteNumber | None
    inside: Annotated[bool | None, Field(description="whether the value lies in the range; null: no value")]
    trust: Trust
    source: str
    role: Annotated[
        Literal["criterion", "imposed", "held_out"],
        Field(description="criterion, or finding of a publication: imposed on the inputs, or held out"),
    ]


class ConvergedComparison(ResultsPart):
    """Value computed now beside the converged values of two formulations that are stored with the case."""

    quantity: str
    pantograph: Annotated[int, Field(description="number of the pantograph; 0: the line")]
    value: FiniteNumber
    discretisation: Annotated[FiniteNumber | None, Field(description="half-width from element length and time step")]
    first: Annotated[FiniteNumber, Field(description="extrapolated value of the reference simulator")]
    second: Annotated[FiniteNumber, Field(description="extrapolated value of the second formulation")]
    half_width: Annotated[FiniteNumber, Field(description="half-width of the interval that contains both")]
    lower: Annotated[FiniteNumber, Field(description="lower verification limit")]
    upper: Annotated[FiniteNumber, Field(description="upper verification limit")]
    inside: bool


class LibraryCase(ResultsPart):
    """Library case run on the reference simulator of this version."""

    case: str
    title: str
    edition: str | None
    superseded_by: str | None
    input_digest: str
    quantities: dict[str, dict[str, Number]]
    published: list[PublishedRange]
    converged: list[ConvergedComparison]
    simulated_s: FiniteNumber | None
    wall_s: Annotated[FiniteNumber | None, Field(description="computing time of the passage")]


class PeerComparison(ResultsPart):
    """Comparison with a package of others."""

    package: Annotated[str, Field(description="name of the package in its registry")]
    version: Annotated[str | None, Field(description="installed version; null: not installed, so not run")]
    title: str
    setting: Annotated[str, Field(description="computation, and parts that both programs share")]
    comparisons: list[CheckedValue] = []


class DetectedFault(ResultsPart):
    """System with a known fault, and its verdict on a case."""

    name: str
    case: str
    verdict: Verdict
    detected_by: Annotated[str, Field(description="check that detects the fault; empty: none")]
    must_be_detected: bool
    detected: bool


class SelfTestSummary(ResultsPart):
    """Result of the self-test: faults of records, and numerical faults by the verification up to 50 Hz."""

    reference: Annotated[dict[str, Verdict], Field(description="verdict of the unchanged simulator by case")]
    records: list[DetectedFault]
    numerical: list[DetectedFault]


class Timing(ResultsPart):
    """Computing time of a passage."""

    case: str
    pantographs: int
    simulated_s: FiniteNumber
    process_s: Annotated[FiniteNumber, Field(description="process time of passage and set-up, the better of two")]
    ratio: Annotated[FiniteNumber, Field(description="process time over simulated time")]


class Performance(ResultsPart):
    """Computing times on this machine."""

    processor: str
    cores: int
    timings: list[Timing]


class StoredEffect(ResultsPart):
    """Effect that the equations leave out: largest stored differences from the exact three-dimensional model."""

    effect: str
    compared: str
    source: str
    relative_pct: dict[str, FiniteNumber]
    absolute: dict[str, FiniteNumber]


class Limitation(ResultsPart):
    """Known limitation of the suite."""

    title: str
    sentences: list[str]


class FailedPart(ResultsPart):
    """Part of the guide that could not be computed."""

    part: str
    reason: str


class Guide(ResultsPart):
    """Verification and validation guide of one version of the suite on one machine."""

    schema_: Annotated[Literal["pantocheck.guide/1"], Field(alias="schema")] = "pantocheck.guide/1"
    suite: Suite
    platform: Platform
    created: Annotated[str, Field(description="date and time of the guide")]
    verification: dict[str, Topic]
    library: Annotated[list[LibraryCase], Field(description="library cases, in the order of the library")]
    effects: list[StoredEffect] = []
    peers: list[PeerComparison] = []
    self_test: SelfTestSummary | None = None
    performance: Performance | None = None
    limitations: list[Limitation] = []
    failed: list[FailedPart] = []
