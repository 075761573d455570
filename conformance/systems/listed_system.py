"""System of a user's own code, which receives only cases whose features it lists."""

from dataclasses import dataclass

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_features import find_missing_features
from pantocheck.conformance.results.outcome import Outcome, Skipped
from pantocheck.conformance.systems.system import System, SystemKind


@dataclass(frozen=True)
class ListedSystem:
    """System with an optional attribute `features`; it receives only cases whose features it lists."""

    system: System

    @property
    def name(self) -> str:
        """Name in reports."""
        return self.system.name

    @property
    def version(self) -> str:
        """Version in reports."""
        return self.system.version

    @property
    def kind(self) -> SystemKind:
        """Kind of the system."""
        return self.system.kind

    def run(self, case: Case) -> Outcome:
        """Run a case if the system simulates all of its features."""
        features = getattr(self.system, "features", None)
        reason = find_missing_features(case, features)
        return self.system.run(case) if reason is None else Skipped(reason)
