"""Format of results.json: every number of a run in one file, from which all pages are made.

The models check the file when it is written and read. Their JSON Schema is exported.
"""

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.input_files.trust import Trust

RESULTS_SCHEMA = "pantocheck.results/1"
STATEMENT = "self-declared conformance report, in the style of EN 50318"

FiniteNumber = Annotated[float, Field(ge=-1e15, le=1e15)]
Number = FiniteNumber | list[FiniteNumber]
Owner = Annotated[str, Field(pattern="^[0-9]{1,2}$", description="number of a pantograph, 0: the line")]


class ResultsPart(BaseModel):
    """Part of results.json: numbers are finite, unknown keys are rejected."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Suite(ResultsPart):
    """Suite that graded the system."""

    version: str
    commit: str | None


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
    when the analysis section is shifted along the line. `uncertainty` is the half-width of the 95 % interval from the
    length of the record. `close` has a remark on each of these errors that exceeds the distance from the nearer limit.
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
    trust: Trust
    source: str
    margin: float | None
    discretisation_error: float | None
    spread: float | None = None
    reason: str | None
    uncertainty: float | None = None
    close: list[str] = []
    baseline: float | None = None


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


class CaseResult(ResultsPart):
    """Result of one case. Keys of `quantities`, `skipped` and `traces` are the pantographs; `0` is the line."""

    id: str
    title: str
    verdict: Verdict
    reason: str | None
    notes: list[str]
    warnings: list[str]
    inputs: list[InputGroup]
    input_digest: str
    criteria: list[Criterion]
    quantities: dict[Owner, dict[str, Number]]
    skipped: dict[Owner, dict[str, str]]
    spread: Annotated[
        dict[Owner, dict[str, float]],
        Field(
            default_factory=dict, description="largest change when the analysis section is shifted, as in `quantities`"
        ),
    ]
    uncertainty: Annotated[
        dict[Owner, dict[str, float]],
        Field(default_factory=dict, description="half-width of the 95 % interval, as in `quantities`"),
    ]
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
    trust: Trust
    started: str | None
    platform: Platform
    cases: list[CaseResult]

    def to_dict(self) -> dict[str, Any]:
        """Results as plain lists, dictionaries, text and numbers, in the order of the format."""
        return self.model_dump(mode="json", by_alias=True)

    def to_json(self) -> bytes:
        """Content of results.json; the same results give the same bytes."""
        return (json.dumps(self.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()
