"""Functions of the fixtures of a user's tests: `pantocheck_run`, `pantocheck_assess` and `pantocheck_pantograph`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.app.self_test.fmu_check import FmuCheck, check_fmu
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.input_changes import InputChange, replace_pantographs
from pantocheck.conformance.cases.library import overlay_limits, read_limits, select_cases
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.case_selection import VerdictChoice, choose_verdicts
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.quantities.limit_text import format_graded
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.results.results_format import CaseResult, VerdictName
from pantocheck.conformance.runs.record_folder import read_case_record
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered, ListedSystem, System
from pantocheck.conformance.runs.system_choice import TIMEOUT_S, choose_system


@dataclass(frozen=True)
class GradedCase:
    """Graded case."""

    result: CaseResult
    """Result of the case, as in results.json."""
    requested: tuple[VerdictName, ...] = ("criteria",)
    """Verdicts that decide."""

    @property
    def verdict(self) -> Verdict:
        """Verdict of the case."""
        return self.result.verdict

    @property
    def reasons(self) -> tuple[str, ...]:
        """Lines for the case and its record, and for every criterion that is not met; none if the case passes."""
        return tuple(self._list_reasons(self._criteria))

    @property
    def _criteria(self) -> list[Criterion]:
        """Criteria of the requested verdicts."""
        return [criterion for name in self.requested for criterion in list_verdict_criteria(self.result, name)]

    def value(self, quantity: str, pantograph: int = 1) -> float | list[float]:
        """Value of a quantity of a pantograph (0: line), with or without limits."""
        return self.result.quantities[str(pantograph)][quantity]

    def check(self, *quantities: str, accept_unconfirmed: bool = False) -> None:
        """Fail the test, with a line per reason, unless the criteria of these quantities pass on a consistent record.

        Args:
            *quantities: Names of quantities; default: all with limits that count.
            accept_unconfirmed: Whether an unconfirmed record may pass.

        Raises:
            AssertionError: A criterion is not met or does not count, a quantity has no limits, a requested verification
                is impossible, or the record is not consistent.
        """
        __tracebackhide__ = True
        criteria = [c for c in self._criteria if not quantities or c.quantity in quantities]
        reasons = self._list_reasons(criteria, accept_unconfirmed)
        reasons += [describe_unmet_criterion(c) for c in criteria if quantities and c.verdict == "info"]
        limited = {criterion.quantity for criterion in criteria}
        reasons += [f"{name} has no limits" for name in quantities if name not in limited]
        if reasons:
            raise AssertionError(f"{self.result.id}: " + "\n".join(reasons))

    def _list_reasons(self, criteria: Sequence[Criterion], accept_unconfirmed: bool = False) -> list[str]:
        """Reasons why some criteria of the case do not pass, or why a requested verification has no criteria."""
        result = self.result
        if result.reason:
            return [f"{result.verdict}: {result.reason}"]
        reasons = [describe_unmet_criterion(c) for c in criteria if c.verdict not in {"pass", "info"}]
        if all(criterion.verdict == "info" for criterion in criteria):
            reasons.append("no limit counts")
        if "verification" in self.requested and result.verification is not None and result.verification.reason:
            reasons.append(f"verification: {result.verification.verdict}, {result.verification.reason}")
        if is_unconfirmed(result) and not accept_unconfirmed:
            reasons.append(describe_unconfirmed(result))
        return reasons


def list_verdict_criteria(result: CaseResult, name: VerdictName) -> list[Criterion]:
    """Criteria of one of the two verdicts of a case."""
    if name == "criteria":
        return result.criteria
    return [] if result.verification is None else result.verification.criteria


def is_unconfirmed(result: CaseResult) -> bool:
    """Whether the record of a case is unconfirmed and has to be consistent."""
    return result.record is not None and result.record.state == "unconfirmed" and result.record.demanded


def describe_unconfirmed(result: CaseResult) -> str:
    """Line of a case with an unconfirmed record."""
    return f"the record is unconfirmed: {'' if result.record is None else result.record.reason}"


def describe_unmet_criterion(criterion: Criterion) -> str:
    """Line of a criterion that does not pass: name, value, limits and reason."""
    name = f"{'verification of ' if criterion.trust == 'computed' else ''}{criterion_name(criterion)}"
    if criterion.value is None:
        return f"{name}: {criterion.verdict}, {criterion.reason}"
    value, bounds = format_graded(criterion.value, criterion.lower, criterion.upper)
    return f"{name} = {f'{value} {criterion.unit}'.rstrip()}, limits {bounds}: {criterion.reason}"


def run_and_grade(
    case: str,
    system: str | System = "builtin",
    *,
    trust: Trust = "secondary",
    verdicts: VerdictChoice | None = None,
    timeout_s: float = TIMEOUT_S,
    pantographs: Sequence[str | Path] = (),
    limits: str | Path | None = None,
    case_folders: Sequence[str | Path] = (),
) -> GradedCase:
    """Run a case on a system and grade it.

    Args:
        case: Id, or path of a case file.
        system: Value as for `--system`, or an object with `name`, `version`, `kind`, `run(case)`, and the names of the
            `features` that it simulates; a case that uses another one is skipped, and without `features` every case.
        trust: Lowest trust of limits that count.
        verdicts: Verdicts that decide; default: the criteria for the built-in simulator, both for any other system.
        timeout_s: Time limit of a program [s].
        pantographs: Pantograph files or FMUs in place of those of the case, in running order; one stands for all. The
            code of an FMU is run. The case then has no limits of the library.
        limits: File of limits that replace those of the case.
        case_folders: Folders with further cases; default: those of `--pantocheck-cases`.

    Returns:
        Verdict, reasons and values.

    Raises:
        InputError: There is no such case, system, pantograph or file of limits.
    """
    tested = choose_system(system, timeout_s) if isinstance(system, str) else system
    selected = _select_case(case, case_folders, replace_pantographs([str(name) for name in pantographs]))
    if limits is not None:
        (selected,) = overlay_limits([selected], read_limits(Path(limits)))
    if not isinstance(system, str | ReferenceSimulator):
        tested = ListedSystem(tested)
    return _decide(run_case(selected, tested, trust), choose_verdicts(verdicts, tested.kind))


def grade_arrays(
    case: str,
    record: Record | str | Path | None = None,
    *,
    time_s: ArrayLike | None = None,
    position_m: ArrayLike | None = None,
    force_N: ArrayLike | None = None,
    contact_height_m: ArrayLike | None = None,
    support_position_m: ArrayLike | None = None,
    support_uplift_m: ArrayLike | None = None,
    filter_applied_Hz: float | None = None,
    trust: Trust = "secondary",
    verdicts: VerdictChoice | None = None,
    case_folders: Sequence[str | Path] = (),
) -> GradedCase:
    """Grade a record as a run of a case.

    Args:
        case: Id, or path of a case file.
        record: Record or path of a record; default: the arrays below.
        time_s: Equidistant times, (n,) [s].
        position_m, force_N: Contact point along the track [m] and contact force [N] of p pantographs, (n,) or (p, n).
        contact_height_m: Height of the contact point, (n,) or (p, n) [m].
        support_position_m: Positions of the supports, (s,) [m].
        support_uplift_m: Uplift at the supports, (s, n) [m].
        filter_applied_Hz: Cut-off frequency of a low-pass that was applied to the force [Hz].
        trust: Lowest trust of limits that count.
        verdicts: Verdicts that decide; default: the criteria for the built-in simulator, both for any other system.
        case_folders: Folders with further cases; default: those of `--pantocheck-cases`.

    Returns:
        Verdict, reasons and values.

    Raises:
        InputError: There is no such case, or the record is invalid.
    """
    graded_case = _select_case(case, case_folders)
    if isinstance(record, str | Path):
        record, _ = read_case_record(Path(record), graded_case)
    if record is None:
        if time_s is None or position_m is None or force_N is None:
            raise InputError(
                "pantocheck_assess", "there is no record", "Give a record, or time_s, position_m and force_N."
            )
        try:
            record = Record(
                time=np.asarray(time_s, dtype=np.float64),
                speed=graded_case.speed,
                position=np.atleast_2d(np.asarray(position_m, dtype=np.float64)),
                force=np.atleast_2d(np.asarray(force_N, dtype=np.float64)),
                evaluated=graded_case.analysis_section,
                filter_applied_Hz=filter_applied_Hz,
                contact_height=None if contact_height_m is None else np.atleast_2d(np.asarray(contact_height_m)),
                support_position=None if support_position_m is None else np.asarray(support_position_m),
                support_uplift=None if support_uplift_m is None else np.atleast_2d(np.asarray(support_uplift_m)),
            )
        except RecordInvalid as error:
            raise InputError(f"pantocheck_assess, {error.channel}", error.found, "Correct this argument.") from None
    result = grade_case(graded_case, Delivered(record), trust)
    return _decide(result, choose_verdicts(verdicts, "record"))


def check_pantograph(model: str | Path, *, uplift_force_N: float = 120.0, step_s: float = 0.001) -> FmuCheck:
    """Check an FMU as a pantograph, as `pantocheck pantograph check` does; its code is run.

    Args:
        model: FMU, or pantograph file with a table [fmu].
        uplift_force_N: Uplift force [N].
        step_s: Time step of the coupling [s].

    Returns:
        Findings, none of which is wrong.

    Raises:
        AssertionError: A finding is wrong; one line for each.
        InputError: A file cannot be used.
    """
    __tracebackhide__ = True
    check = check_fmu(read_named_pantograph(Path(model)), uplift_force_N, step_s)
    if not check.passed:
        wrong = [f"{finding.subject}: {finding.text}" for finding in check.findings if finding.state == "wrong"]
        raise AssertionError(f"{Path(model).name}: " + "\n".join(wrong))
    return check


def _decide(result: CaseResult, requested: tuple[VerdictName, ...]) -> GradedCase:
    return GradedCase(Participation(requested=requested).decide_case(result), requested)


def _select_case(name: str, folders: Sequence[str | Path], changes: Sequence[InputChange] = ()) -> Case:
    found = select_cases([name], changes, open_catalogue(folders))
    cases = [case for case in found if case.id == name or name.endswith(".toml")]
    if len(cases) != 1:
        raise InputError(f"case '{name}'", f"{len(cases)} cases match", "Give the id or the file of one case.")
    return cases[0]
