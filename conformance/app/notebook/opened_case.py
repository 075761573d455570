"""Cases in Python: open, change, simulate and grade."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from pantocheck.conformance.app.notebook.display import describe_in_one_line
from pantocheck.conformance.app.notebook.graded_results import GradedResults
from pantocheck.conformance.app.notebook.opened_drop import OpenedDrop
from pantocheck.conformance.app.notebook.opened_run import SimulatedRun
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.cases.library import load_case, load_entry
from pantocheck.conformance.comparison.compared_run import deliver_case, describe_delivery
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.case_selection import choose_verdicts
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.runs.system import System, missing_record_reason
from pantocheck.conformance.runs.system_choice import choose_system

if TYPE_CHECKING:
    from pantocheck.conformance.app.notebook.opened_line import OpenedLine

ORIGIN = "with_"
"""Origin of a change in messages."""


@dataclass(frozen=True)
class OpenedCase:
    """A case with the changes of its inputs; `with_` gives a changed copy."""

    path: Path
    """Case file."""
    case: Case
    """Content of the case, its line and its pantographs."""
    changes: tuple[InputChange, ...] = ()
    """Changes of the inputs."""

    def __repr__(self) -> str:
        """Id, speed, pantographs, line and changed keys in one line."""
        speed, pantographs = self.case.file.speed_km_h, len(self.case.pantographs)
        facts = [self.id, "at rest" if speed is None else f"{speed:g} km/h"]
        facts += [count_noun(pantographs, "pantograph")] if pantographs else []
        facts += [f"changed: {' '.join(change.key for change in self.changes)}"] if self.changes else []
        return describe_in_one_line(self, *facts, f"line: {self.case.line.title}")

    @property
    def id(self) -> str:
        """Id of the case."""
        return self.case.id

    @property
    def inputs(self) -> dict[str, Any]:
        """All inputs as dictionaries: `case`, `line` and `pantographs`, with the keys of the files."""
        return {
            "case": self.case.file.model_dump(mode="json", exclude_none=True, by_alias=True),
            "line": self.case.line.model_dump(mode="json", exclude_none=True, by_alias=True),
            "pantographs": [
                pantograph.model_dump(mode="json", exclude_none=True, by_alias=True)
                for pantograph in self.case.pantographs
            ],
        }

    @property
    def line(self) -> "OpenedLine":
        """Line of the case at rest, in the elements of the case."""
        from pantocheck.conformance.app.notebook.opened_line import OpenedLine

        return OpenedLine(self.case.line, self.case.file.discretisation.element_m)

    def with_(self, changes: Mapping[str, object] | None = None, /, **further: object) -> "OpenedCase":
        """Copy of the case with other inputs.

        Args:
            changes: New values by key, as of `--set`: keys of the case, of its line (`line.contact_wire.tension_N`) or
                of its pantographs (`pantograph[1].chain.masses_kg`).
            **further: New values of keys of the case without dots, for example `speed_km_h=300`.

        Raises:
            InputError: A key does not exist, or the changed files are invalid.
        """
        values = {**(changes or {}), **further}
        kept = (change for change in self.changes if change.key not in values)
        every = (*kept, *(build_change(key, value, ORIGIN) for key, value in values.items()))
        return OpenedCase(self.path, load_case(self.path, every, self.case.origin), every)

    def simulate(self) -> SimulatedRun:
        """Simulate the passage once with the reference simulator, with the discretisation of the case.

        The uncertainties of discretisation and start stay unknown; `run` determines them with further simulations.

        Raises:
            InputError: The case has no train.
        """
        from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator

        return self._run_on(UnrefinedSimulator())

    def run(self, system: str = "builtin") -> SimulatedRun:
        """Run the case on a system: `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.

        Args:
            system: Kind of system: `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.

        Raises:
            InputError: The system does not run the case, fails, or delivers no record.
        """
        return self._run_on(choose_system(system))

    def grade(self, system: str = "builtin", trust: Trust = "secondary") -> GradedResults:
        """Run the case on a system and grade it, as `pantocheck run` does.

        A changed case of the library has no limits, because they hold for its own inputs.

        Args:
            system: `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.
            trust: Lowest trust of the limits that count.

        Raises:
            InputError: The system is wrong.
        """
        requested = choose_verdicts(None, system)
        participation = Participation(requested=requested)
        return GradedResults(run_cases([self.case], choose_system(system), trust, participation=participation))

    def simulate_drop(self, number: int = 1) -> OpenedDrop:
        """Simulate a mass drop of the case with the reference simulator, as `pantocheck drop simulate` does.

        Args:
            number: Number of the drop, from 1.

        Raises:
            InputError: The case has no such mass drop.
        """
        from pantocheck.conformance.drops.drop_simulation import simulate_drop

        drops = () if self.case.file.mass_drop is None else self.case.file.mass_drop.drop
        if not 1 <= number <= len(drops):
            hint = "Choose a case with a [mass_drop] table." if not drops else "Drops are numbered from 1."
            raise InputError(f"case '{self.id}'", f"has {len(drops)} mass drops, not drop {number}", hint)
        return OpenedDrop(simulate_drop(self.case, number).record)

    def _run_on(self, system: System) -> SimulatedRun:
        delivered = deliver_case(self.case, system)
        if delivered.record is None:
            raise InputError(f"case '{self.id}'", missing_record_reason(delivered), "Choose a case with a train.")
        return SimulatedRun(describe_delivery(self.case, system, delivered), self.case, system, delivered.record)


def open_case(name: str | Path, cases: str | Path | Sequence[str | Path] = ()) -> OpenedCase:
    """Open a case by its id, or a case file by its path.

    Args:
        name: Id such as `en50318-2018/ac-simple/320-twin`, or path of a case file.
        cases: Folders with further cases, whose ids begin with `own/`.

    Raises:
        InputError: There is no such case, it is invalid, several cases have this name, or a folder of cases is refused.
    """
    entries = open_catalogue(_list_folders(cases)).find(str(name))
    if len(entries) != 1:
        raise InputError(f"case '{name}'", f"{len(entries)} cases have this name", "Give the id of one case.")
    return OpenedCase(entries[0].path, load_entry(entries[0]))


def list_cases(cases: str | Path | Sequence[str | Path] = ()) -> list[str]:
    """Ids of all cases of the library, of folders with further cases, and of installed distributions.

    Args:
        cases: Folders with further cases, whose ids begin with `own/`.

    Raises:
        InputError: A folder of cases, or an installed distribution with cases, is refused.
    """
    return list(open_catalogue(_list_folders(cases)).every)


def _list_folders(cases: str | Path | Sequence[str | Path]) -> list[str | Path]:
    return [cases] if isinstance(cases, str | Path) else [*cases]


# Cases built in Python: their files are written, so that every command can use them, too.
Part = str | Path | Mapping[str, Any]
"""Line or pantograph: path of a file, name in the library, or its keys with their values."""


def build_case(folder: str | Path, line: Part, pantographs: Sequence[Part], **keys: Any) -> OpenedCase:
    """Write the files of a case into a folder, and open the case.

    Args:
        folder: Folder of the files `case.toml` and, for parts that are given by their keys, `line.toml`,
            `pantograph-1.toml`, and so on. Files of an earlier call are replaced.
        line: Path of a line file, its name in the library, or the keys of a line file.
        pantographs: Pantographs in running order, given as the line is.
        **keys: Further keys of the case file, for example `speed_km_h=250` and `evaluated_spans=[5, 6]`. Default `id`:
            `own/` and the name of the folder; default `title`: the id. `uplift_force_N` is the lift force of every
            pantograph; `pantograph` has a table of further keys for each of them.

    Raises:
        InputError: A file cannot be written, or the case, the line or a pantograph is invalid.
    """
    place = Path(folder)
    name = keys.get("id", f"own/{place.resolve().name}")
    models = [{"model": _place(part, place / f"pantograph-{i}.toml")} for i, part in enumerate(pantographs, 1)]
    tables = keys.pop("pantograph", [{}] * len(models))
    uses = [{**table, **model} for table, model in zip(tables, models, strict=True)]
    if "uplift_force_N" in keys:
        uses = [use | {"uplift_force_N": keys["uplift_force_N"]} for use in uses]
    stated = {key: value for key, value in keys.items() if key != "uplift_force_N"}
    case = {"id": name, "title": name, "line": _place(line, place / "line.toml"), **stated, "pantograph": uses}
    _write(place / "case.toml", case)
    return open_case(place / "case.toml")


def _place(part: Part, path: Path) -> str:
    """Name of a part for the case file; a part that is given by its keys is written."""
    if isinstance(part, Mapping):
        _write(path, part)
        return path.name
    return str(Path(part).resolve()) if Path(part).is_file() else str(part)


def _write(path: Path, content: Mapping[str, Any]) -> None:
    try:
        text = tomli_w.dumps(dict(content))
    except (TypeError, ValueError) as error:
        raise InputError(f"file '{path.name}'", str(error), "Give text, numbers, lists and dictionaries.") from None
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, text.encode())
