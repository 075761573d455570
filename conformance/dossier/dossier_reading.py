"""Dossier with the files that it names."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeVar

from pantocheck.conformance.cases.case import Case, content_digest, json_digest
from pantocheck.conformance.cases.case_parts import locate_part, read_line_file, read_pantograph_file
from pantocheck.conformance.cases.library import overlay_limits, read_limits, select_cases
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.table_sidecar import locate_table
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.dossier.dossier_file import CaseRun, DossierFile, LineEntry, PantographEntry, RecordRun
from pantocheck.conformance.execution.plan import resolve_cases, resolve_system
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile


@dataclass(frozen=True)
class Dossier:
    """Dossier with its files."""

    file: DossierFile
    """Content of the dossier."""
    folder: Path
    """Folder of the dossier, to which its file names are relative."""
    lines: Mapping[str, LineFile]
    """Lines under validation, by name."""
    pantographs: Mapping[str, PantographFile]
    """Pantographs under validation, by name."""
    cases: tuple[Case, ...]
    """Reference models, with the cases that they require."""
    pair_cases: Mapping[str, Case]
    """Cases of the simulated runs that the system makes, by the name of the pair."""

    @property
    def system(self) -> str:
        """System under test as for `--system`, with paths relative to the working folder."""
        return resolve_system(self.file.system, self.folder)

    @property
    def digest(self) -> str:
        """SHA-256 of the dossier and of the content of all files that it names."""
        cases = [*self.cases, *self.pair_cases.values()]
        return json_digest(
            {
                "dossier": self.file.model_dump(mode="json"),
                "lines": {name: content_digest(line) for name, line in self.lines.items()},
                "pantographs": {name: content_digest(part) for name, part in self.pantographs.items()},
                "cases": [[case.id, case.digest, limits_digest(case.limits)] for case in cases],
                "sidecars": [file_digest(self.locate(name).with_suffix(".toml")) for _, name, _ in self.list_tables()],
            }
        )

    def locate(self, name: str) -> Path:
        """Path of a file that the dossier names."""
        return self.folder / name

    def list_tables(self) -> Iterator[tuple[str, str, PantographEntry | LineEntry | RecordRun]]:
        """Key and name of every measured or simulated table that the dossier names, with the entry that names it."""
        for i, pantograph in enumerate(self.file.pantograph, 1):
            for k, name in enumerate(pantograph.responses, 1):
                yield f"pantograph[{i}].responses[{k}]", name, pantograph
        for i, line in enumerate(self.file.line, 1):
            if line.statics is not None:
                yield f"line[{i}].statics", line.statics, line
        for i, pair in enumerate(self.file.pair, 1):
            if isinstance(pair.simulated, RecordRun):
                yield f"pair[{i}].simulated.record", pair.simulated.record, pair.simulated
            yield f"pair[{i}].measured.record", pair.measured.record, pair.measured

    def name_line(self, line: LineFile) -> str:
        """Name of a line in the dossier, recognised by its content; its title if the dossier does not name it."""
        return _find_name(line, self.lines) or line.title

    def name_pantograph(self, pantograph: PantographFile) -> str:
        """Name of a pantograph in the dossier, recognised by its content; its title if the dossier does not name it."""
        return _find_name(pantograph, self.pantographs) or pantograph.title


def _find_name(content: LineFile | PantographFile, known: Mapping[str, LineFile | PantographFile]) -> str | None:
    digest = content_digest(content)
    return next((name for name, other in known.items() if content_digest(other) == digest), None)


# Reading of a dossier: its models are read, and its measured tables must be there, before the first run.
Content = TypeVar("Content")


def read_dossier(path: Path) -> Dossier:
    """Read a dossier and the files that it names.

    Raises:
        InputError: A file is missing or invalid; the error lists the problems of all of them.
    """
    file = read_model(path, DossierFile, "dossier")
    reader = _FileReader(path)
    lines = {
        entry.name: reader.read(f"line[{i}].file", entry.file, read_line_file) for i, entry in enumerate(file.line, 1)
    }
    pantographs = {
        entry.name: reader.read(f"pantograph[{i}].file", entry.file, read_pantograph_file)
        for i, entry in enumerate(file.pantograph, 1)
    }
    pair_cases = {
        pair.name: reader.attempt(f"pair[{i}].simulated.case", partial(_select_run, pair.simulated.case, path.parent))
        for i, pair in enumerate(file.pair, 1)
        if isinstance(pair.simulated, CaseRun)
    }
    cases = reader.attempt("reference.cases", lambda: select_cases(resolve_cases(file.reference.cases, path.parent)))
    if (limits := file.reference.limits) is not None:
        own_limits = path.parent / limits
        cases = reader.attempt("reference.limits", lambda: overlay_limits(cases or [], read_limits(own_limits)))
    dossier = Dossier(
        file,
        path.parent,
        {name: line for name, line in lines.items() if line is not None},
        {name: part for name, part in pantographs.items() if part is not None},
        tuple(cases or ()),
        {name: case for name, case in pair_cases.items() if case is not None},
    )
    for key, name, _ in dossier.list_tables():
        reader.attempt(key, partial(_locate_document, dossier.locate(name), path.parent))
    if reader.problems:
        raise join_errors(reader.problems)
    return dossier


@dataclass(frozen=True)
class _FileReader:
    """Reader of the files of a dossier that collects all problems."""

    path: Path
    """The dossier."""
    problems: list[InputError] = field(default_factory=list)
    """Problems found so far."""

    def read(self, key: str, name: str, parse: Callable[[Path], Content]) -> Content | None:
        """Content of a file beside the dossier, or else in the library; None after a problem."""
        return self.attempt(key, lambda: parse(locate_part(name, self.path.parent, f"file '{name}'")))

    def attempt(self, key: str, read: Callable[[], Content]) -> Content | None:
        """Result of a function; None after a problem, which is kept under the key."""
        try:
            return read()
        except InputError as error:
            self.problems.extend(
                InputError(f"{self._name(key)}: {problem.where}", problem.found, problem.hint)
                for problem in error.problems
            )
            return None

    def _name(self, key: str) -> str:
        return f"dossier '{self.path.name}', key {key}"


def _locate_document(path: Path, folder: Path) -> None:
    """Find sidecar and table of a document; a summary record has no table. InputError if one is missing."""
    sidecar = path.with_suffix(".toml")
    for file in dict.fromkeys((sidecar, path)):
        if not file.is_file():
            hint = f"Name a table beside its sidecar, relative to {folder} ."
            raise InputError(f"document '{path.name}'", f"there is no file {file}", hint)
    if not sidecar.resolve().is_relative_to(folder.resolve()):
        hint = "Copy the document into this folder."
        raise InputError(f"document '{path.name}'", f"is outside the folder of the dossier, {folder}", hint)
    table = read_toml(sidecar, "sidecar").get("file")
    if isinstance(table, str):
        locate_table(sidecar, table, None)


def _select_run(name: str, folder: Path) -> Case:
    """Case of the simulated run of a pair: one case with a train."""
    cases = select_cases(resolve_cases([name], folder))
    trains = [case for case in cases if not case.is_static]
    if len(trains) != 1 or trains[0].file.mass_drop is not None:
        ids = ", ".join(case.id for case in cases)
        raise InputError(f"case '{name}'", f"expected one case with a train, found {ids}", "Give the id of one case.")
    return trains[0]
