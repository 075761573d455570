"""System for parallel runs: one case ends at once, the others wait until they are ended. Workers import it by name."""

import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.runs.system import Outcome, Skipped


@dataclass(frozen=True)
class Waiting:
    """System whose first case waits for the others to begin; they leave files when they begin and when they end."""

    folder: Path
    """Folder of the files."""
    quick: str
    """Id of the case that ends as soon as `others` cases have begun."""
    others: int
    """Number of the other cases."""
    deaf: str
    """Id of the case that ignores the signals that end a process."""
    name: str = "waiting"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        """Wait, and report how the waiting ended."""
        limit = time.monotonic() + 60.0
        if case.id == self.quick:
            while len(list(self.folder.glob("begun-*"))) < self.others and time.monotonic() < limit:
                time.sleep(0.02)
            return Skipped("all have begun")
        if case.id == self.deaf:
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
        name = case.id.replace("/", "-")
        (self.folder / f"begun-{name}").touch()
        try:
            while time.monotonic() < limit:
                time.sleep(0.05)
        finally:
            (self.folder / f"ended-{name}").touch()
        return Skipped("nobody ended the case")
