"""The cases of a plan over a pytest session: each is run once, by whichever process needs it first."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from filelock import FileLock

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import overlay_limits, read_limits, select_cases
from pantocheck.conformance.grading.baseline import compare_with_baseline
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.plan import Plan, read_plan
from pantocheck.conformance.reports.formats.report_writers import check_formats
from pantocheck.conformance.results.results_building import build_results, utc_now
from pantocheck.conformance.results.results_format import CaseResult, Results, SystemIdentity
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runner import run_when_ready
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study
from pantocheck.conformance.systems.system import System
from pantocheck.conformance.systems.system_choice import choose_system


@dataclass
class PlanSession:
    """A plan that is worked off.

    Parameters
    ----------
    path : Path
        Of the plan.
    plan : Plan
        Read, with the options of the session laid over it.
    cases : list[Case]
        Of the plan, with its limits.
    folder : Path
        Shared by all processes of the session.
    """

    path: Path
    plan: Plan
    cases: list[Case]
    folder: Path
    _system: System | None = None
    _finished: dict[str, CaseResult] = field(default_factory=dict)

    @classmethod
    def of_plan(
        cls, path: Path, shared: Path, out: str | None, formats: tuple[str, ...] | None, trust: Trust | None
    ) -> "PlanSession":
        """Read a plan; None leaves an option as the plan has it.

        Raises
        ------
        InputError
            The plan, a case or the limits are wrong, or the folder of the certificate cannot be written.
        """
        given = {"out": out, "formats": formats, "trust": trust}
        plan = read_plan(path).model_copy(update={key: value for key, value in given.items() if value is not None})
        cases = select_cases(plan.cases)
        if plan.limits is not None:
            cases = overlay_limits(cases, read_limits(Path(plan.limits)))
        if plan.damping_study:
            cases = [add_damping_study(case) for case in cases]
        check_formats(plan.formats)
        check_writable(Path(plan.out))
        return cls(path, plan, cases, shared / _key(str(path.resolve())))

    @property
    def out(self) -> Path:
        """Folder of the certificate."""
        return Path(self.plan.out)

    @property
    def formats(self) -> tuple[str, ...]:
        """What is written."""
        return check_formats(self.plan.formats)

    def result(self, case: Case) -> CaseResult:
        """Of a case: read if any process has it, else computed, those it requires first."""
        for required in self.cases:
            if required.id in case.file.requires:
                self.result(required)
        if case.id not in self._finished:
            self.folder.mkdir(parents=True, exist_ok=True)
            with FileLock(self.folder / f"{_key(case.id)}.lock"):
                if (known := self._read(case)) is None:
                    known = run_when_ready(case, self._started(), self.plan.trust, self._finished, self.cases)
                    write_atomically(self._file(case), known.model_dump_json().encode())
            self._finished[case.id] = known
        return self._finished[case.id]

    def results(self) -> tuple[Results, int] | None:
        """All cases of the plan, those that were deselected skipped, and how many values drifted from its baseline.

        None if no case was run.
        """
        session = self.folder / "session.json"
        if not session.is_file():
            return None
        said = json.loads(session.read_text(encoding="utf-8"))
        finished = [
            self._read(case) or build_ungraded(case, "skip", "not run in this session of pytest") for case in self.cases
        ]
        identity = SystemIdentity.model_validate(said["system"])
        results = build_results(finished, identity, self.plan.trust, said["started"])
        if self.plan.baseline is None:
            return results, 0
        path = Path(self.plan.baseline)
        compared = compare_with_baseline(results, read_results(path), self.plan.drift_pct, path.name)
        return compared, _criteria(compared) - _criteria(results)

    def _started(self) -> System:
        """The system under test, started once in this process."""
        if self._system is None:
            self._system = choose_system(self.plan.system, self.plan.timeout_s)
            session = {
                "plan": str(self.path.resolve()),
                "started": utc_now(),
                "system": {name: getattr(self._system, name) for name in ("name", "version", "kind")},
            }
            with FileLock(self.folder / "session.lock"):
                if not (self.folder / "session.json").exists():
                    write_atomically(self.folder / "session.json", json.dumps(session).encode())
        return self._system

    def _file(self, case: Case) -> Path:
        return self.folder / f"{_key(case.id)}.json"

    def _read(self, case: Case) -> CaseResult | None:
        path = self._file(case)
        return CaseResult.model_validate_json(path.read_bytes()) if path.is_file() else None


def list_registered(shared: Path) -> Iterator[Path]:
    """Plans of which a case was run in a session, by name."""
    plans = [json.loads(path.read_text(encoding="utf-8"))["plan"] for path in shared.glob("*/session.json")]
    return map(Path, sorted(plans))


def _criteria(results: Results) -> int:
    return sum(len(case.criteria) for case in results.cases)


def _key(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]
