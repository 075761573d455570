"""Files of a case: case file, line, pantographs and damping models, with changes of the command line."""

import copy
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.input_changes import InputChange, find_pantograph_file
from pantocheck.conformance.cases.lift_force import resolve_rule
from pantocheck.conformance.cases.limits import repeat_limits
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.key_paths import find_holders, follow_path
from pantocheck.conformance.core.sourced_table import SourcedTable
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml, validate_model
from pantocheck.conformance.line.elements.damping import Damping, DampingFile, overlay_damping
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

T = TypeVar("T", bound=BaseModel)

OPTION = "option "
"""First words of the origin of a change by an option of the command line."""

LONGEST_NAME = 200
"""Largest number of characters of a file name that is looked up in an invalid case file."""


@dataclass(frozen=True)
class CaseFiles:
    """Files of a case, read with changes of the command line."""

    path: Path
    """Case file."""
    tree: dict[str, Any]
    """Content of the case file."""
    changes: tuple[InputChange, ...] = ()
    """Changes of this case."""

    def read(self) -> Case:
        """Read all files, each valid by itself.

        Raises:
            InputError: A file cannot be read or is invalid; the error is that of the first such file.
        """
        path = self.path
        file, case_changes = self._read_case()
        line, line_changes = self._read_line(file.line)
        if file.damping is not None:
            damping = _read_damping(path, file.damping, "damping") if isinstance(file.damping, str) else file.damping
            self._refuse_hidden_changes(damping)
            line = line.model_copy(update={"damping": overlay_damping(line.damping, damping)})
        pantographs = [self._read_pantograph(use.model, i) for i, use in enumerate(file.pantograph)]
        static_pantograph = None
        if file.apparent_mass is not None:
            static_pantograph = _read_pantograph(_locate(path, file.apparent_mass.model, "apparent_mass.model"), ())[0]
        models = dict(file.mass_drop.compared) if file.mass_drop is not None else {}
        models |= getattr(file.study, "models", {}) | getattr(file.study, "before", {})
        dampings = {name: _read_damping(path, model, f"damping model {name!r}") for name, model in models.items()}
        descriptions = (*case_changes, *line_changes, *(text for _, texts in pantographs for text in texts))
        return Case(
            file,
            line,
            tuple(pantograph for pantograph, _ in pantographs),
            repeat_limits(file.limit, len(pantographs)),
            static_pantograph,
            dampings,
            tuple(dict.fromkeys(descriptions)),
        )

    def _refuse_hidden_changes(self, damping: Damping) -> None:
        """Refuse changes of the damping of the line that the damping of the case replaces.

        Raises:
            InputError: A change would have no effect.
        """
        replaced = {(), *((name,) for name in (*damping.model_fields_set, "modal"))}
        for change in self.changes:
            if change.part == "line" and change.path[0] == "damping" and change.path[1:2] in replaced:
                raise InputError(
                    change.where,
                    "has no effect: the case replaces this damping of its line",
                    'Change the key damping of the case: a table, such as {"contact_wire": {...}}, or a file.',
                )

    def list_errors(self) -> Iterator[InputError]:
        """Errors of the line and of the pantographs that the case file names, whether or not it is valid."""
        uses = self.tree.get("pantograph")
        readings: list[tuple[Callable[[str], object], object]] = [(self._read_line, self.tree.get("line"))]
        for i, use in enumerate(uses if isinstance(uses, list) else ()):
            if isinstance(use, dict):
                readings.append((partial(self._read_pantograph, index=i), use.get("model")))
        for read, name in readings:
            if isinstance(name, str) and 0 < len(name) <= LONGEST_NAME:
                try:
                    read(name)
                except InputError as error:
                    yield error

    def _read_case(self) -> tuple[CaseFile, tuple[str, ...]]:
        tree, case_changes = change_case(self.tree, self.changes)
        return validate_model(tree, CaseFile, _name_file("case", self.path, case_changes, self.changes)), case_changes

    def _read_line(self, name: str) -> tuple[LineFile, tuple[str, ...]]:
        changes = [change for change in self.changes if change.part == "line"]
        return _read_changed(_locate(self.path, name, "line"), LineFile, "line", changes)

    def _read_pantograph(self, name: str, index: int) -> tuple[PantographFile, tuple[str, ...]]:
        changes = [c for c in self.changes if c.part == "pantograph" and c.pantograph in (None, index)]
        file, texts = _read_pantograph(path := _locate(self.path, name, f"pantograph[{index + 1}].model"), changes)
        naming = [c for c in self.changes if c.part == "use" and c.path == ("model",) and c.pantograph in (None, index)]
        return (_name_fmu(file, path) if naming else file), texts


def _read_pantograph(path: Path, changes: Sequence[InputChange]) -> tuple[PantographFile, tuple[str, ...]]:
    file, descriptions = _read_changed(path, PantographFile, "pantograph", changes)
    return _resolve(file, path, _name_file("pantograph", path, descriptions, changes)), descriptions


def _resolve(file: PantographFile, path: Path, where: str) -> PantographFile:
    """Pantograph with the formula of its force rule, and the digest of its FMU."""
    resolved = resolve_rule(file, where)
    return resolved if file.fmu is None else resolved.model_copy(update={"fmu": file.fmu.identify(path)})


