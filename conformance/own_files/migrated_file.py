"""Migration of files to the current version of their format, into new files."""

import json
from pathlib import Path

import tomli_w

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.format_versions import VERSIONED_FORMATS, find_stated_version
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.json_file import read_json
from pantocheck.conformance.input_files.toml_file import MAX_TOML_BYTES, parse_toml, read_toml
from pantocheck.conformance.results.results_reading import MAX_RESULTS_BYTES


def migrate_file(path: Path, folder: Path) -> str:
    """Write a file in the current version of its format into another folder.

    Comments of a TOML file are not kept, because its content is written anew.

    Parameters
    ----------
    path : Path
        TOML or JSON file with the key `schema`.
    folder : Path
        Folder of the new file, which has the same name; no file is overwritten.

    Returns
    -------
    str
        Old and new version and the command that checks the new file, or that the file needs no migration.

    Raises
    ------
    InputError
        The file cannot be read, states no version, cannot be converted, or exists already in the folder.
    """
    where, is_json = f"file '{path.name}'", path.suffix.lower() == ".json"
    stated = find_stated_version(_read_unchanged(path, where, is_json))
    if stated is None or stated[0] not in VERSIONED_FORMATS:
        raise InputError(
            f"{where}, key schema",
            "states no version of a format",
            "Files without this key have one version only; `pantocheck check` shows what is wrong with them.",
        )
    name, number = stated
    content = read_json(path, "file", MAX_RESULTS_BYTES) if is_json else read_toml(path, "file")
    if number == VERSIONED_FORMATS[name].version:
        return f"{path}: {name} {number} is the current version; no file is written"
    target = folder / path.name
    if target.exists():
        raise InputError(f"file '{target}'", "exists already", "Give another folder. No file is overwritten.")
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n" if is_json else tomli_w.dumps(content)
    write_atomically(target, text.encode())
    kept = "" if is_json else "; comments are not kept"
    converted = f"{target}: {name} {number} converted to {VERSIONED_FORMATS[name].version}{kept}"
    return f"{converted}; now run pantocheck check {target}"


def _read_unchanged(path: Path, where: str, is_json: bool) -> object:
    """Content of a file in its own version; JSON that cannot be read is refused when it is read for conversion."""
    content = read_bytes(path, where, MAX_RESULTS_BYTES if is_json else MAX_TOML_BYTES)
    if not is_json:
        return parse_toml(content.decode("utf-8-sig", "replace"), where)
    try:
        return json.loads(content)
    except (ValueError, RecursionError):
        return None
