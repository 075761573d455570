"""Changes of the inputs of a case on the command line: `--set KEY=VALUE`.

A changed case is a copy with another content: its digest, its comparison with the library and its converged values
are those of a case whose files state the new values.
"""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from pydantic import BaseModel

from pantocheck.conformance.cases.case_file import CaseFile, PantographByLaw, PantographUse
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.key_paths import (
    KeyPath,
    check_path,
    find_field,
    holds_list,
    list_dotted_keys,
    parse_key,
)
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

ChangedPart = Literal["case", "use", "line", "pantograph"]
"""Case file, [[pantograph]] table of the case file, line file or pantograph file."""

USES = (PantographUse, PantographByLaw)
"""Models of the [[pantograph]] tables of a case file."""

MODELS_BY_PREFIX: dict[str, tuple[type[BaseModel], ...]] = {
    "": (CaseFile,),
    "line": (LineFile,),
    "pantograph": (*USES, PantographFile),
}
"""Models of the keys on the command line, by the first part of these keys."""

FIXED_KEYS = {"id", "title", "edition", "superseded_by", "on_request", "requires"}
"""Keys of a case that name it or place it in the library."""

SET_OPTION = "option --set"
"""Option of the command line that changes an input."""

PANTOGRAPH_OPTION = "option --pantograph"
"""Option of the command line that replaces the pantographs."""

_PLAIN_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_./-]*")


@dataclass(frozen=True)
class InputChange:
    """New value of one key."""

    key: str
    """Dotted key as the user wrote it."""
    part: ChangedPart
    """Part of the case that holds the key."""
    pantograph: int | None
    """Index of the pantograph in running order, from 0; None: all of them, or no key of a pantograph."""
    path: KeyPath
    """Path of the key in this part."""
    value: object
    """New value."""
    origin: str = SET_OPTION
    """File or option that states the change, for messages."""

    @property
    def shown(self) -> object:
        """Value in reports: of a pantograph that the user has named, the name of its file."""
        return Path(str(self.value)).name if self.origin == PANTOGRAPH_OPTION else self.value

    @property
    def where(self) -> str:
        """Name of the change in messages."""
        return f"{self.origin}, key {self.key}"


def parse_changes(texts: Sequence[str]) -> tuple[InputChange, ...]:
    """Parse changes of the form `KEY=VALUE`.

    Args:
        texts: Dotted keys of the case, of its line (`line.contact_wire.tension_N`) or of its pantographs
            (`pantograph[1].chain.masses_kg`; without a number, of all pantographs), with values as in TOML.

    Returns:
        The changes in their order.

    Raises:
        InputError: A text is not an assignment, a key does not exist, or its value cannot be changed.
    """
    return tuple(map(_parse_change, texts))


def build_change(key: str, value: object, origin: str = SET_OPTION) -> InputChange:
    """Build the change of one key.

    Args:
        key: Dotted key as in `parse_changes`.
        value: New value in the types of TOML; a number for a key that holds a list stands for a list of one item.
        origin: File or option that states the change, for messages.

    Raises:
        InputError: The key does not exist, or its value cannot be changed.
    """
    parts = parse_key(key)
    if parts is None:
        raise InputError(f"{origin} {key[:80]!r}", "is not a key of a case", "Write e.g. line.contact_wire.tension_N .")
    change = _locate(key, parts, value, origin)
    names = {part for part in parts if isinstance(part, str)}
    if names & PROVENANCE or parts[0] in FIXED_KEYS:
        raise InputError(change.where, "cannot be changed on the command line", "Copy the file and edit the copy.")
    if parts[0] == "limit":
        raise InputError(change.where, "is a limit", "Give your limits in a file with --limits.")
    models = MODELS_BY_PREFIX[str(parts[0]) if change.part != "case" else ""]
    everywhere = [
        key for prefix, files in MODELS_BY_PREFIX.items() for model in files for key in list_dotted_keys(model, prefix)
    ]
    prefix = parts[: len(parts) - len(change.path)]
    check_path(models, change.path, change.value, change.where, everywhere, prefix)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return replace(change, value=[value]) if is_number and holds_list(models, change.path) else change


def replace_pantographs(names: Sequence[str]) -> tuple[InputChange, ...]:
    """Changes that replace the pantographs of a case.

    Args:
        names: Pantograph files in running order, or one for all; an FMU stands for the pantograph file beside it.

    Raises:
        InputError: There is no pantograph file beside an FMU.
    """
    paths = [str(find_pantograph_file(Path(name)).absolute()) for name in names]
    keys = ["pantograph.model"] if len(paths) == 1 else [f"pantograph[{n}].model" for n in range(1, len(paths) + 1)]
    return tuple(build_change(key, path, PANTOGRAPH_OPTION) for key, path in zip(keys, paths, strict=True))


def find_pantograph_file(path: Path) -> Path:
    """Pantograph file by its path, or beside an FMU: with its name, or fmu.toml.

    Raises:
        InputError: There is none beside the FMU.
    """
    if path.suffix != ".fmu":
        return path
    candidates = (path.with_suffix(".toml"), path.with_name("fmu.toml"))
    if found := next((file for file in candidates if file.is_file()), None):
        return found
    hint = f"Write a pantograph file with a table [fmu] as {candidates[0].name}."
    raise InputError(PANTOGRAPH_OPTION, f"there is no {' or '.join(c.name for c in candidates)} beside {path}", hint)


def _parse_change(text: str) -> InputChange:
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals or parse_key(key) is None:
        raise InputError(f"{SET_OPTION} {text[:80]!r}", "is not of the form KEY=VALUE", "Write e.g. speed_km_h=300 .")
    return build_change(key, parse_value(value, f"{SET_OPTION}, key {key}"))


def _locate(key: str, parts: KeyPath, value: object, origin: str) -> InputChange:
    """Part of the case that a key belongs to, and its path there."""
    if len(parts) > 1 and parts[0] == "line":
        return InputChange(key, "line", None, parts[1:], value, origin)
    if len(parts) > 1 and parts[0] == "pantograph":
        index, path = (parts[1], parts[2:]) if isinstance(parts[1], int) else (None, parts[1:])
        of_use = bool(path) and any(find_field(model, str(path[0])) is not None for model in USES)
        return InputChange(key, "use" if of_use else "pantograph", index, path, value, origin)
    return InputChange(key, "case", None, parts, value, origin)


def parse_value(text: str, where: str) -> object:
    """Parse a value of TOML; a plain word is text, because a shell removes quotes.

    Raises:
        InputError: The text is not a value; `where` is its place in the message.
    """
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        if _PLAIN_WORD.fullmatch(text):
            return text
        hint = "Write a value as in TOML, e.g. 22e3, [5, 6], true or text."
        raise InputError(where, f"{text[:60]!r} is not a value", hint) from None
