"""Names of the library that files from outside must not have: ids of cases, names of files, names of profiles.

Ids that begin with `own/` are reserved for cases from outside: no case of the library, now or later, has one.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.input_files.input_error import InputError

OUTSIDE_PREFIX = "own/"
"""Beginning of the ids of cases from outside."""


@cache
def _library_files() -> dict[str, Path]:
    """Files of the library by their names in it without suffix; that of a case is its id."""
    folder = library_folder()
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.rglob("*.toml")}


def find_claims(folder: Path, trees: Mapping[Path, Mapping[str, Any]], prefix: str) -> Iterator[InputError]:
    """Find the names that files from outside must not have.

    Args:
        folder: Folder of the files.
        trees: Content of each TOML file of the folder.
        prefix: Required beginning of the id of a case: `own/`, or `own/` and the name of a distribution.

    Yields:
        A file with the name, id or profile name of a library file, a case without the prefix, or a repeated id. Both
        files are named.
    """
    first: dict[str, Path] = {}
    for path, tree in trees.items():
        yield from _check_file_name(path, path.relative_to(folder).with_suffix("").parts)
        yield from _check_profile(path, tree)
        if isinstance(name := tree.get("id"), str):
            yield from _check_id(path, name, prefix)
            if (other := first.setdefault(name, path)) != path:
                yield repeated_id(name, str(other), str(path))


def repeated_id(name: str, first: str, second: str) -> InputError:
    """Error for an id that two places have."""
    return InputError(
        f"case '{name}'", f"two files have this id: {first} and {second}", "Give each case a different id."
    )


def _check_file_name(path: Path, parts: tuple[str, ...]) -> Iterator[InputError]:
    # Cases name a file of the library by folder and name; a case beside such a folder would read this file instead.
    endings = ("/".join(parts[-length:]) for length in range(2, len(parts) + 1))
    for name in endings:
        if name in _library_files():
            yield InputError(
                f"file '{path}'",
                f"has the name of the library file {_library_files()[name]}",
                "Rename the file or its folder. A folder of cases adds to the library and replaces nothing of it.",
            )


def _check_profile(path: Path, tree: Mapping[str, Any]) -> Iterator[InputError]:
    if not str(tree.get("schema", "")).startswith("pantocheck.profile/"):
        return
    if (library := _library_files().get(f"profiles/{tree.get('name')}")) is not None:
        yield InputError(
            f"profile '{path}', key name",
            f"{tree['name']!r} is the name of the library profile {library}",
            "Give the profile another name.",
        )


def _check_id(path: Path, name: str, prefix: str) -> Iterator[InputError]:
    where, hint = f"case '{path}', key id", f'Begin the id with {prefix}, for example id = "{prefix}{path.stem}".'
    if (library := _library_files().get(name)) is not None:
        yield InputError(where, f"{name!r} is the id of the library file {library}", hint)
    elif not name.startswith(prefix):
        yield InputError(where, f"{name!r} does not begin with {prefix}, so the library could use it later", hint)
