"""Sources of cases from outside the library: folders of the user, and installed distributions."""

import hashlib
import re
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from pantocheck.conformance.cases.case_origin import CaseOrigin
from pantocheck.conformance.cases.claimed_names import OUTSIDE_PREFIX, find_claims
from pantocheck.conformance.cases.installed_cases import CasePackage, list_case_packages
from pantocheck.conformance.input_files.bounded_file import file_digest
from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.toml_file import read_toml

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
    if problems := [*find_claims(folder, trees, prefix)]:
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
