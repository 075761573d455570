"""Grading inside a user's own tests: the functions behind the fixtures `pantocheck_run` and `pantocheck_assess`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.results_format import CaseResult, Criterion
from pantocheck.conformance.runner import run_case
from pantocheck.conformance.systems.system import System
from pantocheck.conformance.systems.system_choice import TIMEOUT_S, choose_system


@dataclass(frozen=True)
class GradedCase:
    """A case that was graded.

    Parameters
    ----------
    result : CaseResult
        All of it, as in results.json.
    """

    result: CaseResult

    @property
    def verdict(self) -> Verdict:
        """Of the case."""
        return self.result.verdict

    @property
    def reasons(self) -> tuple[str, ...]:
        """One line for the case, if it was not graded, and for every criterion that is not met."""
        whole = (self.result.reason,) if self.result.reason else ()
        return (
            *whole,
            *(criterion_line(item) for item in self.result.criteria if item.verdict not in {"pass", "info"}),
        )

    def value(self, quantity: str, pantograph: int = 1) -> float | list[float]:
        """A quantity of a pantograph (0: of the line), whether it has limits or not."""
        return self.result.quantities[str(pantograph)][quantity]

    def check(self, *quantities: str) -> None:
        """Fail the test, with one line per reason, if a criterion of these quantities (none given: any) is not met.

        Raises
        ------
        AssertionError
            One is not met, or has no limits.
        """
        __tracebackhide__ = True
        wanted = [item for item in self.result.criteria if not quantities or item.quantity in quantities]
        reasons = [criterion_line(item) for item in wanted if item.verdict not in {"pass", "info"}]
        if self.result.reason:
            reasons.insert(0, f"{self.result.verdict}: {self.result.reason}")
        reasons += [f"{name} has no limits" for name in quantities if name not in {item.quantity for item in wanted}]
        if reasons:
            raise AssertionError(f"{self.result.id}: " + "\n".join(reasons))


def criterion_line(item: Criterion) -> str:
    """A criterion on one line: what, its value, its limits, and why it is not met."""
    of = criterion_name(item)
    if item.value is None:
        return f"{of}: {item.verdict}, {item.reason}"
    bounds = " to ".join("any" if bound is None else f"{bound:g}" for bound in (item.lower, item.upper))
    text = f"{of} = {item.value:.4g} {item.unit}".rstrip() + f", limits {bounds}"
    return f"{text}: {item.reason}" if item.reason else text


def run_and_grade(
    case: str, system: str | System = "builtin", *, trust: Trust = "secondary", timeout_s: float = TIMEOUT_S
) -> GradedCase:
    """Run a case on a system and grade it.

    Parameters
    ----------
    case : str
        Id, or path of a case file.
    system : str or System
        As `--system` takes it, or an object with `name`, `version`, `kind` and `run(case)`.
    trust : Trust
        Lowest trust of limits that count.
    timeout_s : float
        Time a program may take [s].

    Raises
    ------
    InputError
        There is no such case or system.
    """
    tested = choose_system(system, timeout_s) if isinstance(system, str) else system
    return GradedCase(run_case(_one(case), tested, trust))


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
) -> GradedCase:
    """Grade a record as a run of a case.

    Parameters
    ----------
    case : str
        Id, or path of a case file.
    record : Record or str or Path or None
        a record, or the path of one; None: the arrays below.
    time_s : array_like or None
        (n,) evenly spaced [s].
    position_m, force_N : array_like or None
        (n,) or (p, n) contact point along the track [m] and contact force [N] of p pantographs.
    contact_height_m : array_like or None
        (n,) or (p, n) [m].
    support_position_m, support_uplift_m : array_like or None
        (s,) and (s, n) [m].
    filter_applied_Hz : float or None
        Cut-off of a low-pass the force has been through [Hz].
    trust : Trust
        Lowest trust of limits that count.

    Raises
    ------
    InputError
        There is no such case, or the record is wrong.
    """
    asked = _one(case)
    if isinstance(record, str | Path):
        record, _ = read_record(Path(record), None if asked.is_static else asked.analysis_section)
    if record is None:
        if time_s is None or position_m is None or force_N is None:
            raise InputError("pantocheck_assess", "no record", "Give a record, or time_s, position_m and force_N.")
        try:
            record = Record(
                time=np.asarray(time_s, dtype=np.float64),
                speed=asked.speed,
                position=np.atleast_2d(np.asarray(position_m, dtype=np.float64)),
                force=np.atleast_2d(np.asarray(force_N, dtype=np.float64)),
                evaluated=asked.analysis_section,
                filter_applied_Hz=filter_applied_Hz,
                contact_height=None if contact_height_m is None else np.atleast_2d(np.asarray(contact_height_m)),
                support_position=None if support_position_m is None else np.asarray(support_position_m),
                support_uplift=None if support_uplift_m is None else np.atleast_2d(np.asarray(support_uplift_m)),
            )
        except RecordInvalid as error:
            raise InputError(f"pantocheck_assess, {error.channel}", error.found, "See the docstring.") from None
    return GradedCase(grade_case(asked, Delivered(record), trust))


def _one(name: str) -> Case:
    found = [case for case in select_cases([name]) if case.id == name or name.endswith(".toml")]
    if len(found) != 1:
        raise InputError(f"case '{name}'", f"{len(found)} cases", "Name one case by its id or its file.")
    return found[0]
