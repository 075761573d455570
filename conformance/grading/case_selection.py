"""Selection: the verdicts that decide a run, and the cases of a run without a list of cases."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.core.trust import Trust, decides_verdict
from pantocheck.conformance.results.results_format import VerdictName

VerdictChoice = Literal["criteria", "verification", "both"]
"""Choice of the user between the two verdicts."""

BOTH: tuple[VerdictName, ...] = ("criteria", "verification")


def choose_verdicts(choice: VerdictChoice | None, system: str) -> tuple[VerdictName, ...]:
    """Verdicts that decide a run.

    Args:
        choice: Choice of the user. By default, the built-in simulator, which computed the converged values, is judged
            by the criteria; any other system by both verdicts, and is unconfirmed where a case has no converged values.
        system: System under test, `builtin` or any other.
    """
    if choice is not None:
        return BOTH if choice == "both" else (choice,)
    return ("criteria",) if system == "builtin" else BOTH


@dataclass(frozen=True)
class CaseSelection:
    """Cases that count for the requested verdicts."""

    trust: Trust
    """Lowest trust of the limits that count."""
    requested: tuple[VerdictName, ...]
    """Verdicts that decide."""

    def select_counted(self, cases: Sequence[Case]) -> list[Case]:
        """Cases that count and have no `on_request`, and the cases that they require."""
        kept = {case.id for case in cases if self.counts(case) and not case.file.on_request}
        needed = {required for case in cases if case.id in kept for required in case.file.requires}
        return [case for case in cases if case.id in kept | needed]

    def list_verification_only(self, cases: Sequence[Case]) -> tuple[str, ...]:
        """Ids of the cases that count for the verification, but have no limit that counts."""
        return tuple(case.id for case in cases if self._is_verified(case) and not self._has_limit(case))

    def counts(self, case: Case) -> bool:
        """Whether a case has a limit that counts, or converged values, for a requested verdict."""
        return ("criteria" in self.requested and self._has_limit(case)) or self._is_verified(case)

    def _has_limit(self, case: Case) -> bool:
        return any(decides_verdict(limit.trust, self.trust) for limit in case.limits)

    def _is_verified(self, case: Case) -> bool:
        return "verification" in self.requested and find_converged(case.id) is not None
