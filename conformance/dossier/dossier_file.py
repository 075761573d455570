"""Tables of a dossier: line, pantograph, parameters, reference models, line tests and claims."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.cases.profile_file import Rule
from pantocheck.conformance.comparison.comparison_limits import RESPONSES, ComparisonLimit
from pantocheck.conformance.core.decision import DecisionText
from pantocheck.conformance.core.input_error import suggest_names
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NO_TRUST,
    InputTable,
    Positive,
    Problems,
    cross_check,
    find_missing_source,
    validation_problem,
)
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.results.procedure_format import STEP_NAMES, StepName
from pantocheck.conformance.runs.system_choice import TIMEOUT_S

EntryName = Annotated[str, Field(min_length=1, max_length=100)]
NamedFile = Annotated[str, Field(min_length=1, max_length=500)]
EntryNames = Annotated[tuple[EntryName, ...], Field(strict=False, max_length=100)]
Range = Annotated[tuple[float, float], Field(strict=False)]


StaticLimit = Annotated[float, Field(gt=0, le=1e4)]
"""Tolerance of a value at rest, as the limit of a comparison."""


class StaticTolerance(InputTable):
    """Tolerances of the user for the line at rest. Elasticity and height are needed; one of the two elasticities."""

    elasticity_mm_N: StaticLimit | None = None
    """Largest difference between model and measurement [mm/N]."""
    elasticity_pct: StaticLimit | None = None
    """Largest difference between model and measurement, relative to the measured elasticity [%]."""
    height_mm: StaticLimit | None = None
    """Largest difference of the contact wire height [mm]."""
    trust: Trust = NO_TRUST
    """Trust in these tolerances."""
    source: Annotated[str | list[str], Field(max_length=500)] = NO_SOURCE
    """Source of these tolerances."""

    @cross_check
    def _check_source(self) -> Problems:
        yield from find_missing_source(self.trust, self.source)


class LineEntry(InputTable):
    """Line under validation, with its values measured at rest."""

    name: EntryName
    """Name by which runs and claims refer to the line."""
    file: NamedFile
    """Line file, beside the dossier or in the library."""
    statics: NamedFile | None = None
    """Measured elasticities and contact wire heights: sidecar or table."""
    element_m: Annotated[float, Field(ge=0.05, le=5)] = 0.5
    """Element length of the static check [m]."""
    tolerance: StaticTolerance = StaticTolerance()


class PantographEntry(InputTable):
    """Pantograph under validation, with its measured frequency responses and the limits of the user."""

    name: EntryName
    """Name by which runs and claims refer to the pantograph."""
    file: NamedFile
    """Pantograph file, beside the dossier or in the library."""
    responses: Annotated[tuple[NamedFile, ...], Field(strict=False, max_length=50)] = ()
    """Measured frequency responses: sidecars or tables."""
    limit: Annotated[tuple[ComparisonLimit, ...], Field(strict=False, max_length=100)] = ()
    """Limits of their deviations."""
    trust: Trust = NO_TRUST
    """Trust in these limits."""

    @cross_check
    def _check_sources(self) -> Problems:
        for i, limit in enumerate(self.limit, 1):
            if limit.kind is not RESPONSES:
                yield validation_problem(
                    f"limit[{i}].quantity",
                    f"{limit.quantity!r} does not belong to a response",
                    f"Give one of {', '.join(RESPONSES.quantities)}.",
                )
            if self.trust != NO_TRUST and limit.source == NO_SOURCE:
                yield validation_problem(
                    f"limit[{i}].source", f"missing, although the trust is {self.trust!r}", "Name the source."
                )


class ParameterTable(InputTable):
    """Declared simulation parameters of the system: numbers bound the values of all runs, texts describe."""

    element_m: Positive | str | None = None
    """Largest element length [m], or a description of the mesh."""
    time_step_s: Positive | str | None = None
    """Largest time step [s], or a description of the steps."""
    shortest_run_s: Positive | None = None
    """Shortest simulated time of a run [s]."""
    start: Annotated[str | None, Field(max_length=1000)] = None
    """Start of the runs, in words."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Reason for these choices."""


