"""Format of results.json: every number of a run in one file, from which all pages are made.

The models check the file when it is written and read. Their JSON Schema is exported.
"""

import json
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field

from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.input_files.trust import Computed, Trust

RESULTS_SCHEMA = "pantocheck.results/1"
STATEMENT = "self-declared conformance report, in the style of EN 50318"

VerdictName = Literal["criteria", "verification"]
"""One of two verdicts: by the EN 50318 criteria, or by verification against the converged solution up to 50 Hz."""

RecordState = Literal["verified", "unverified", "contradicted"]
"""Result of the consistency checks of a record: confirmed, not all of them possible, or refuted."""

BASELINE = "baseline"
"""Quantity of a criterion that states why a comparison with a baseline is impossible."""

ComponentName = Literal["discretisation", "start", "section", "length"]
"""Component of an uncertainty: mesh and time step; start and run-in; place of the analysis section; record length."""

COMPONENT_NAMES: tuple[ComponentName, ...] = get_args(ComponentName)

LARGEST_RESULT = 1e15
"""Largest absolute value of a number in results.json."""

FiniteNumber = Annotated[float, Field(ge=-LARGEST_RESULT, le=LARGEST_RESULT)]
Number = FiniteNumber | list[FiniteNumber]
Owner = Annotated[str, Field(pattern="^[0-9]{1,2}$", description="number of a pantograph, 0: the line")]


