"""Case files: line, pantographs, analysis section and limits."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.study_tables import MassDrop, Study
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    PositiveList,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.pantograph.force_law import FASTEST_KM_H, LARGEST_FORCE_N
from pantocheck.conformance.quantities.filters import Filter

FileName = Annotated[str, Field(min_length=1, max_length=500)]


PantographName = Annotated[FileName, Field(description="pantograph file, relative to the case file")]


class PantographUse(SourcedTable):
    """Pantograph of a run, with a stated force."""

    model: PantographName
    uplift_force_N: Annotated[float | None, Field(gt=0, le=LARGEST_FORCE_N)] = None
    """Constant uplift force, or start value of its tuning to the mean force [N]."""
    target_mean_force_N: Annotated[float | None, Field(gt=0, le=LARGEST_FORCE_N)] = None
    """Mean contact force to which the uplift force is tuned [N]."""

    @cross_check
    def _has_a_force(self) -> Problems:
        if self.uplift_force_N is None and self.target_mean_force_N is None:
            yield validation_problem(
                "uplift_force_N",
                "missing",
                "Give uplift_force_N, or target_mean_force_N for an uplift force tuned to a mean force, or force_from "
                '= "law" for the force law of the pantograph.',
            )


class PantographByLaw(SourcedTable):
    """Pantograph of a run, with the force law of its file at the speed of the case."""

    model: PantographName
    force_from: Literal["law"]
    """law: mean contact force or applied forces from the file of the pantograph."""

    @model_validator(mode="before")
    @classmethod
    def _states_no_force(cls, content: Any) -> Any:
        for key in ("uplift_force_N", "target_mean_force_N"):
            if isinstance(content, dict) and key in content:
                raise validation_problem("force_from", f"is given together with {key}", f"Give force_from or {key}.")
        return content


def _name_force(pantograph: Any) -> str:
    """Name of the model of a pantograph, which pydantic validates and reports alone."""
    by_law = isinstance(pantograph, PantographByLaw) or (isinstance(pantograph, dict) and "force_from" in pantograph)
    return "PantographByLaw" if by_law else "PantographUse"


CasePantograph = Annotated[
    Annotated[PantographUse, Tag("PantographUse")] | Annotated[PantographByLaw, Tag("PantographByLaw")],
    Discriminator(_name_force),
]
"""Pantograph of a run."""


class Discretisation(InputTable):
    """Mesh and time step of the reference simulator; its refined run uses half of both, its coarse run twice both."""

    element_m: Annotated[float, Field(ge=0.02, le=5)] = 0.5
    """Largest element length [m]."""
    time_step_s: Annotated[float, Field(ge=1e-5, le=0.01)] = 0.001
    """Time step [s]."""
    reach_m: Annotated[float | None, Field(ge=20)] = None
    """Largest half-width of the active window around the train [m]; default: wide enough for every wave that returns
    to a pantograph before the end of the run. Uplift that waves from a narrower window can have reached is missing
    in the record.
    """

    def scale(self, factor: float) -> "Discretisation":
        """Discretisation with element length and time step multiplied by a factor."""
        steps = {"element_m": factor * self.element_m, "time_step_s": factor * self.time_step_s}
        return self.model_copy(update=steps)


class ApparentMass(InputTable):
    """Apparent mass at the head of a pantograph, computed in a static case."""

    model: FileName
    """Pantograph file, relative to the case file."""
    frequency_Hz: Annotated[PositiveList, Field(max_length=100)]
    """Frequencies of the apparent mass [Hz]."""


class Reading(SourcedTable):
    """Another documented reading of the evaluation; the keys of the case itself are the default reading."""

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.-]*$", max_length=40)]
    """Name of the reading in tables."""
    filter: Filter | None = None
    """Filter and bands in place of those of the case; a key that is not given is that of the case."""
    evaluated_m: Annotated[tuple[NonNegative, Positive] | None, Field(strict=False)] = None
    """Start and end of the analysis section, in place of that of the case [m]."""

    @cross_check
    def _differs(self) -> Problems:
        if self.filter is None and self.evaluated_m is None:
            yield validation_problem(
                "filter", "missing", "Give the keys that differ from those of the case: filter, evaluated_m or both."
            )
        if self.id == DEFAULT_READING:
            yield validation_problem("id", f"{self.id!r} is the reading of the case itself", "Give another name.")

    @cross_check
    def _check_section(self) -> Problems:
        yield from find_empty_section(self.evaluated_m)


DEFAULT_READING = "default"
"""Name of the reading that the keys of the case state."""


def find_empty_section(section: tuple[float, float] | None) -> Problems:
    """Problem of a section [m, m] whose end is not after its start."""
    if section is not None and section[1] <= section[0]:
        start, end = section
        yield validation_problem(
            "evaluated_m", f"the end {end:g} m is not greater than the start {start:g} m", "Give [start, end]."
        )


class CaseFile(SourcedTable):
    """Content of a case file. A case without a speed is a static check of the line."""

    id: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-][A-Za-z0-9._-]*(/[A-Za-z0-9_-][A-Za-z0-9._-]*)*$", max_length=200)]
    """Path-like name; no part begins with a dot."""
    title: Annotated[str, Field(max_length=200)]
    """Title in reports."""
    edition: Annotated[str | None, Field(max_length=100)] = None
    """Edition of the standard, e.g. "EN 50318:2018"."""
    superseded_by: Annotated[str | None, Field(max_length=100)] = None
    """Edition that superseded this edition."""
    line: FileName
    """Line file, relative to the case file."""
    damping: FileName | Damping | None = None
    """Damping that replaces that of the line: a file, relative to the case file, or a table."""
    on_request: bool = False
    """true: the case runs only if it is named, because it is slow or expected to fail."""
    requires: Annotated[tuple[str, ...], Field(strict=False, max_length=100)] = ()
    """Ids of the cases that are run first; this case is skipped if one of them, or a case that it requires in turn,
    fails, ends with an error or was not run; after any other verdict, skip included, this case runs and counts.
    """
    speed_km_h: Annotated[float | None, Field(ge=1, le=FASTEST_KM_H)] = None
    """Speed of the train [km/h]."""
    evaluated_spans: Annotated[tuple[int, ...] | None, Field(strict=False, min_length=1, max_length=1000)] = None
    """Spans of the analysis section, numbered from 1: first and last span, or all spans."""
    evaluated_m: Annotated[tuple[NonNegative, Positive] | None, Field(strict=False, exclude_if=is_absent)] = None
    """Start and end of the analysis section, in place of evaluated_spans [m]."""
    compared_spans: Annotated[tuple[int, int] | None, Field(strict=False)] = None
    """First and last span of a longer section; the analysis section is shifted along it span by span, to determine
    the spread of the results.
    """
    start_m: Annotated[float | None, Field(ge=0)] = None
    """Start position of the last pantograph [m]; default: end of the first span."""
    run_out_m: Annotated[float | None, Field(ge=0)] = None
    """Run-out of the last pantograph beyond the section [m]; default: at most one span."""
    spacing_m: PositiveList | None = None
    """Distances between successive pantographs, in running order [m]."""
    pantograph: Annotated[tuple[CasePantograph, ...], Field(strict=False, max_length=20)] = ()
    mass_drop: MassDrop | None = None
    """Mass drops instead of a train."""
    study: Study | None = None
    """Comparison of several runs."""
    apparent_mass: ApparentMass | None = None
    filter: Filter = Filter()
    reading: Annotated[tuple[Reading, ...], Field(strict=False, max_length=20, exclude_if=is_absent)] = ()
    """Further documented readings of the evaluation; a value that changes side between them is marked."""
    discretisation: Discretisation = Discretisation()
    limit: Annotated[tuple[Limit, ...], Field(strict=False, max_length=10_000)] = ()

    @model_validator(mode="before")
    @classmethod
    def _complete_readings(cls, content: Any) -> Any:
        """Add the keys of the filter of the case to the filters of its readings."""
        tables, own = (content.get("reading"), content.get("filter")) if isinstance(content, dict) else (None, None)
        if not isinstance(tables, list | tuple) or not isinstance(own, dict):
            return content
        partial = [isinstance(reading, dict) and isinstance(reading.get("filter"), dict) for reading in tables]
        pairs = zip(tables, partial, strict=True)
        return content | {"reading": [r | {"filter": own | r["filter"]} if given else r for r, given in pairs]}

    @cross_check
    def _check_study(self) -> Problems:
        if self.mass_drop is not None and self.speed_km_h is not None:
            yield validation_problem(
                "mass_drop",
                "is given in a case with speed_km_h",
                "Write one case for the train and one for the mass drop.",
            )
        if self.study is None:
            return
        drops = self.study.kind in {"release-velocity", "dropper-oscillation", "steady-arm-damper"}
        if drops and self.mass_drop is None:
            yield validation_problem("mass_drop", "missing", f"A study of the kind {self.study.kind} needs mass drops.")
        if not drops and self.speed_km_h is None:
            yield validation_problem(
                "speed_km_h", "missing", f"A study of the kind {self.study.kind} needs the speed of a train."
            )

    @cross_check
    def _check_train(self) -> Problems:
        if self.speed_km_h is None:
            if self.pantograph:
                yield validation_problem(
                    "speed_km_h", "missing", "Give the speed of the train in km/h, e.g. speed_km_h = 250.0 ."
                )
            return
        if self.apparent_mass is not None:
            yield validation_problem(
                "apparent_mass", "is given in a case with speed_km_h", "Move it to a static case, without speed_km_h."
            )
        elif not self.pantograph:
            yield validation_problem("pantograph", "missing", "A run needs at least one [[pantograph]] table.")
        if self.pantograph and self.evaluated_spans is None and self.evaluated_m is None:
            yield validation_problem(
                "evaluated_spans",
                "missing",
                "Give the spans of the analysis section, e.g. evaluated_spans = [5, 6] , or its ends as evaluated_m.",
            )

    @cross_check
    def _check_spacing(self) -> Problems:
        if self.pantograph and len(self.spacing_m or ()) != len(self.pantograph) - 1:
            yield validation_problem(
                "spacing_m",
                f"{len(self.spacing_m or ())} distances for {len(self.pantograph)} pantographs",
                "Give the distances between successive pantographs, in running order.",
            )

    @cross_check
    def _check_section(self) -> Problems:
        if self.evaluated_m is None:
            return
        for key in ("evaluated_spans", "compared_spans"):
            if getattr(self, key) is not None:
                yield validation_problem(
                    "evaluated_m", f"is given together with {key}", f"Leave out {key} or evaluated_m."
                )
        yield from find_empty_section(self.evaluated_m)

    @cross_check
    def _check_spans(self) -> Problems:
        spans = self.evaluated_spans or (1,)
        ranged = len(spans) == 2 and spans[0] < spans[1]
        if spans[0] < 1 or not (ranged or list(spans) == list(range(spans[0], spans[0] + len(spans)))):
            yield validation_problem(
                "evaluated_spans",
                f"{list(spans)} are not neighbouring spans",
                "Give the first and the last span, numbered from 1, e.g. [5, 6].",
            )
        elif self.compared_spans is not None and not (
            1 <= self.compared_spans[0] <= spans[0] and spans[-1] <= self.compared_spans[1]
        ):
            yield validation_problem(
                "compared_spans",
                f"spans {list(self.compared_spans)} do not include evaluated_spans = {list(spans)}",
                "Give the first and the last span of a section that includes evaluated_spans.",
            )

    @cross_check
    def _check_readings(self) -> Problems:
        if self.reading and (self.speed_km_h is None or self.study is not None):
            kind = "without a train" if self.speed_km_h is None else "with a study"
            yield validation_problem("reading", f"is given in a case {kind}", "A reading evaluates one passage.")
        names = [reading.id for reading in self.reading]
        for i, name in enumerate(names, 1):
            if name in names[: i - 1]:
                yield validation_problem(
                    f"reading[{i}].id", f"{name!r} is the name of two readings", "Give each reading its own name."
                )

    @cross_check
    def _check_limits(self) -> Problems:
        seen = set()
        for i, limit in enumerate(self.limit, 1):
            if limit.owner > len(self.pantograph):
                yield validation_problem(
                    f"limit[{i}].pantograph",
                    f"there is no pantograph {limit.owner}",
                    f"The case has {len(self.pantograph)}, numbered from 1 in running order.",
                )
            if limit.target in seen:
                yield validation_problem(
                    f"limit[{i}].quantity",
                    f"{limit.quantity} already has a limit",
                    "Give the lower and the upper bound of a quantity in one [[limit]] table.",
                )
            seen.add(limit.target)