def _read_changed(path: Path, model: type[T], kind: str, changes: Sequence[InputChange]) -> tuple[T, tuple[str, ...]]:
    """Read a file with changes; the texts describe those that differ from the file."""
    tree, descriptions = change_tree(read_toml(path, kind), model, changes)
    return validate_model(tree, model, _name_file(kind, path, descriptions, changes)), descriptions


def _name_file(kind: str, path: Path, descriptions: Sequence[str], changes: Sequence[InputChange]) -> str:
    """Name of a file in messages, with its changes and the options that state them."""
    if not descriptions:
        return f"{kind} '{path.name}'"
    options = dict.fromkeys(change.origin for change in changes if change.origin.startswith(OPTION))
    stated = [*(option.removeprefix(OPTION) for option in options), "; ".join(descriptions)]
    return f"{kind} '{path.name}' with {' '.join(stated)}"


def _read_damping(case_path: Path, name: str, key: str) -> Damping:
    return read_model(_locate(case_path, name, key), DampingFile, "damping").damping


def _locate(case_path: Path, name: str, key: str) -> Path:
    return locate_part(name, case_path.parent, f"case '{case_path.name}', key {key}")


# Content of the files of a case with inputs that were changed on the command line.
def change_case(tree: dict[str, Any], changes: Sequence[InputChange]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Apply changes to the content of a case file; returns and errors as in `change_tree`."""
    uses = tree.get("pantograph")
    count = len(uses) if isinstance(uses, list) else 0
    assigned: list[InputChange] = []
    for change in changes:
        if change.part == "case":
            assigned.append(change)
        elif change.part != "line" and (count == 0 or (change.pantograph or 0) >= count):
            hint = "Pantographs are numbered from 1 in running order."
            raise InputError(change.where, f"the case has {count_noun(count, 'pantograph')}", hint)
        elif change.part == "use":
            numbers = range(count) if change.pantograph is None else (change.pantograph,)
            assigned += [replace(change, part="case", path=("pantograph", i, *change.path)) for i in numbers]
    return change_tree(tree, CaseFile, assigned)


def change_tree(
    tree: dict[str, Any], model: type[BaseModel], changes: Sequence[InputChange]
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Apply changes to the content of a file.

    Args:
        tree: Content of the file.
        model: Model of the file.
        changes: Changes of this file.

    Returns:
        tree: Changed content. Changed keys count as `provisional`, because the source of their table does not state
            them.
        descriptions: One text per value that differs, with the value of the file.

    Raises:
        InputError: A table or a list item does not exist.
    """
    if not changes:
        return tree, ()
    changed = copy.deepcopy(tree)
    descriptions = []
    for change in changes:
        holder, part, before = follow_path(changed, change.path, change.where)
        if before == change.value and isinstance(before, bool) == isinstance(change.value, bool):
            continue
        holder[part] = change.value
        _mark_provisional(changed, model, change)
        stated = "not in the file" if before is None else f"file: {_show(before)}"
        descriptions.append(f"{change.key} = {_show(change.shown)} ({stated})")
    return changed, tuple(dict.fromkeys(descriptions))


def _mark_provisional(tree: dict[str, Any], model: type[BaseModel], change: InputChange) -> None:
    """Add a changed key to the key `provisional` of its sourced table."""
    holders = find_holders(model, change.path)
    sourced = [i for i, table in enumerate(holders) if table is not None and issubclass(table, SourcedTable)]
    if sourced:
        table, key, _ = follow_path(tree, change.path[: sourced[-1] + 1], change.where)
        marked = table.get("provisional", [])
        table["provisional"] = list(dict.fromkeys([*marked, key])) if isinstance(marked, list) else marked


def _show(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 200 else text[:197] + "..."


# Files of lines and pantographs that another file names: beside it, or in the library.
def locate_part(name: str, folder: Path, where: str) -> Path:
    """Path of a named file: relative to a folder, or else to the library.

    Args:
        name: Name of the file.
        folder: Folder of the file that contains the name.
        where: Place of the name in messages.

    Raises:
        InputError: There is no such file.
    """
    for place in (folder, library_folder()):
        if (place / name).is_file():
            return place / name
    hint = f"Name a file relative to {folder} or to the library, e.g. en50318-2002/line.toml ."
    raise InputError(where, f"there is no file {name!r}", hint)


def read_line_file(path: Path) -> LineFile:
    """Read a line file; InputError if it is invalid."""
    return read_model(path, LineFile, "line")


def read_pantograph_file(path: Path) -> PantographFile:
    """Read a pantograph file with its force rule and the digest of its FMU; InputError if it is invalid."""
    return _resolve(read_model(path, PantographFile, "pantograph"), path, f"pantograph '{path.name}'")


def read_named_pantograph(path: Path) -> PantographFile:
    """Read a pantograph file, or that beside an FMU, which the user has named: its FMU may run."""
    file = find_pantograph_file(path)
    return _name_fmu(read_pantograph_file(file), file)


def _name_fmu(file: PantographFile, path: Path) -> PantographFile:
    return file if file.fmu is None else file.model_copy(update={"fmu": file.fmu.name(path)})
