"""System under test: the interface that every simulator and record folder meets."""

from typing import Literal, Protocol

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.results.outcome import Outcome


class System(Protocol):
    """Anything that can be graded. It is sent to other processes, so it holds plain data only."""

    @property
    def name(self) -> str:
        """As printed in reports."""

    @property
    def version(self) -> str:
        """As printed in reports."""

    @property
    def kind(self) -> Literal["builtin", "record", "command"]:
        """How it is spoken to."""

    def run(self, case: Case) -> Outcome:
        """Run a case. An exception it raises becomes the verdict `error` of that case alone."""
