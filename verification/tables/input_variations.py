"""Variations of the inputs of a case, and the grade of a record that was simulated with them.

The inputs are listed in input_variations.toml. A record of a varied case is graded as one of the case itself: it is
that of a simulator with a wrong input. Its uplift forces are tuned anew where the case has a mean force.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import LIBRARY
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.criterion import Criterion, judge_criteria
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.key_paths import KeyPath
from pantocheck.conformance.core.sourced_table import InputTable, Positive
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.trust import StudiedPart
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.case_verification import verify_evaluation
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from pantocheck.conformance.runs.case_run import PassageRun, run_passage
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.discretisation.discretised_line import keep_viscous_part

FILE = Path(__file__).with_suffix(".toml")
TREATMENTS = {"keep_viscous_part": keep_viscous_part}
"""Treatments of the discretised line, by name."""
TRUST = "secondary"
"""Lowest trust of the limits that count."""


class CaseInput(InputTable):
    """Input of a case that a simulator may have wrong."""

    name: str
    group: StudiedPart
    keys: Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
    """Keys that are changed together; those that the case does not state are left out."""
    unit: str = "%"
    """Unit of an error."""
    shift: Positive | None = None
    """Change of the keys by an error of one unit; default: an error is relative."""
    first: Positive = 1.0
    """First error of the search [unit]."""
    largest: Positive = 100.0
    """Largest error of the search upwards [unit]."""
    largest_down: Positive | None = None
    """Largest error of the search downwards [unit]; default: 90 % of a relative error, else `largest`."""
    least: float | None = None
    """Least possible value of the keys; default: none that matters."""
    conditions: Annotated[tuple[float, ...], Field(strict=False)] = ()
    """Errors whose effects are tabled."""


class Choice(InputTable):
    """Other reading of an input, without a size."""

    name: str
    group: StudiedPart
    settings: Annotated[dict[str, str | float], Field(default_factory=dict)]
    """Values by key."""
    contact: ContactTable | None = None
    """Other contact of all pantographs."""
    treatment: Literal["keep_viscous_part"] | None = None
    """Treatment of the discretised line."""


class VariationFile(InputTable):
    """Content of input_variations.toml."""

    input: Annotated[tuple[CaseInput, ...], Field(strict=False)]
    choice: Annotated[tuple[Choice, ...], Field(strict=False)]


class NotApplicable(Exception):
    """A case does not support a variation: listed with this reason, because a missing row would look like no effect."""


class Grade(NamedTuple):
    """Verdicts on a record with a wrong input."""

    criteria: Verdict
    """Verdict by the EN 50318 criteria; `info` without a limit that counts."""
    verification: Verdict
    """Verdict by verification up to 50 Hz; `info` without a converged solution."""
    reason: str
    """Quantities or check that are not passed, with their verdict; empty if all pass."""
    uplift_forces: tuple[float, ...] = ()
    """Uplift force of every pantograph [N]."""

    @property
    def passes_criteria(self) -> bool:
        """Whether the criteria let the record pass; a contradicted or unconfirmed record does not."""
        return self.criteria in ("pass", "info")

    @property
    def passes(self) -> bool:
        """Whether both verdicts let the record pass."""
        return self.passes_criteria and self.verification in ("pass", "info")


@cache
def read_variations() -> VariationFile:
    """Inputs and choices of the list."""
    return read_model(FILE, VariationFile, "input variations")


def list_changes(case: Case, item: CaseInput, error: float) -> tuple[InputChange, ...]:
    """Changes of the keys of an input by an error [unit of the input].

    Raises:
        NotApplicable: The case states none of the keys, or each is zero and the error is relative.
    """
    stated = [pair for key in item.keys for pair in _find_values(case, key)]
    if not stated:
        raise NotApplicable("the case does not state this input")
    if item.shift is None and not any(_flatten(value) for _, value in stated):
        raise NotApplicable("the value of the case is zero")
    varied = [(key, _vary(value, item, error)) for key, value in stated]
    if item.least is not None and any(isinstance(value, float) and value < item.least for _, value in varied):
        raise NotApplicable(f"the value cannot be below {item.least:g} {item.unit}")
    return tuple(build_change(key, value) for key, value in varied)


def _find_values(case: Case, key: str) -> Iterator[tuple[str, object]]:
    """Key with the number of its item, and its value in the first part of the case that states it."""
    size = len(case.pantographs[0].chain.masses_kg) if case.pantographs and case.pantographs[0].chain else 0
    if "[middle]" in key and size != 3:
        return
    key = key.replace("[last]", f"[{size}]").replace("[middle]", "[2]")
    change = build_change(key, 1.0)
    parts: dict[str, object] = {"case": case.file, "line": case.line}
    if case.pantographs:
        parts |= {"use": case.file.pantograph[0], "pantograph": case.pantographs[0]}
    value = _follow(parts.get(change.part), change.path)
    if value is not None:
        yield key, value


def _follow(holder: object, path: KeyPath) -> object:
    """Value at a path; None if there is none."""
    for part in path:
        if isinstance(part, int):
            holder = holder[part] if isinstance(holder, tuple) and part < len(holder) else None
        else:
            holder = getattr(holder, part, None)
    return holder


def _flatten(value: object) -> bool:
    """Whether a number, or any number of a list, differs from zero."""
    return any(value) if isinstance(value, tuple) else bool(value)


def _vary(value: object, item: CaseInput, error: float) -> object:
    if isinstance(value, tuple):
        return [_vary(number, item, error) for number in value]
    assert isinstance(value, float | int)
    return value * (1 + error / 100) if item.shift is None else value + error * item.shift


def load_varied(case: Case, changes: tuple[InputChange, ...]) -> Case:
    """Library case with changed inputs.

    Raises:
        InputError: A value is not possible.
    """
    entry = LIBRARY.find_id(case.id)
    assert entry is not None
    return load_case(entry.path, changes)


def simulate_varied(varied: Case, treatment: str | None = None) -> PassageRun:
    """Simulate a varied case, with a treatment of its discretised line.

    Raises:
        SimulationError: The varied line has no initial state, or the run fails.
    """
    mesh = varied.file.discretisation
    line = discretise_line(varied.line, mesh.element_m)
    return run_passage(varied, line if treatment is None else TREATMENTS[treatment](line), mesh)


def grade_error(case: Case, item: CaseInput, error: float, start: tuple[float, ...] = ()) -> Grade:
    """Grade a record of the case that was simulated with an error of one input.

    Args:
        case: Case that the record claims to belong to.
        item: Input.
        error: Error of the input [unit of the input].
        start: Start values of tuned uplift forces [N]; default: those of the case.

    Returns:
        Verdicts.

    Raises:
        NotApplicable: The case does not have the input, or no simulation with this error is possible.
    """
    changes = list_changes(case, item, error)
    if all(lift.target_mean_force for lift in case.lift_forces) and not any("uplift" in key for key in item.keys):
        changes += tuple(build_change(f"pantograph[{i}].uplift_force_N", force) for i, force in enumerate(start, 1))
    try:
        passage = simulate_varied(load_varied(case, changes))
    except (InputError, SimulationError) as problem:
        raise NotApplicable(f"no simulation: {' '.join(str(problem).split())}") from problem
    return grade_record(case, passage)._replace(uplift_forces=passage.uplift_forces)


def grade_record(case: Case, passage: PassageRun) -> Grade:
    """Grade a record as a foreign system would deliver it: it states speed, section and start of the case."""
    record = replace(passage.record, speed=case.speed, evaluated=case.analysis_section)
    evaluation = CaseEvaluation(case, Delivered(record, run=passage.run, start=case.start_table))
    if evaluation.mismatch is not None:
        return Grade("error", "error", evaluation.mismatch)
    facts, verification = evaluation.record_facts, verify_evaluation(evaluation)
    if facts is not None and facts.state != "consistent":
        state: Verdict = judge_case(["pass"], facts)
        return Grade(state, state, f"record {facts.state}")
    criteria = evaluation.grade_limits(TRUST)
    verified = [] if verification is None else verification.criteria
    failed = [*_name_failures(criteria, "criteria"), *_name_failures(verified, "verification")]
    return Grade(
        judge_case([judge_criteria(criteria)], facts),
        "info" if verification is None else verification.verdict,
        ", ".join(failed),
    )


def _name_failures(criteria: list[Criterion], verdict: str) -> list[str]:
    """Quantities that fail, each once, with the verdict that they decide."""
    names = dict.fromkeys(row.quantity for row in criteria if row.verdict not in ("pass", "info"))
    return [f"{name} ({verdict})" for name in names]


def vary_choice(case: Case, choice: Choice) -> Case:
    """Case with the settings and the contact of a choice.

    Raises:
        NotApplicable: The files of the case do not allow the choice.
    """
    try:
        changes = tuple(build_change(key, value) for key, value in choice.settings.items())
        varied = load_varied(case, changes)
    except InputError as problem:
        raise NotApplicable(str(problem)) from problem
    if changes and replace(varied, changes=()).digest == case.digest:
        raise NotApplicable("the case has this setting")
    return varied if choice.contact is None else change_contact(varied, choice.contact)


def change_contact(case: Case, contact: ContactTable) -> Case:
    """Case with another contact of all pantographs."""
    files = tuple(file.model_copy(update={"contact": contact}) for file in case.pantographs)
    return replace(case, pantographs=files)


def list_contacts() -> dict[str, ContactTable]:
    """Contacts beside the spring of a case: Hertz's law and the constraint of the list, by law."""
    return {choice.contact.law: choice.contact for choice in read_variations().choice if choice.contact is not None}