class ReferenceTable(InputTable):
    """Reference models that the system runs."""

    cases: Annotated[tuple[EntryName, ...], Field(strict=False, max_length=1000)] = ()
    """Ids, globs or paths of cases."""
    limits: NamedFile | None = None
    """File of limits that replace or extend those of the cases, as for `run`."""
    verdicts: Literal["criteria", "both"] | None = None
    """Verdicts that decide; default: criteria for the builtin system, both for any other."""


class LineTestTable(InputTable):
    """Tolerances and settings of the line tests."""

    speed_tolerance_pct: Annotated[float, Field(gt=0, le=50)] = 5.0
    """Largest difference of the speeds, and from the nominal speed [%]."""
    filter: Filter = Filter()
    tolerance: Annotated[tuple[Rule, ...], Field(strict=False, max_length=100)] = ()
    """Tolerances around the measured value; default: profile line-test."""

    @cross_check
    def _check_tolerances(self) -> Problems:
        for i, rule in enumerate(self.tolerance, 1):
            if not rule.compares:
                yield validation_problem(
                    f"tolerance[{i}]",
                    f"the bounds of {rule.quantity} are not a tolerance on the measured value",
                    "Give tolerance or tolerance_pct.",
                )


def find_range_problem(key: str, limits: tuple[float, float] | None) -> Problems:
    """Problem of a range whose first value is above the second."""
    if limits is not None and limits[0] > limits[1]:
        yield validation_problem(
            key, f"the first value, {limits[0]:g}, is above the second, {limits[1]:g}", "Give the smaller value first."
        )


class ChangeClaim(InputTable):
    """Claim that the validation holds for other values of an input."""

    key: EntryName
    """Input as for --set, e.g. line.contact_wire.tension_N."""
    range: Range
    """Smallest and largest value."""

    @cross_check
    def _check_range(self) -> Problems:
        yield from find_range_problem("range", self.range)


class ValidityTable(InputTable):
    """Range of validity that is claimed. A claim outside the conditions of the passed runs is not verified."""

    speed_km_h: Range | None = None
    """Lowest and highest speed [km/h]."""
    spacing_m: Range | None = None
    """Smallest and largest distance of two successive pantographs [m]."""
    lines: EntryNames = ()
    """Names of the lines in this dossier."""
    pantographs: EntryNames = ()
    """Names of the pantographs in this dossier."""
    change: Annotated[tuple[ChangeClaim, ...], Field(strict=False, max_length=100)] = ()
    """Changed inputs with their ranges."""

    @cross_check
    def _check_ranges(self) -> Problems:
        yield from find_range_problem("speed_km_h", self.speed_km_h)
        yield from find_range_problem("spacing_m", self.spacing_m)

    @property
    def claims_nothing(self) -> bool:
        """Whether no claim is made."""
        return not any((self.speed_km_h, self.spacing_m, self.lines, self.pantographs, self.change))


# Pairs of a dossier: a simulated run and the measured run of the same passage.
class CaseRun(InputTable):
    """Simulated run: a case that the system under test runs."""

    case: EntryName
    """Id or path of a case."""
    direction: EntryName
    """Direction of the train, in any words that both runs share."""


class RecordRun(InputTable):
    """Run in a record, simulated by the system under test or measured."""

    record: NamedFile
    """record: its sidecar or its table."""
    line: EntryName
    """Name of the line in this dossier."""
    pantographs: Annotated[EntryNames, Field(min_length=1)]
    """Names of the pantographs in running order."""
    direction: EntryName
    """Direction of the train, in any words that both runs share."""


def _kind_of_run(run: object) -> str:
    """Kind of a simulated run, which pydantic validates and reports alone."""
    if isinstance(run, dict):
        return "RecordRun" if "record" in run else "CaseRun"
    return type(run).__name__


