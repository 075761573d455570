"""Example dossier in a folder of its own, and a system whose runs are computed once for all tests."""

import pickle
import shutil
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Literal

from helpers.toml_edit import change_keys, write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.dossier.dossier_reading import read_dossier
from pantocheck.conformance.dossier.validation import Validation
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import Catenary, DiscretisedLine, discretise

EXAMPLE = Path(__file__).parents[2] / "examples" / "dossier"

REFERENCE = ["en50318-2002/250"]
"""Reference models of the tests: one is enough, and each takes a second."""


@dataclass(frozen=True)
class CachedSimulator:
    """Reference simulator without runs on other meshes; it runs each case once."""

    name: str = ReferenceSimulator.name
    version: str = ReferenceSimulator.version
    kind: Literal["builtin", "record", "command"] = "builtin"
    runs: dict[str, Delivered] = field(default_factory=dict)

    def run(self, case: Case) -> Delivered:
        """Run a case, or return its earlier result."""
        if case.digest not in self.runs:
            self.runs[case.digest] = ReferenceSimulator().run_unrefined(case)
        return self.runs[case.digest]


_discretise = cache(lambda catenary, element: discretise(pickle.loads(catenary), element))


def discretise_once(catenary: Catenary, element: float) -> DiscretisedLine:
    """Line of the static check, whose responses to forces are computed once for all tests."""
    return _discretise(pickle.dumps(catenary), element)


def copy_example(folder: Path, changes: dict[str, Any] | None = None) -> Path:
    """Copy the example dossier to a folder, with keys changed as by `change_keys`; return its path.

    The tolerances of the copy are secondary, which count without the key `trust` of the dossier.
    """
    shutil.copytree(EXAMPLE, folder, dirs_exist_ok=True)
    path = folder / "dossier.toml"
    text = path.read_text(encoding="utf-8").replace('trust = "provisional"\nnote', "note")
    content = tomllib.loads(text.replace('trust = "provisional"', 'trust = "secondary"'))
    change_keys(content, {"reference.cases": REFERENCE} | (changes or {}))
    return write_toml(path, content)


def validate_example(path: Path, system: CachedSimulator, folder: Path) -> Results:
    """Carry out the procedure for a dossier."""
    return Validation(read_dossier(path), system, folder).run()


def list_verdicts(results: Results) -> dict[str, str]:
    """Verdict of every step."""
    return {step.step: step.verdict for step in results.procedure.steps}


Spoil = Callable[[Path], object]


def edit_column(name: str, column: str, change: Callable[[float], float]) -> Spoil:
    """Change the values of one column of a measured table."""

    def spoil(folder: Path) -> None:
        path = folder / "measured" / name
        head, *rows = path.read_text(encoding="utf-8").splitlines()
        place = head.split(",").index(column)
        cells = [row.split(",") for row in rows]
        for row in cells:
            row[place] = f"{change(float(row[place])):.9g}"
        path.write_text("\n".join([head, *map(",".join, cells)]) + "\n", encoding="utf-8")

    return spoil
