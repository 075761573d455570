"""Format of results.json: every number of a run in one file, from which all pages are made.

The models check the file when it is written and read. Their JSON Schema is exported.
"""

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, model_validator

from pantocheck.conformance.cases.case import CaseOrigin
from pantocheck.conformance.core.criterion import CaseVerification, ComponentName, Criterion
from pantocheck.conformance.core.decision import DecisionText
from pantocheck.conformance.core.figure_data import (
    Chart,
    ExtremePlace,
    LineShape,
    TextTable,
    Traces,
    UpliftTrace,
    check_lengths,
)
from pantocheck.conformance.core.findings import FindingCounts
from pantocheck.conformance.core.json_file import format_json
from pantocheck.conformance.core.packed_samples import SignalSamples
from pantocheck.conformance.core.results_part import Number, Owner, ResultsPart, Suite, is_empty
from pantocheck.conformance.core.sourced_table import NonNegative, Problems, cross_check, is_absent, validation_problem
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.results.case_facts_format import (
    BaselineComparison,
    ConditionFacts,
    ContactLossFacts,
    DerivedFact,
    EventFacts,
    FmuRun,
    LawForces,
    MeasuredRun,
    ReadingFacts,
    RecordFacts,
    ReferenceValues,
    SourceFacts,
    StoredValues,
)
from pantocheck.conformance.results.motion_format import PassageMotion
from pantocheck.conformance.results.procedure_format import Procedure
from pantocheck.conformance.results.supported_frequency import SupportedFrequency

STATEMENT = "self-declared conformance report, in the style of EN 50318"

VerdictName = Literal["criteria", "verification"]
"""One of two verdicts: by the EN 50318 criteria, or by verification against the converged solution up to 50 Hz."""


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
    core: str
    """Core of the time steps with its compiler; `none` without one."""
    machine: str
    system: str


class Renderer(ResultsPart):
    """Software that lays out pages and figures: with equal values, the same results give the same bytes."""

    typst: str
    matplotlib: str
    jinja2: str
    numpy: str
    fonts: str
    """SHA-256 of the fonts beside those of Typst."""
    machine: str
    system: str


class InputGroup(ResultsPart):
    """Source and values of a group of inputs; a single key has no values, because its group has them."""

    group: str
    trust: Trust
    source: str
    values: StoredValues = {}


class RunFacts(RunTable):
    """Computation of a case: facts of the system, and of the suite; unknown ones are null."""

    simulated_s: NonNegative | None
    """Simulated or assessed time [s]."""
    speed_km_h: float | None
    rate_Hz: float | None
    filter: Filter
    evaluated_m: Annotated[tuple[float, float] | None, Field(strict=False)]
    law_forces: LawForces = {}

    @cross_check
    def _check_completeness(self) -> Problems:
        for key in RunTable.model_fields:
            if key not in self.model_fields_set:
                yield validation_problem(key, f"{key} is missing", "Write null for an unknown fact.")


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


def name_case(case_id: str, library: LibraryIdentity) -> str:
    """Name of a case in reports: its id, or `modified copy of` the library case with this id."""
    return f"modified copy of {case_id}" if library == "modified" else case_id


class CaseConformity(ResultsPart):
    """Conformity of all counted values of a case together."""

    probability: Annotated[float, Field(ge=0, le=1)]
    """Share of the draws of the joint sample with every counted value inside its limits."""
    starts: Annotated[int, Field(ge=0)]
    """Number of starts that were run, that of the case included; 0: the system ran no other start."""
    passing_starts: Annotated[int, Field(ge=0)]
    """Number of these starts with every counted value inside its limits."""
    readings: dict[str, Annotated[float, Field(ge=0, le=1)]] = {}
    """The probability under each further reading of the evaluation, by its id: its values shift the joint sample."""


Quantities = dict[Owner, dict[str, Number]]
"""Values by owner and name of the quantity."""

UncertaintyComponents = dict[Owner, dict[str, dict[ComponentName, Number]]]
"""Half-widths by owner, name of the quantity and component."""


