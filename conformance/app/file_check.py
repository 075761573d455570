"""Check of input files of any kind: every problem of a file is reported.

The checks of a kind are imported when a file of this kind is checked, so that an editor can check at every save.
"""

import json
import os
import typing
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel, TypeAdapter

from pantocheck.conformance.app.schemas import READ_FORMATS, WRITTEN_FORMATS
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.json_file import read_json, validate_json
from pantocheck.conformance.core.measured_table import CSV, TABLE_SUFFIXES
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.core.workbook_reading import WORKBOOK_SUFFIXES
from pantocheck.conformance.line.library_folder import library_folder


def check_input_file(path: Path, kind: str | None = None) -> str:
    """Check a TOML file, JSON file or table of a record, with the files that it names.

    Args:
        path: The file; a folder stands for one without input files.
        kind: Kind of a TOML file, a key of `READ_FORMATS`; None: it is recognised by its keys.

    Returns:
        Kind and size of the valid content, and a line for each warning.

    Raises:
        InputError: The file is invalid; the error lists all problems.
    """
    if path.is_dir():
        raise InputError(
            f"folder '{path}'",
            "there is no input file in it",
            "Give a folder with TOML files, or with tables of supports and droppers.",
        )
    suffix = path.suffix.lower()
    if suffix in TABLE_SUFFIXES:
        from pantocheck.conformance.app.record_file_checks import check_table

        return check_table(path)
    if suffix == ".json":
        return _check_json(path)
    where = f"file '{path.name}'"
    if kind is None:
        kind = recognise_toml(read_toml(path, "file"), where)
    elif kind not in READ_FORMATS:
        raise InputError("option --kind", f"there is no kind {kind!r}", suggest_names(kind, list(READ_FORMATS)))
    return _find_check(kind)(path)


def _find_check(kind: str) -> Callable[[Path], str]:
    """Check of a kind of TOML file."""
    match kind:
        case "case" | "limits" | "line" | "pantograph":
            from pantocheck.conformance.app import model_file_checks

            return model_file_checks.MODEL_FILE_CHECKS[kind]
        case "record" | "mass-drop" | "static" | "response":
            from pantocheck.conformance.app import record_file_checks

            return record_file_checks.RECORD_FILE_CHECKS[kind]
        case "dossier":
            return _check_dossier
        case _:
            return lambda path: f"{kind} file" if read_model(path, READ_FORMATS[kind], kind) else ""


def _check_json(path: Path) -> str:
    from pantocheck.conformance.results.results_reading import MAX_RESULTS_BYTES

    where = f"file '{path.name}'"
    content = read_json(path, "file", MAX_RESULTS_BYTES)
    kind = recognise_json(content, where)
    validate_json(content, TypeAdapter(WRITTEN_FORMATS[kind]), where, f"See `pantocheck schema {kind}`.")
    return f"{kind} file"


def _check_dossier(path: Path) -> str:
    from pantocheck.conformance.dossier.dossier_reading import read_dossier
    from pantocheck.conformance.dossier.validation import check_documents

    dossier = read_dossier(path)
    lines, cases = count_noun(len(dossier.lines), "line"), count_noun(len(dossier.cases), "reference model")
    pairs, tables = count_noun(len(dossier.file.pair), "pair"), count_noun(check_documents(dossier), "table")
    return f"dossier: {lines}, {cases}, {pairs} of runs, {tables}"


# Kind of an input file, recognised by its keys.
def recognise_toml(tree: Mapping[str, Any], where: str) -> str:
    """Kind of a TOML file, a key of `READ_FORMATS`: the format with the fewest unknown and missing keys.

    Raises:
        InputError: No format has a key of the file, or several formats fit equally well.
    """
    ranks = {kind: rank for kind, schema in _read_schemas().items() if (rank := _rank(schema, tree)) is not None}
    best = [kind for kind, rank in ranks.items() if rank == min(ranks.values())]
    if len(best) == 1:
        return best[0]
    found = f"may be of the kind {' or '.join(best)}" if best else "has no key of any kind of input file"
    raise InputError(where, found, f"Give the option --kind with one of {', '.join(READ_FORMATS)}.")


def recognise_json(content: Any, where: str) -> str:
    """Kind of a JSON file by its schema; a list contains modes."""
    if isinstance(content, list):
        return "modes"
    stated = content.get("schema") if isinstance(content, dict) else None
    for kind, model in WRITTEN_FORMATS.items():
        if isinstance(stated, str) and stated in _list_schemas(model):
            return kind
    known = [name for model in WRITTEN_FORMATS.values() for name in _list_schemas(model)]
    found = "no schema is stated" if stated is None else f"found {str(stated)[:60]!r}"
    raise InputError(f"{where}, key schema", found, f"Known are {', '.join(known)}.")


def _list_schemas(model: type[BaseModel]) -> tuple[str, ...]:
    """Values of the key `schema` of a JSON file; a list of modes has no such key."""
    field = model.model_fields.get("schema_")
    return () if field is None else typing.get_args(field.annotation)


@cache
def _read_schemas() -> dict[str, dict[str, Any]]:
    """Kept schemas by kind, without the imports of the models."""
    folder = library_folder() / "schema"
    return {kind: json.loads((folder / f"{kind}.schema.json").read_text("utf-8")) for kind in READ_FORMATS}


def _rank(schema: Mapping[str, Any], tree: Mapping[str, Any]) -> tuple[bool, int, int] | None:
    """Other schema, number of unknown keys and number of missing keys; None if no key is known."""
    known = schema["properties"]
    if known.keys().isdisjoint(tree):
        return None
    version = known.get("schema", {}).get("const")
    return tree.get("schema") != version, len(tree.keys() - known), len(set(schema.get("required", ())) - tree.keys())


# Search of a folder for input files.
SKIPPED_FOLDERS = ("build", "node_modules", "__pycache__")
"""Names of folders with files of tools."""

ENVIRONMENT_FILE = "pyvenv.cfg"
"""File in the folder of a virtual environment."""


def list_input_files(folder: Path) -> Iterator[Path]:
    """List the input files of a folder and of the folders below it.

    Hidden folders, virtual environments and `SKIPPED_FOLDERS` below the folder are left out.

    Yields:
        TOML file with a key of any kind of input file, or that cannot be read; table of supports or droppers. A sidecar
        stands for its table.
    """
    for parent, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not _is_skipped(Path(parent, name)))
        yield from (path for name in sorted(names) if _is_input(path := Path(parent, name)))


def _is_skipped(folder: Path) -> bool:
    return folder.name.startswith(".") or folder.name in SKIPPED_FOLDERS or (folder / ENVIRONMENT_FILE).is_file()


def _is_input(path: Path) -> bool:
    suffix = path.suffix.lower()
    if suffix in (*CSV.suffixes, *WORKBOOK_SUFFIXES):
        from pantocheck.conformance.line.support_rows import read_line_tables

        try:
            return not path.with_suffix(".toml").is_file() and bool(read_line_tables(path))
        except InputError:
            return True
    if suffix != ".toml":
        return False
    try:
        tree = read_toml(path, "file")
        return any(_rank(schema, tree) is not None for schema in _read_schemas().values())
    except InputError:
        return True
