"""Run of a plan in a pytest session: each case runs once, in the first process that needs it."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from filelock import FileLock

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.execution.plan import PreparedPlan
from pantocheck.conformance.execution.runner import run_when_ready
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.results_building import build_results, utc_now
from pantocheck.conformance.results.results_format import CaseResult, Results, SystemIdentity
from pantocheck.conformance.runs.system import System


@dataclass
class PlanSession:
    """Run of a plan in a session."""

    path: Path
    """File of the plan."""
    prepared: PreparedPlan
    """The plan with the options of the session."""
    shared: Path
    """Folder that all processes of the session share."""
    _system: System | None = None
    _finished: dict[str, CaseResult] = field(default_factory=dict)

    @property
    def cases(self) -> tuple[Case, ...]:
        """Cases of the plan."""
        return self.prepared.cases

    @property
    def folder(self) -> Path:
        """Folder of this plan below the shared folder."""
        return self.shared / _hash(str(self.path.resolve()))

    def result(self, case: Case) -> CaseResult:
        """Result of a case: read from another process, or computed after the cases that it requires."""
        for required in self.cases:
            if required.id in case.file.requires:
                self.result(required)
        if case.id not in self._finished:
            self.folder.mkdir(parents=True, exist_ok=True)
            with FileLock(self.folder / f"{_hash(case.id)}.lock"):
                if (result := self._read(case)) is None:
                    trust = self.prepared.plan.trust
                    rule = self.prepared.participation.decision
                    result = run_when_ready(case, self._start_system(), trust, self._finished, self.cases, rule)
                    write_atomically(self._file(case.id), result.model_dump_json().encode())
            self._finished[case.id] = result
        return self._finished[case.id]

    @property
    def accepts_unconfirmed(self) -> bool:
        """Whether the plan accepts unconfirmed records of its system."""
        return self._start_system().name in self.prepared.participation.accepted_unconfirmed

    def compare(self, case: Case) -> CaseResult:
        """Result of a case with its criteria of drift from the baseline of the plan."""
        finished, system = self.result(case), self._start_system()
        identity = SystemIdentity(name=system.name, version=system.version, kind=system.kind)
        results = build_results([finished], identity, self.prepared.plan.trust, utc_now(), self.prepared.participation)
        return self.prepared.compare(results).cases[0]

    def results(self) -> tuple[Results, Verdict] | None:
        """Results of the plan, compared with its baseline, and the verdict of the cases that ran.

        A deselected case has the verdict `skip` in the results. None if no case ran.
        """
        session_file = self.folder / "session.json"
        if not session_file.is_file():
            return None
        session = json.loads(session_file.read_text(encoding="utf-8"))
        finished = [
            self._read(case) or build_ungraded(case, "skip", "not run in this session of pytest") for case in self.cases
        ]
        identity = SystemIdentity.model_validate(session["system"])
        trust, participation = self.prepared.plan.trust, self.prepared.participation
        results = build_results(finished, identity, trust, session["started"], participation)
        compared = self.prepared.compare(results)
        executed = [case for case in compared.cases if self._file(case.id).is_file()]
        verdict = participation.judge_cases(executed, identity.name)
        return compared, verdict

    def _start_system(self) -> System:
        """System under test, started once in this process."""
        if self._system is None:
            self._system = self.prepared.start_system()
            session = {
                "plan": str(self.path.resolve()),
                "started": utc_now(),
                "system": {name: getattr(self._system, name) for name in ("name", "version", "kind")},
            }
            with FileLock(self.folder / "session.lock"):
                if not (self.folder / "session.json").exists():
                    write_atomically(self.folder / "session.json", json.dumps(session).encode())
        return self._system

    def _file(self, case_id: str) -> Path:
        return self.folder / f"{_hash(case_id)}.json"

    def _read(self, case: Case) -> CaseResult | None:
        path = self._file(case.id)
        return CaseResult.model_validate_json(path.read_bytes()) if path.is_file() else None


def list_registered(shared: Path) -> Iterator[Path]:
    """Plans with a finished case in a session, sorted by name."""
    plans = [json.loads(path.read_text(encoding="utf-8"))["plan"] for path in shared.glob("*/session.json")]
    return map(Path, sorted(plans))


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]
