"""System under test: interface of every simulator and record folder."""

from typing import Literal, Protocol

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.results.outcome import Outcome

SystemKind = Literal["builtin", "record", "command"]


class System(Protocol):
    """Interface of a system under test. Systems are sent to other processes, so they contain plain data only."""

    @property
    def name(self) -> str:
        """Name in reports."""

    @property
    def version(self) -> str:
        """Version in reports."""

    @property
    def kind(self) -> SystemKind:
        """Kind of the system."""

    def run(self, case: Case) -> Outcome:
        """Run a case. An exception becomes the verdict `error` of this case only."""
