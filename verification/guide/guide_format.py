"""Format of guide.json: every number of the verification and validation guide, from which its pages are made."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.core.results_part import FiniteNumber, Number, ResultsPart, Suite
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.results_format import Platform

INSIDE: tuple[Verdict, ...] = ("pass", "info")
"""Verdicts of a value inside its published range; `info`: it was imposed on the inputs, so that it does not count."""


class CheckedValue(ResultsPart):
    """Computed value beside its expected value."""

    key: str
    """Name, unique within its topic."""
    quantity: str
    unit: str
    computed: FiniteNumber
    expected: FiniteNumber
    kind: Literal["relative", "absolute"]
    """Kind of the deviation and of its tolerance."""
    deviation: FiniteNumber
    """Computed minus expected, relative or in the unit."""
    tolerance: FiniteNumber
    reason: str
    """Reason of the tolerance."""
    agrees: bool
    """Whether the deviation lies within the tolerance."""


class ConvergenceStudy(ResultsPart):
    """Errors against a step that is refined, and the observed order beside the theoretical one."""

    key: str
    """Name, unique within its topic."""
    quantity: str
    """Quantity whose error is measured."""
    parameter: str
    """Refined step with its unit."""
    steps: Annotated[list[FiniteNumber], Field(min_length=2)]
    """Steps, the coarsest first."""
    errors: Annotated[list[FiniteNumber], Field(min_length=2)]
    """Relative error at each step."""
    orders: list[FiniteNumber]
    """Order between each step and the next."""
    theory: FiniteNumber
    """Theoretical order."""
    tolerance: FiniteNumber
    """Largest difference of the last order from the theory."""
    reason: str
    """Origin of the theoretical order, and reason of the tolerance."""
    agrees: bool
    """Whether the last order lies within the tolerance."""


class Topic(ResultsPart):
    """Subject of the verification: its closed form, comparisons, convergence and figures."""

    title: str
    theory: str
    """Closed form in words, with its source."""
    setting: str
    """Line, element length and time step of the computation."""
    comparisons: list[CheckedValue] = []
    convergence: list[ConvergenceStudy] = []
    charts: list[Chart] = []


class ConvergedComparison(ResultsPart):
    """Value computed now beside the converged values of two formulations that are stored with the case."""

    quantity: str
    pantograph: int
    """Number of the pantograph; 0: the line."""
    value: FiniteNumber
    discretisation: FiniteNumber | None
    """Half-width from element length and time step."""
    first: FiniteNumber
    """Extrapolated value of the reference simulator."""
    second: FiniteNumber
    """Extrapolated value of the second formulation."""
    half_width: FiniteNumber
    """Half-width of the interval that contains both."""
    lower: FiniteNumber
    """Lower verification limit."""
    upper: FiniteNumber
    """Upper verification limit."""
    inside: bool


class LibraryCase(ResultsPart):
    """Library case run on the reference simulator of this version."""

    case: str
    title: str
    edition: str | None
    superseded_by: str | None
    input_digest: str
    quantities: dict[str, dict[str, Number]]
    published: list[Criterion]
    """Computed values against the published ranges."""
    converged: list[ConvergedComparison]
    simulated_s: FiniteNumber | None
    wall_s: FiniteNumber | None
    """Computing time of the passage."""


class PeerComparison(ResultsPart):
    """Comparison with a package of others."""

    package: str
    """Name of the package in its registry."""
    version: str | None
    """Installed version; null: not installed, so not run."""
    title: str
    setting: str
    """Computation, and parts that both programs share."""
    comparisons: list[CheckedValue] = []


class DetectedFault(ResultsPart):
    """System with a known fault, and its verdict on a case."""

    name: str
    case: str
    verdict: Verdict
    detected_by: str
    """Check that detects the fault; empty: none."""
    must_be_detected: bool
    detected: bool


class SelfTestSummary(ResultsPart):
    """Result of the self-test: faults of records, and numerical faults by the verification up to 50 Hz."""

    reference: dict[str, Verdict]
    """Verdict of the unchanged simulator by case."""
    records: list[DetectedFault]
    numerical: list[DetectedFault]


class Timing(ResultsPart):
    """Computing time of a passage."""

    case: str
    pantographs: int
    simulated_s: FiniteNumber
    process_s: FiniteNumber
    """Process time of passage and set-up, the better of two."""
    ratio: FiniteNumber
    """Process time over simulated time."""


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
    created: str
    """Date and time of the guide."""
    verification: dict[str, Topic]
    library: list[LibraryCase]
    """Library cases, in the order of the library."""
    effects: list[StoredEffect] = []
    peers: list[PeerComparison] = []
    self_test: SelfTestSummary | None = None
    performance: Performance | None = None
    limitations: list[Limitation] = []
    failed: list[FailedPart] = []