class CaseResult(ResultsPart):
    """Result of one case. Keys of `quantities`, `skipped` and `traces` are the pantographs; `0` is the line.

    `verdict` is the worst of the requested verdicts in which the case takes part, and of that by the baseline.
    `criteria` has the EN 50318 criteria and, with a baseline, those of the values that drifted from it.
    """

    id: str
    title: str
    verdict: Verdict
    criteria_verdict: Verdict | None
    """Verdict by the EN 50318 criteria; null: an assessment by a profile, or a run of a dossier."""
    verification: CaseVerification | None = None
    """Verification; null: the case has no converged values."""
    baseline: Annotated[BaselineComparison | None, Field(exclude_if=is_absent)] = None
    """Comparison with a baseline; missing: none was made."""
    reason: str | None
    notes: list[str]
    warnings: list[str]
    inputs: list[InputGroup]
    derived: list[DerivedFact] = []
    """Values that the suite derives from the inputs, and the uplift forces of its own run."""
    input_digest: str
    changes: list[str] = []
    """Inputs that were changed on the command line, with the values of the files."""
    limits_digest: str
    """SHA-256 of the limits, those of a limits file included."""
    stated_limits_digest: str
    """SHA-256 of the limits of the case file or profile, without a limits file."""
    limit_changes: list[str] = []
    """Limits of the case file or profile that a limits file weakens."""
    library: LibraryIdentity
    """Comparison with the library case or profile of this name."""
    origin: Annotated[CaseOrigin | None, Field(exclude_if=is_absent)] = None
    """Source of a case from outside; missing: the library, or not known."""
    profile: str | None = None
    """Name of the profile of an assessment; null: a case."""
    edition: str | None = None
    """Edition of the standard that defines the case."""
    superseded_by: str | None = None
    """Edition that superseded it."""
    steps: list[Step] = []
    """Steps of the procedure that the case belongs to."""
    criteria: list[Criterion]
    conformity: CaseConformity | None = None
    """Probability that all counted values lie inside their limits; null: no value has a joint sample."""
    quantities: Quantities
    readings: Annotated[list[ReadingFacts], Field(exclude_if=is_empty)] = []
    """Values under the other documented readings of the case; missing: it documents none, or there is no record."""
    skipped: dict[Owner, dict[str, str]]
    spread: Annotated[dict[Owner, dict[str, float]], Field(default_factory=dict)]
    """Largest change when the analysis section is shifted span by span, as in `quantities`; not part of
    `uncertainty`.
    """
    uncertainty: Annotated[Quantities, Field(default_factory=dict)]
    """Half-width of the 95 % interval of the joint sample, as in `quantities`."""
    uncertainty_components: Annotated[UncertaintyComponents, Field(default_factory=dict)]
    """Half-widths by component, as in `quantities`; unknown ones are missing."""
    uncertainty_basis: Annotated[dict[ComponentName, str], Field(default_factory=dict)]
    """How each component was determined, or why it is not known."""
    places: Annotated[dict[Owner, dict[str, ExtremePlace]], Field(default_factory=dict)]
    """Place of each extreme, as in `quantities`."""
    model_uncertainty: list[str] = []
    """Effects that the equations of the system leave out, with sizes; not part of `uncertainty`."""
    supported: Annotated[list[SupportedFrequency], Field(exclude_if=is_empty)] = []
    """Highest frequencies that the parts of the model support; missing: a line at rest, or no model."""
    conditions: Annotated[list[ConditionFacts], Field(exclude_if=is_empty)] = []
    """Changes of the values by inputs that are not traced or left open; missing: not computed for this case."""
    input_studies: Annotated[list[str], Field(exclude_if=is_empty)] = []
    """Sentences on errors of single inputs that the verdicts notice; missing: not computed for this case."""
    fmus: Annotated[list[FmuRun], Field(exclude_if=is_empty)] = []
    """FMUs that moved pantographs; missing: none."""
    record: RecordFacts | None = None
    """Null without a record: line at rest, mass drop, or a study of several runs."""
    run: RunFacts
    traces: dict[Owner, Traces]
    uplift: list[UpliftTrace]
    signals: Annotated[SignalSamples | None, Field(exclude_if=is_absent)] = None
    """Evaluated signals at their full rate; missing: no record with samples, or more than can be embedded."""
    charts: list[Chart] = []
    tables: list[TextTable] = []
    events: Annotated[list[EventFacts] | None, Field(exclude_if=is_absent)] = None
    """Events of the line in the analysis section; missing: none is stated."""
    sources: Annotated[list[SourceFacts], Field(exclude_if=is_empty)] = []
    """Further sources of the record with their clocks; missing: it has one file with one time."""
    contact_losses: Annotated[dict[Owner, list[ContactLossFacts]] | None, Field(exclude_if=is_absent)] = None
    """Contact losses of each pantograph, the longest 200; missing: none, or the force was filtered."""
    comparison: Annotated[MeasuredRun | None, Field(exclude_if=is_absent)] = None
    """Measured run beside this one; missing: nothing is compared."""
    line_shape: Annotated[LineShape | None, Field(exclude_if=is_absent)] = None
    """Line at rest around the analysis section; missing: not known."""
    motion: Annotated[PassageMotion | None, Field(exclude_if=is_absent)] = None
    """Moving picture of the passage on this line; missing: none was made."""
    reference: Annotated[ReferenceValues | None, Field(exclude_if=is_absent)] = None
    """Values of the reference simulator; missing: not requested."""

    @model_validator(mode="after")
    def _place_motion(self) -> Self:
        drawn = 0 if self.line_shape is None else len(self.line_shape.side.curves)
        if self.motion is not None and any(wire.curve >= drawn for wire in self.motion.wires):
            raise ValueError("motion: a wire that the shape of the line does not have")
        return self

    @model_validator(mode="after")
    def _place_reference(self) -> Self:
        for owner, force in ({} if self.reference is None else self.reference.force_20_N).items():
            if owner not in self.traces:
                raise ValueError(f"reference, pantograph {owner}: a curve without that of the case")
            check_lengths(self, self.traces[owner].position_m, force)
        return self


