"""Tables of a dossier: line, pantograph, parameters, reference models, line tests and claims."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.cases.case_file import Filter
from pantocheck.conformance.cases.profile_file import Rule
from pantocheck.conformance.comparison.comparison_limits import RESPONSES, ComparisonLimit
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import (
    NO_SOURCE,
    NO_TRUST,
    InputTable,
    Positive,
    find_missing_source,
    validation_problem,
)
from pantocheck.conformance.input_files.trust import Trust

EntryName = Annotated[str, Field(min_length=1, max_length=100)]
NamedFile = Annotated[str, Field(min_length=1, max_length=500)]
EntryNames = Annotated[tuple[EntryName, ...], Field(strict=False, max_length=100)]
Range = Annotated[tuple[float, float], Field(strict=False)]


class StaticTolerance(InputTable):
    """Tolerances of the user for the line at rest. Elasticity and height are needed; one of the two elasticities."""

    elasticity_mm_N: Annotated[
        Positive | None, Field(description="largest difference between model and measurement [mm/N]")
    ] = None
    elasticity_pct: Annotated[
        Positive | None, Field(description="the same, relative to the measured elasticity [%]")
    ] = None
    height_mm: Annotated[Positive | None, Field(description="largest difference of the contact wire height [mm]")] = (
        None
    )
    trust: Annotated[Trust, Field(description="trust in these tolerances")] = NO_TRUST
    source: Annotated[str | list[str], Field(description="source of these tolerances", max_length=500)] = NO_SOURCE

    @cross_check
    def _check_source(self) -> Problems:
        yield from find_missing_source(self.trust, self.source)


class LineEntry(InputTable):
    """Line under validation, with its values measured at rest."""

    name: Annotated[EntryName, Field(description="name by which runs and claims refer to the line")]
    file: Annotated[NamedFile, Field(description="line file, beside the dossier or in the library")]
    statics: Annotated[
        NamedFile | None, Field(description="measured elasticities and contact wire heights: sidecar or table")
    ] = None
    element_m: Annotated[float, Field(ge=0.05, le=5, description="element length of the static check [m]")] = 0.5
    tolerance: StaticTolerance = StaticTolerance()


class PantographEntry(InputTable):
    """Pantograph under validation, with its measured frequency responses and the limits of the user."""

    name: Annotated[EntryName, Field(description="name by which runs and claims refer to the pantograph")]
    file: Annotated[NamedFile, Field(description="pantograph file, beside the dossier or in the library")]
    responses: Annotated[
        tuple[NamedFile, ...],
        Field(strict=False, max_length=50, description="measured frequency responses: sidecars or tables"),
    ] = ()
    limit: Annotated[
        tuple[ComparisonLimit, ...], Field(strict=False, max_length=100, description="limits of their deviations")
    ] = ()
    trust: Annotated[Trust, Field(description="trust in these limits")] = NO_TRUST

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

    element_m: Annotated[
        Positive | str | None, Field(description="largest element length [m], or a description of the mesh")
    ] = None
    time_step_s: Annotated[
        Positive | str | None, Field(description="largest time step [s], or a description of the steps")
    ] = None
    shortest_run_s: Annotated[Positive | None, Field(description="shortest simulated time of a run [s]")] = None
    start: Annotated[str | None, Field(max_length=1000, description="start of the runs, in words")] = None
    note: Annotated[str | None, Field(max_length=4000, description="reason for these choices")] = None


class ReferenceTable(InputTable):
    """Reference models that the system runs."""

    cases: Annotated[
        tuple[EntryName, ...], Field(strict=False, max_length=1000, description="ids, globs or paths of cases")
    ] = ()
    limits: Annotated[
        NamedFile | None, Field(description="file of limits that replace or extend those of the cases, as for `run`")
    ] = None
    verdicts: Annotated[
        Literal["criteria", "both"] | None,
        Field(description="verdicts that decide; default: criteria for the builtin system, both for any other"),
    ] = None


class LineTestTable(InputTable):
    """Tolerances and settings of the line tests."""

    speed_tolerance_pct: Annotated[
        float, Field(gt=0, le=50, description="largest difference of the speeds, and from the nominal speed [%]")
    ] = 5.0
    filter: Filter = Filter()
    tolerance: Annotated[
        tuple[Rule, ...],
        Field(
            strict=False, max_length=100, description="tolerances around the measured value; default: profile line-test"
        ),
    ] = ()

    @cross_check
    def _check_tolerances(self) -> Problems:
        for i, rule in enumerate(self.tolerance, 1):
            if not rule.compares:
                yield validation_problem(
                    f"tolerance[{i}]",
                    f"the bounds of {rule.quantity} are no tolerance on the measured value",
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

    key: Annotated[EntryName, Field(description="input as for --set, e.g. line.contact_wire.tension_N")]
    range: Annotated[Range, Field(description="smallest and largest value")]

    @cross_check
    def _check_range(self) -> Problems:
        yield from find_range_problem("range", self.range)


class ValidityTable(InputTable):
    """Range of validity that is claimed. A claim outside the conditions of the passed runs is not verified."""

    speed_km_h: Annotated[Range | None, Field(description="lowest and highest speed [km/h]")] = None
    spacing_m: Annotated[
        Range | None, Field(description="smallest and largest distance of two successive pantographs [m]")
    ] = None
    lines: Annotated[EntryNames, Field(description="names of the lines in this dossier")] = ()
    pantographs: Annotated[EntryNames, Field(description="names of the pantographs in this dossier")] = ()
    change: Annotated[
        tuple[ChangeClaim, ...], Field(strict=False, max_length=100, description="changed inputs with their ranges")
    ] = ()

    @cross_check
    def _check_ranges(self) -> Problems:
        yield from find_range_problem("speed_km_h", self.speed_km_h)
        yield from find_range_problem("spacing_m", self.spacing_m)

    @property
    def claims_nothing(self) -> bool:
        """Whether no claim is made."""
        return not any((self.speed_km_h, self.spacing_m, self.lines, self.pantographs, self.change))