class ResultsPart(BaseModel):
    """Part of results.json: numbers are finite, unknown keys are rejected."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Suite(ResultsPart):
    """Suite that graded the system."""

    version: str
    commit: str | None
    digest: Annotated[
        str | None, Field(description="SHA-256 of the installed files of the suite; null: made by an older version")
    ] = None


class SystemIdentity(ResultsPart):
    """Graded system."""

    name: str
    version: str
    kind: Literal["builtin", "record", "command"]


class Platform(ResultsPart):
    """Platform on which the run was computed."""

    python: str
    numpy: str
    scipy: str
    numba: str
    machine: str
    system: str


class InputGroup(ResultsPart):
    """Source of a group of inputs."""

    group: str
    trust: Trust
    source: str


class Criterion(ResultsPart):
    """A value against its limits. `pantograph` is 0 for the line; `item` counts droppers or modes from 1.

    `discretisation_error` is the change when element length and time step are halved. `spread` is the largest change
    when the analysis section is shifted span by span; it is not part of `uncertainty`. `uncertainty` is the half-width
    of the 95 % interval, the root of the sum of squares of `components`; before `components` existed, it was that from
    the length of the record.
    `limit_uncertainty` is that of a limit from a measured record. `close` has a remark if both combined exceed the
    distance from the nearer limit.
    `baseline` is the value of earlier results, if the limits bound the drift from it.
    """

    quantity: str
    pantograph: int
    item: int | None = None
    value: FiniteNumber | None
    unit: str
    lower: FiniteNumber | None
    upper: FiniteNumber | None
    verdict: Verdict
    trust: Trust | Computed
    source: str
    margin: float | None
    discretisation_error: float | None
    spread: float | None = None
    reason: str | None
    uncertainty: float | None = None
    components: dict[ComponentName, float] = {}
    limit_uncertainty: float = 0.0
    close: list[str] = []
    baseline: float | None = None

    @property
    def is_drift(self) -> bool:
        """Whether the criterion compares with a baseline, or states that a comparison is impossible."""
        return self.baseline is not None or self.quantity == BASELINE


class FilterFacts(ResultsPart):
    """Filter of the graded force."""

    kind: str
    order: int
    cutoff_Hz: float
    phase: str


class RunFacts(ResultsPart):
    """Computation of a case; unknown facts are null."""

    simulated_s: float | None
    wall_s: float | None
    dt_s: float | None
    element_m: float | None
    speed_km_h: float | None
    rate_Hz: float | None
    filter: FilterFacts
    evaluated_m: tuple[float, float] | None


class Spectrum(ResultsPart):
    """Single-sided amplitude spectrum of the delivered force about its mean, over the analysis section."""

    frequency_Hz: list[float]
    amplitude_N: list[float]


class Histogram(ResultsPart):
    """Share of the samples of the 20 Hz force in each class."""

    edges_N: list[float]
    share_pct: list[float]


class Traces(ResultsPart):
    """Curves of one pantograph over the analysis section."""

    position_m: list[float]
    force_N: list[float]
    force_20_N: list[float] | None
    mean_N: float
    std_N: float | None
    supports_m: list[float]
    spectrum: Spectrum
    histogram: Histogram | None


class UpliftTrace(ResultsPart):
    """Uplift of the contact wire at one support."""

    support_m: float
    time_s: list[float]
    uplift_mm: list[float]


class Series(ResultsPart):
    """Data of a chart. `boxes` draws a box plot of the values at each x; `bars` stand side by side at the ticks."""

    label: str
    style: Literal["line", "points", "boxes", "bars"]
    x: list[float]
    y: list[float]
    error: list[float] | None = None
    """Half the length of the error bar of each point."""


class Mark(ResultsPart):
    """A published value or a limit: a line across a chart, or a band if `high` is given."""

    label: str
    axis: Literal["x", "y"]
    low: float
    high: float | None = None


class Chart(ResultsPart):
    """Figure of a study."""

    caption: str
    alternative: str
    x_label: str
    y_label: str
    x_scale: Literal["linear", "log"] = "linear"
    y_scale: Literal["linear", "log"] = "linear"
    ticks: list[str] | None = None
    """Names at x = 0, 1, 2, ..."""
    series: list[Series]
    marks: list[Mark] = []
    wide: bool = True


class TextTable(ResultsPart):
    """Table of a study as text."""

    caption: str
    columns: list[str]
    rows: list[list[str]]


LibraryIdentity = Literal["identical", "modified", "own"]
"""Comparison of a case with the library: equal to a library case, other content under its id, or an own case."""

Step = Literal["pantograph_model", "static_check", "reference_models", "line_test", "limits_of_validity"]
"""Step of the procedure of EN 50318."""

STEPS: tuple[Step, ...] = get_args(Step)


class ScopeStep(ResultsPart):
    """Step of the procedure and the cases that belong to it.

    `done`: a case was graded by limits that count. `informative`: there are values, but no limit counts, or the case is
    a modified copy. `not done`: no case, or none with values for all its limits.
    """

    step: Step
    state: Literal["done", "informative", "not done"]
    cases: list[str]


def name_case(case_id: str, library: LibraryIdentity | None) -> str:
    """Name of a case in reports: its id, or `modified copy of` the library case with this id."""
    return f"modified copy of {case_id}" if library == "modified" else case_id


StartState = Literal["as in the case", "differs", "not stated"]
"""Start of a record against that of its case; `not stated` is never treated better than `as in the case`."""


class RecordFacts(ResultsPart):
    """Record of a case. Digests are SHA-256 in hexadecimal, null if unknown.

    `demanded` is false if a profile shows the state `unverified` without lowering the verdict. `digest` is that of the
    record. `case_digest` is that of the case for which the record was made, as the record states it. `measured_digest`
    is that of the measured record, if a profile compares with one. `start` compares the stated start of the record with
    that of its case, null without a case; `start_text` is the remark on it.
    """

    state: RecordState
    reason: str
    demanded: bool = True
    digest: str | None = None
    case_digest: str | None = None
    measured_digest: str | None = None
    start: StartState | None = None
    start_text: str | None = None


class CaseVerification(ResultsPart):
    """Comparison with the converged solution of the same equations, up to 50 Hz.

    The limits of its criteria are computed: they never decide the verdict by the EN 50318 criteria.
    """

    verdict: Verdict
    reason: Annotated[str | None, Field(description="reason why there are no criteria")]
    confirmed_by: Annotated[str, Field(description="second formulation that confirms the converged values")]
    digest: Annotated[str, Field(description="SHA-256 of the converged values and of the tolerances")]
    omitted: Annotated[list[str], Field(description="quantities without a confirmed value, with the reason")]
    criteria: list[Criterion]


class CaseResult(ResultsPart):
    """Result of one case. Keys of `quantities`, `skipped` and `traces` are the pantographs; `0` is the line.

    `verdict` is the worst of the requested verdicts in which the case takes part.
    """

    id: str
    title: str
    verdict: Verdict
    criteria_verdict: Annotated[
        Verdict | None, Field(description="verdict by the EN 50318 criteria; null: made by an older version")
    ] = None
    verification: Annotated[
        CaseVerification | None, Field(description="verification; null: the case has no converged values")
    ] = None
    reason: str | None
    notes: list[str]
    warnings: list[str]
    inputs: list[InputGroup]
    input_digest: str
    limits_digest: Annotated[
        str | None, Field(description="SHA-256 of the limits, those of a limits file included")
    ] = None
    stated_limits_digest: Annotated[
        str | None, Field(description="SHA-256 of the limits of the case file or profile, without a limits file")
    ] = None
    limit_changes: Annotated[
        list[str], Field(description="limits of the case file or profile that a limits file weakens")
    ] = []
    library: Annotated[
        LibraryIdentity | None,
        Field(description="comparison with the library case or profile of this name; null: made by an older version"),
    ] = None
    profile: Annotated[str | None, Field(description="name of the profile of an assessment; null: a case")] = None
    edition: Annotated[str | None, Field(description="edition of the standard that defines the case")] = None
    superseded_by: Annotated[str | None, Field(description="edition that superseded it")] = None
    steps: Annotated[list[Step], Field(description="steps of the procedure that the case belongs to")] = []
    criteria: list[Criterion]
    quantities: dict[Owner, dict[str, Number]]
    skipped: dict[Owner, dict[str, str]]
    spread: Annotated[
        dict[Owner, dict[str, float]],
        Field(
            default_factory=dict,
            description="largest change when the analysis section is shifted span by span, as in `quantities`; "
            "not part of `uncertainty`",
        ),
    ]
    uncertainty: Annotated[
        dict[Owner, dict[str, Number]],
        Field(
            default_factory=dict,
            description="half-width of the 95 % interval, as in `quantities`: root of the sum of squares of the "
            "components; without `uncertainty_components`: from the length of the record alone",
        ),
    ]
    uncertainty_components: Annotated[
        dict[Owner, dict[str, dict[ComponentName, Number]]],
        Field(
            default_factory=dict, description="half-widths by component, as in `quantities`; unknown ones are missing"
        ),
    ]
    uncertainty_basis: Annotated[
        dict[ComponentName, str],
        Field(default_factory=dict, description="how each component was determined, or why it is not known"),
    ]
    model_uncertainty: Annotated[
        list[str],
        Field(description="effects that the equations of the system leave out, with sizes; not part of `uncertainty`"),
    ] = []
    record: RecordFacts | None = None
    """Null without a record: line at rest, mass drop, or a study of several runs."""
    run: RunFacts
    traces: dict[Owner, Traces]
    uplift: list[UpliftTrace]
    charts: list[Chart] = []
    tables: list[TextTable] = []


class Results(ResultsPart):
    """Results of a run of the suite."""

    schema_: Annotated[Literal["pantocheck.results/1"], Field(alias="schema")] = "pantocheck.results/1"
    suite: Suite
    system: SystemIdentity
    statement: str = STATEMENT
    verdict: Verdict
    criteria_verdict: Annotated[
        Verdict | None, Field(description="verdict by the EN 50318 criteria; null: made by an older version")
    ] = None
    verification_verdict: Annotated[
        Verdict | None, Field(description="verdict by verification; null: no case has converged values")
    ] = None
    requested: Annotated[list[VerdictName], Field(description="verdicts that decide `verdict`, the worst of them")] = [
        "criteria"
    ]
    verification_only: Annotated[
        list[str],
        Field(description="ids of the cases without limits that count, which take part in the verification only"),
    ] = []
    trust: Trust
    started: str | None
    platform: Platform
    scope: Annotated[
        list[ScopeStep], Field(description="every step of the procedure; empty: made by an older version")
    ] = []
    information: list[str] = []
    """Ids of the cases that are shown for information: they do not take part in the verdict."""
    accepted_unverified: list[str] = []
    """Names of systems whose unverified records the user accepts."""
    cases: list[CaseResult]

    def to_dict(self) -> dict[str, Any]:
        """Results as plain lists, dictionaries, text and numbers, in the order of the format."""
        return self.model_dump(mode="json", by_alias=True)

    def to_json(self) -> bytes:
        """Content of results.json; the same results give the same bytes."""
        return (json.dumps(self.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()
