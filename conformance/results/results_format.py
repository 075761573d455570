"""results.json: every number of a run in one file, from which all pages are made.

The models are the format: what is written is checked by them, and their JSON Schema is exported.
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
    """A part of results.json; numbers are finite, unknown keys refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Suite(ResultsPart):
    """The suite that graded."""

    version: str
    commit: str | None


class SystemIdentity(ResultsPart):
    """The system that was graded."""

    name: str
    version: str
    kind: Literal["builtin", "record", "command"]


class Platform(ResultsPart):
    """What the run was computed on."""

    python: str
    numpy: str
    scipy: str
    numba: str
    machine: str
    system: str


class InputGroup(ResultsPart):
    """Where a group of inputs comes from."""

    group: str
    trust: Trust
    source: str


class Criterion(ResultsPart):
    """A value against its limits. `pantograph` is 0 for the line; `item` counts droppers or modes from 1.

    `spread` is the largest departure from the value when the evaluated stretch is shifted along the line.
    `uncertainty` is the half-width of the value's 95 % interval from the length of the record; `baseline` is the value
    of earlier results, if the limits are how far the value may have drifted from it.
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
    baseline: float | None = None


class FilterFacts(ResultsPart):
    """Filter of the graded force."""

    kind: str
    order: int
    cutoff_Hz: float
    phase: str


class RunFacts(ResultsPart):
    """How a case was computed; what a system does not say is null."""

    simulated_s: float | None
    wall_s: float | None
    dt_s: float | None
    element_m: float | None
    speed_km_h: float | None
    rate_Hz: float | None
    filter: FilterFacts
    evaluated_m: tuple[float, float] | None


class Spectrum(ResultsPart):
    """Single-sided amplitude spectrum of the delivered force about its mean, over the evaluated stretch."""

    frequency_Hz: list[float]
    amplitude_N: list[float]


class Histogram(ResultsPart):
    """Share of the samples of the 20 Hz force in each class."""

    edges_N: list[float]
    share_pct: list[float]


class Traces(ResultsPart):
    """What is drawn of one pantograph."""

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
    """Data of a chart. `boxes` draws a box of the values of each x; `bars` stand side by side at the ticks."""

    label: str
    style: Literal["line", "points", "boxes", "bars"]
    x: list[float]
    y: list[float]
    error: list[float] | None = None
    """Half the length of each point's error bar."""


class Mark(ResultsPart):
    """A value that a publication prints, or a limit: a line across a chart, or a band where `high` is given."""

    label: str
    axis: Literal["x", "y"]
    low: float
    high: float | None = None


class Chart(ResultsPart):
    """A figure of a study."""

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
    """A table of a study, ready to be printed."""

    caption: str
    columns: list[str]
    rows: list[list[str]]


class CaseResult(ResultsPart):
    """All of one case. In `quantities`, `skipped` and `traces`, the key is the pantograph, `0` the line."""

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
        Field(default_factory=dict, description="departure when the stretch is shifted, as in `quantities`"),
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
    """All of a run of the suite."""

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
        """The results as pages take them: plain lists, dictionaries, text and numbers, in the order of the format."""
        return self.model_dump(mode="json", by_alias=True)

    def to_json(self) -> bytes:
        """Content of results.json: the same results give the same bytes."""
        return (json.dumps(self.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()
