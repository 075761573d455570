"""Line tests: every pair of a simulated and a measured run, compared with the tolerances of the dossier."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.profile_file import Profile, load_profile, own_rules
from pantocheck.conformance.comparison.force_difference import REPEATED_CORRELATION, compare_likeness
from pantocheck.conformance.comparison.profile_grading import compare_measured_run, grade_record
from pantocheck.conformance.core.criterion import Criterion, judge_criteria
from pantocheck.conformance.core.decision import parse_decision
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import interruption_exit_code
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.dossier.dossier_file import CaseRun, LineTestTable, PairTable
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.run_reading import RunSide, find_dependence, list_mismatches, read_run, run_and_read
from pantocheck.conformance.dossier.step_result import StepInterrupted, StepResult, list_inputs
from pantocheck.conformance.execution.runner import Progress
from pantocheck.conformance.grading.case_identity import profile_limits_digest
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.criterion_grading import skip_unlimited
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.procedure_format import Evidence, JoinedQuantity
from pantocheck.conformance.results.results_format import CaseResult, RunFacts
from pantocheck.conformance.runs.system import System

LINE_TEST_PROFILE = "line-test"
"""Profile of the library whose quantities every line test needs, and whose tolerances hold if the user states none."""

NEEDED_BY_LINE_TESTS = "needed by the line tests of this suite"
"""Source of a criterion without a tolerance."""

RECORDS_FOLDER = "records"
"""Folder below the results for the records of the simulated runs."""


def build_line_test_profile(table: LineTestTable) -> Profile:
    """Rules of the pairs: the tolerances of the user, which are `own`, or those of the library."""
    published = load_profile(LINE_TEST_PROFILE).rule
    return Profile.model_validate(
        {
            "schema": "pantocheck.profile/1",
            "name": "dossier",
            "title": "Line test",
            "speed_tolerance_pct": table.speed_tolerance_pct,
            "verification": "demanded",
            "filter": table.filter,
            "rule": own_rules(table.tolerance, published) or published,
        }
    )


@dataclass(frozen=True)
class LineTests:
    """Line tests of a dossier on a system."""

    dossier: Dossier
    """Dossier with the pairs."""
    system: System
    """System under test."""
    folder: Path
    """Folder of the results."""

    def run(self, progress: Progress | None = None) -> StepResult:
        """Compare all pairs.

        Raises:
            StepInterrupted: The user ended the run; the finished pairs are kept.
        """
        if not self.dossier.file.pair:
            return StepResult("line_test", "not done", "the dossier names no pair of runs (table pair)")
        finished: list[tuple[CaseResult, Evidence | None]] = []
        used: list[RunSide] = []
        try:
            for pair in self.dossier.file.pair:
                finished.append(self._compare(pair, used))
                if progress is not None:
                    progress(finished[-1][0])
        except KeyboardInterrupt as interruption:
            reason = "the run was interrupted before all pairs were compared"
            raise StepInterrupted(_collect(finished, reason), interruption_exit_code(interruption)) from None
        return _collect(finished, None)

    def _compare(self, pair: PairTable, used: list[RunSide]) -> tuple[CaseResult, Evidence | None]:
        """Result of a pair, and the conditions that it verifies if it passes."""
        profile = build_line_test_profile(self.dossier.file.line_test)
        try:
            simulated, measured = self._simulate(pair, profile), read_run(pair.measured, self.dossier, profile)
        except InputError as error:
            return self._refuse(pair, "error", " ".join(str(error).split())), None
        reason = self._find_dependence(simulated, measured)
        if reason is None and any(_repeats(measured, other) for other in used):
            reason = "the measured run is that of another pair"
        if reason is not None:
            return self._refuse(pair, "error", reason), None
        if mismatches := list(list_mismatches(simulated, measured, profile)):
            return self._refuse(pair, "skip", f"not compared: {'; '.join(mismatches)}"), None
        notes = [_describe_likeness(simulated, measured), *_describe_repetition(measured, used)]
        used.append(measured)
        return self._grade(pair, simulated, measured, profile, notes), self._describe(pair, simulated)

    def _simulate(self, pair: PairTable, profile: Profile) -> RunSide:
        if isinstance(pair.simulated, CaseRun):
            case, path = self.dossier.pair_cases[pair.name], self.folder / RECORDS_FOLDER / f"{pair.name}.h5"
            return run_and_read(case, pair.simulated.direction, self.system, self.dossier, profile, path)
        return read_run(pair.simulated, self.dossier, profile)

    def _find_dependence(self, simulated: RunSide, measured: RunSide) -> str | None:
        """Reason why the measured run does not test the system; None if it does."""
        stated = simulated.record.header.system
        if stated is None or stated.name != self.system.name:
            name = "no system" if stated is None else stated.name
            return f"the simulated record states {name}, the system under test is {self.system.name}"
        if measured.record.system.name == self.system.name:
            return "the measured record was made by the system under test"
        return find_dependence(simulated, measured)

    def _grade(
        self, pair: PairTable, simulated: RunSide, measured: RunSide, profile: Profile, notes: Sequence[str]
    ) -> CaseResult:
        trust, rule = self.dossier.file.trust, parse_decision(self.dossier.file.decision)
        case = grade_record(simulated.record, profile, trust, measured.record, rule=rule)
        criteria = [*case.criteria, *self._list_ungraded(simulated, profile)]
        facts = case.record
        if simulated.facts is not None and facts is not None:
            digests = {"digest": facts.digest, "measured_digest": facts.measured_digest}
            facts = simulated.facts.model_copy(update=digests)
        return case.model_copy(
            update={
                "id": _name_result(pair),
                "title": f"Line test {pair.name}: {simulated.line}, {simulated.record.header.speed_km_h:g} km/h, "
                f"{', '.join(simulated.pantographs)}, {simulated.direction}",
                "verdict": judge_case([judge_criteria(criteria)], facts),
                "criteria": criteria,
                "record": facts,
                "notes": [*case.notes, *notes],
                "comparison": compare_measured_run(simulated.record, measured.record, simulated.supports),
            }
        )

    def _list_ungraded(self, simulated: RunSide, profile: Profile) -> Iterator[Criterion]:
        """Skipped criteria of the quantities that every line test needs, but for which no tolerance is stated."""
        graded = {rule.quantity for rule in profile.rule}
        for quantity in (rule.quantity for rule in load_profile(LINE_TEST_PROFILE).rule):
            if quantity in graded:
                continue
            owners = simulated.record.pantographs if QUANTITIES[quantity].scope == "pantograph" else (LINE,)
            for owner in owners:
                value = simulated.record.values.values.get(owner, {}).get(quantity)
                number = value if isinstance(value, float) else None
                reason = "the dossier states no tolerance"
                yield skip_unlimited(quantity, reason, NEEDED_BY_LINE_TESTS, owner=owner, value=number)

    def _describe(self, pair: PairTable, simulated: RunSide) -> Evidence:
        line, known = self.dossier.lines.get(simulated.line), self.dossier.pantographs
        pantographs = [known[name] for name in simulated.pantographs if name in known]
        return Evidence(
            id=_name_result(pair),
            line=simulated.line,
            pantographs=list(simulated.pantographs),
            speed_km_h=simulated.record.header.speed_km_h,
            spacing_m=list(simulated.spacing_m or ()),
            inputs={} if line is None else list_inputs(self.dossier, line, pantographs),
        )

    def _refuse(self, pair: PairTable, verdict: Verdict, reason: str) -> CaseResult:
        """Result of a pair that was not compared."""
        profile = build_line_test_profile(self.dossier.file.line_test)
        digest = profile_limits_digest(profile)
        return CaseResult(
            id=_name_result(pair),
            title=f"Line test {pair.name}",
            verdict=verdict,
            criteria_verdict=None,
            reason=reason,
            notes=[],
            warnings=[],
            inputs=[],
            input_digest=self.dossier.digest,
            limits_digest=digest,
            stated_limits_digest=digest,
            profile=profile.name,
            library="own",
            steps=["line_test"],
            criteria=[],
            quantities={},
            skipped={},
            spread={},
            uncertainty={},
            uncertainty_components={},
            uncertainty_basis={},
            places={},
            run=RunFacts(
                simulated_s=None,
                wall_s=None,
                dt_s=None,
                element_m=None,
                speed_km_h=None,
                rate_Hz=None,
                filter=profile.filter,
                evaluated_m=None,
            ),
            traces={},
            uplift=[],
        )


def _repeats(side: RunSide, other: RunSide) -> bool:
    """Whether a run is another one, in any format of file, or that with small changes."""
    likeness = compare_likeness(side.record, other.record)
    return _identify(side) == _identify(other) or (likeness is not None and likeness.exceeds(REPEATED_CORRELATION))


def _identify(side: RunSide) -> str:
    """Digest of the samples, in any format of file; of a summary, that of the file."""
    return side.record.force_digest or side.record.record_digest


def _describe_likeness(simulated: RunSide, measured: RunSide) -> str:
    """Note on the independence of both runs."""
    likeness = compare_likeness(simulated.record, measured.record)
    if likeness is None:
        return "Whether the measured run is a copy was not compared: no force of both runs is known up to 50 Hz."
    return f"Of simulated and measured run, {likeness.describe()}."


def _describe_repetition(measured: RunSide, used: Sequence[RunSide]) -> list[str]:
    """Note on the largest likeness with a measured run of an earlier pair; none without one to compare."""
    found = [likeness for side in used if (likeness := compare_likeness(measured.record, side.record)) is not None]
    largest = max(found, key=lambda likeness: likeness.correlation, default=None)
    return [] if largest is None else [f"Of the measured runs of two pairs, {largest.describe()}."]


def _name_result(pair: PairTable) -> str:
    return f"pair/{pair.name}"


def _collect(finished: list[tuple[CaseResult, Evidence | None]], reason: str | None) -> StepResult:
    evidence = tuple(item for _, item in finished if item is not None)
    return StepResult(
        "line_test",
        "done" if reason is None else "not done",
        reason,
        cases=tuple(case for case, _ in finished),
        evidence=evidence,
    )


# Line tests joined over the pairs: mean, spread and largest difference of every quantity.
def join_pairs(cases: Sequence[CaseResult]) -> list[JoinedQuantity]:
    """Differences of all compared pairs by pantograph (0: the line) and quantity, in the order of reports."""
    owners = sorted({int(owner) for case in cases if case.comparison for owner in case.comparison.quantities})
    joined = (_join_quantity(cases, str(owner), name) for owner in owners for name in QUANTITIES)
    return [item for item in joined if item is not None]


def _join_quantity(cases: Sequence[CaseResult], owner: str, name: str) -> JoinedQuantity | None:
    differences: dict[str, float] = {}
    widths: list[float | None] = []
    for case in cases:
        if case.comparison is None:
            continue
        simulated = case.quantities.get(owner, {}).get(name)
        measured = case.comparison.quantities.get(owner, {}).get(name)
        if isinstance(simulated, float) and isinstance(measured, float):
            differences[case.id] = simulated - measured
            stated = (case.uncertainty, case.comparison.uncertainty)
            widths.append(_join_widths([part.get(owner, {}).get(name) for part in stated]))
    if not differences:
        return None
    values = np.array(list(differences.values()))
    known = [width for width in widths if width is not None]
    largest = max(differences, key=lambda case: abs(differences[case]))
    return JoinedQuantity(
        quantity=name,
        pantograph=int(owner),
        runs=values.size,
        mean_difference=float(values.mean()),
        uncertainty=math.hypot(*known) / values.size if len(known) == values.size else None,
        spread=float(values.std(ddof=1)) if values.size > 1 else None,
        largest_difference=differences[largest],
        largest_in=largest,
    )


def _join_widths(widths: Sequence[Number | None]) -> float | None:
    """Half-width of a difference from those of both values; None if one is not known."""
    numbers = [width for width in widths if isinstance(width, float)]
    return math.hypot(*numbers) if len(numbers) == len(widths) else None