class Results(ResultsPart):
    """Results of a run of the suite."""

    schema_: Annotated[Literal["pantocheck.results/1"], Field(alias="schema")] = "pantocheck.results/1"
    suite: Suite
    system: SystemIdentity
    statement: str = STATEMENT
    verdict: Verdict
    criteria_verdict: Verdict | None
    """Verdict by the EN 50318 criteria; null: no case takes part in it."""
    verification_verdict: Verdict | None = None
    """Verdict by verification; null: no case has converged values."""
    baseline_verdict: Annotated[Verdict | None, Field(exclude_if=is_absent)] = None
    """Verdict by the baseline, which always counts; missing: no case was compared with one."""
    requested: list[VerdictName] = ["criteria"]
    """Verdicts that decide `verdict`, the worst of them."""
    verification_only: list[str] = []
    """Ids of the cases without limits that count, which take part in the verification only."""
    trust: Trust
    decision: DecisionText
    """Decision rule of the criteria."""
    conformity: Annotated[float | None, Field(ge=0, le=1)] = None
    """Probability that all counted values of the cases that take part lie inside their limits; null: not known."""
    started: str | None
    platform: Platform
    administration: Administration | None = None
    """Administrative data of the report; null: none were given."""
    renderer: Renderer
    """Software that made the pages."""
    scope: list[ScopeStep]
    """Every step of the procedure."""
    findings: FindingCounts | None = None
    """Findings of publications by outcome; null: the cases grade none."""
    information: list[str] = []
    """Ids of the cases that are shown for information: they do not take part in the verdict."""
    accepted_unconfirmed: list[str] = []
    """Names of systems whose unconfirmed records the user accepts."""
    procedure: Annotated[Procedure | None, Field(exclude_if=is_absent)] = None
    """Steps of the EN 50318 procedure for a dossier; missing: no dossier."""
    cases: list[CaseResult]

    @model_validator(mode="after")
    def _join_samples(self) -> Self:
        return check_lengths(self, *(row.draws for case in self.cases for row in case.criteria if row.draws))

    def to_dict(self) -> dict[str, Any]:
        """Results as plain lists, dictionaries, text and numbers, in the order of the format."""
        return self.model_dump(mode="json", by_alias=True)

    def to_json(self) -> bytes:
        """Content of results.json; the same results give the same bytes."""
        return (format_json(self.to_dict(), ascii_only=False) + "\n").encode()