SimulatedSource = Annotated[
    Annotated[CaseRun, Tag("CaseRun")] | Annotated[RecordRun, Tag("RecordRun")], Discriminator(_kind_of_run)
]


class PairTable(InputTable):
    """Simulated run and measured run of the same passage."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]+$", max_length=100)]
    """Name of the pair."""
    simulated: SimulatedSource
    """A case that the system runs, or a record."""
    measured: RecordRun


# Dossier: everything that the EN 50318 procedure needs for one simulator and one line, in one TOML file.
class DossierFile(InputTable):
    """Dossier of the EN 50318 procedure."""

    schema_: Annotated[Literal["pantocheck.dossier/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.dossier/1"."""
    title: Annotated[str, Field(min_length=1, max_length=200)]
    """Title of the certificate."""
    system: Annotated[str, Field(max_length=2000)]
    """Builtin, record:DIR or command:PROGRAM ARGUMENTS."""
    timeout_s: Annotated[float, Field(gt=0)] = TIMEOUT_S
    """Time limit of a program for a case [s]."""
    trust: Trust = "secondary"
    """Lowest trust of the limits and tolerances that count."""
    decision: DecisionText = "simple"
    """Decision rule: simple, guarded, or shared-risk: and the largest accepted risk."""
    required: Annotated[tuple[StepName, ...], Field(strict=False, min_length=1)] = STEP_NAMES
    """Steps that decide the verdict; the others are for information."""
    accept_unconfirmed: EntryNames = ()
    """Names of systems whose unconfirmed records may pass."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""
    pantograph: Annotated[tuple[PantographEntry, ...], Field(strict=False, max_length=20)] = ()
    line: Annotated[tuple[LineEntry, ...], Field(strict=False, max_length=20)] = ()
    parameters: ParameterTable = ParameterTable()
    reference: ReferenceTable = ReferenceTable()
    line_test: LineTestTable = LineTestTable()
    pair: Annotated[tuple[PairTable, ...], Field(strict=False, max_length=1000)] = ()
    validity: ValidityTable = ValidityTable()

    @cross_check
    def _check_names(self) -> Problems:
        tables: tuple[tuple[str, Sequence[Any]], ...] = (
            ("pantograph", self.pantograph), ("line", self.line), ("pair", self.pair)
        )  # fmt: skip
        for key, entries in tables:
            counts = Counter(entry.name for entry in entries)
            for i, entry in enumerate(entries, 1):
                if counts[entry.name] > 1:
                    yield validation_problem(
                        f"{key}[{i}].name",
                        f"{entry.name!r} occurs {counts[entry.name]} times",
                        "Give each its own name.",
                    )

    @cross_check
    def _check_references(self) -> Problems:
        lines, pantographs = ([entry.name for entry in entries] for entries in (self.line, self.pantograph))
        for key, name, kind in self._list_references():
            known = lines if kind == "line" else pantographs
            if name not in known:
                hint = suggest_names(name, known) if known else f"Add a table [[{kind}]] with this name."
                yield validation_problem(key, f"there is no {kind} {name!r} in this dossier", hint)

    def _list_references(self) -> Iterator[tuple[str, str, str]]:
        """Key, name and kind of every reference to a line or pantograph of the dossier."""
        for i, pair in enumerate(self.pair, 1):
            for key, run in (("simulated", pair.simulated), ("measured", pair.measured)):
                if isinstance(run, RecordRun):
                    yield f"pair[{i}].{key}.line", run.line, "line"
                    for k, name in enumerate(run.pantographs, 1):
                        yield f"pair[{i}].{key}.pantographs[{k}]", name, "pantograph"
        for k, name in enumerate(self.validity.lines, 1):
            yield f"validity.lines[{k}]", name, "line"
        for k, name in enumerate(self.validity.pantographs, 1):
            yield f"validity.pantographs[{k}]", name, "pantograph"
