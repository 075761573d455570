"""Sources of cases: library, folders of the user, installed distributions; names that the library reserves."""

import hashlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from pantocheck.conformance.cases.case import CaseOrigin
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder

_ID = re.compile(r"^id\s*=", re.MULTILINE)


@cache
def list_library(folder: Path) -> dict[str, Path]:
    """Files of all cases below a folder, by id; the id of a case is its path in the folder."""
    # Lines, pantographs and the bibliography are in the same folders; only a case file has an id.
    return {
        path.relative_to(folder).with_suffix("").as_posix(): path
        for path in sorted(folder.rglob("*.toml"))
        if _ID.search(path.read_text(encoding="utf-8"))
    }


# Names of the library that files from outside must not have: ids of cases, names of files, names of profiles.
#
# Ids that begin with `own/` are reserved for cases from outside: no case of the library, now or later, has one.
OUTSIDE_PREFIX = "own/"
"""Beginning of the ids of cases from outside."""


@cache
def _library_files() -> dict[str, Path]:
    """Files of the library by their names in it without suffix; that of a case is its id."""
    folder = library_folder()
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.rglob("*.toml")}


def find_reserved_names(folder: Path, trees: Mapping[Path, Mapping[str, Any]], prefix: str) -> Iterator[InputError]:
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
                yield build_repeated_id_error(name, str(other), str(path))


def build_repeated_id_error(name: str, first: str, second: str) -> InputError:
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


# Packages of cases in installed distributions, found by entry points; no code of a distribution is run.
GROUP: Final = "pantocheck.cases"
"""Group of the entry points."""

LONGEST_TEXT = 100
"""Largest number of characters of a name or version that is shown; metadata are written by strangers."""


@dataclass(frozen=True, order=True)
class CasePackage:
    """Package of cases, as an entry point of an installed distribution names it."""

    name: str
    """Name of the entry point, which is free."""
    distribution: str
    version: str
    value: str
    """Name of the package that holds the case files."""

    @property
    def text(self) -> str:
        """Name in messages, such as `cases 'lines' of acme-lines 1.0`."""
        return f"cases '{self.name}' of {self.distribution} {self.version}"


def list_case_packages() -> list[CasePackage]:
    """Packages of cases of all installed distributions, by name."""
    return sorted(
        CasePackage(entry.name[:LONGEST_TEXT], *_identify_distribution(entry), entry.value)
        for entry in entry_points(group=GROUP)
    )


def _identify_distribution(entry: EntryPoint) -> tuple[str, str]:
    """Name and version of the distribution of an entry point; broken metadata may lack them."""
    stated = {} if entry.dist is None else entry.dist.metadata.json
    name, version = (" ".join(str(stated.get(key) or "unknown").split()) for key in ("name", "version"))
    return name[:LONGEST_TEXT], version[:LONGEST_TEXT]


# Sources of cases from outside the library: folders of the user, and installed distributions.
MOST_FILES = 10_000
"""Largest number of TOML files in a folder of cases; more are a wrong folder, such as a home folder."""


@dataclass(frozen=True, eq=False)
class CaseSource:
    """Folder of cases from outside."""

    origin: CaseOrigin
    """Name, version and digest of the folder or distribution."""
    cases: dict[str, Path]
    """File of every case by its id."""


def open_case_folder(folder: Path) -> CaseSource:
    """Find the cases of a folder and of the folders below it.

    Args:
        folder: Folder with TOML files; files and folders whose name begins with a dot are left out.

    Raises:
        InputError: There is no such folder or no case in it, an id does not begin with `own/`, or a file has a name of
            the library. The error lists all problems.
    """
    return _open_source(
        folder, CaseOrigin(kind="folder", name=folder.resolve().name, version="", digest=""), OUTSIDE_PREFIX
    )


def list_case_sources(pattern: str) -> list[CaseSource]:
    """Folders of cases of installed distributions; the ids of their cases begin with `own/DISTRIBUTION/`.

    Args:
        pattern: Id or pattern. Distributions none of whose ids can match it are left out, so that they cannot cause an
            error.

    Raises:
        InputError: An entry point names no folder, or its cases are refused as by `open_case_folder`.
    """
    packages = list_case_packages()
    matching = (each for each in packages if _may_match(pattern, id_prefix(each.distribution)))
    return [_open_package(package, _locate_folder(package)) for package in matching]


def id_prefix(distribution: str) -> str:
    """Beginning of the ids of a distribution: its name in lower case, with one hyphen for each run of `-`, `_`, `.`."""
    return f"{OUTSIDE_PREFIX}{re.sub(r'[-_.]+', '-', distribution).lower()}/"


def _may_match(pattern: str, prefix: str) -> bool:
    fixed, *rest = re.split(r"[*?[]", pattern, maxsplit=1)
    return fixed.startswith(prefix) or (bool(rest) and prefix.startswith(fixed))


@cache
def _open_package(package: CasePackage, folder: Path) -> CaseSource:
    origin = CaseOrigin(kind="distribution", name=package.distribution, version=package.version, digest="")
    try:
        return _open_source(folder, origin, id_prefix(package.distribution))
    except InputError as error:
        named = [InputError(f"{package.text}: {each.where}", each.found, each.hint) for each in error.problems]
        raise join_errors(named) from None


def _locate_folder(package: CasePackage) -> Path:
    """Folder of a package, found without importing it: cases are data, and no code of the distribution is run."""
    first, *further = package.value.split(".")
    try:
        spec = find_spec(first)
    except (ImportError, ValueError):
        spec = None
    places = [] if spec is None else [Path(place, *further) for place in spec.submodule_search_locations or ()]
    folder = next((place for place in places if place.is_dir()), None)
    if folder is None:
        raise InputError(
            package.text,
            f"{package.value!r} is not a folder of an installed package",
            'Name the package that holds the case files, e.g. cases = "acme_lines.cases" .',
        )
    return folder


def _open_source(folder: Path, origin: CaseOrigin, prefix: str) -> CaseSource:
    where = f"folder of cases '{folder}'"
    if not folder.is_dir():
        raise InputError(where, "there is no such folder", "Name a folder with case files.")
    files = _list_files(folder, where)
    trees = {path: read_toml(path, "file") for path in files}
    if problems := [*find_reserved_names(folder, trees, prefix)]:
        raise join_errors(problems)
    cases = {tree["id"]: path for path, tree in trees.items() if isinstance(tree.get("id"), str)}
    if not cases:
        raise InputError(where, "holds no case file", f'A case file has the key id, e.g. id = "{prefix}my-line" .')
    return CaseSource(origin.model_copy(update={"digest": _folder_digest(folder, files)}), cases)


def _list_files(folder: Path, where: str) -> list[Path]:
    files: list[Path] = []
    for path in folder.rglob("*.toml"):
        if not any(part.startswith(".") for part in path.relative_to(folder).parts):
            files.append(path)
        if len(files) > MOST_FILES:
            raise InputError(where, f"holds more than {MOST_FILES} TOML files", "Name the folder of the cases.")
    return sorted(files)


def _folder_digest(folder: Path, files: list[Path]) -> str:
    lines = (f"{path.relative_to(folder).as_posix()} {file_digest(path)}\n" for path in files)
    return "sha256:" + hashlib.sha256("".join(lines).encode()).hexdigest()
