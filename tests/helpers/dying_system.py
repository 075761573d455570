"""System for parallel runs: the processes of some cases end like after a crash. Workers import it by name."""

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.runs.system import Outcome, Skipped


@dataclass(frozen=True)
class Dying:
    """System whose cases leave a file when they begin; the process of a fatal case ends as soon as a file exists."""

    folder: Path
    """Folder of the files."""
    fatal: dict[str, str]
    """Name of the file that ends the process, by fatal case."""
    awaited: dict[str, str]
    """Name of the file that another case waits for before it is finished, by case."""
    name: str = "dying"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        """Wait for the file of the case, then end the process or finish the case."""
        (self.folder / case.id).touch()
        limit = time.monotonic() + 60.0
        file = self.fatal.get(case.id, self.awaited.get(case.id, case.id))
        while not (self.folder / file).exists() and time.monotonic() < limit:
            time.sleep(0.02)
        if case.id in self.fatal:
            os._exit(1)
        return Skipped("finished")
