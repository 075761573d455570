"""Catalogue: cases that a command can name by id, those of the library and those from outside."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path

from pantocheck.conformance.cases.case import CaseOrigin
from pantocheck.conformance.cases.case_source import (
    OUTSIDE_PREFIX,
    CaseSource,
    build_repeated_id_error,
    list_case_sources,
    list_library,
    open_case_folder,
)
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.line.library_folder import library_folder


@dataclass(frozen=True)
class CaseEntry:
    """File of a case."""

    path: Path
    """The file."""
    origin: CaseOrigin | None = None
    """Source from outside; None: the library."""


@dataclass(frozen=True)
class Catalogue:
    """Cases by id. Installed distributions are searched only if an id or pattern begins with `own/`."""

    folders: tuple[CaseSource, ...] = ()
    """Folders of the user."""

    @cached_property
    def listed(self) -> dict[str, CaseEntry]:
        """Cases of the library and of the folders of the user, in the order of reports."""
        library = {name: CaseEntry(path) for name, path in list_library(library_folder()).items()}
        return library | _join_sources(self.folders)

    @property
    def every(self) -> dict[str, CaseEntry]:
        """All cases, those of installed distributions included; errors as in `find`."""
        return self._list_cases(f"{OUTSIDE_PREFIX}*")

    def find(self, pattern: str) -> list[CaseEntry]:
        """Find cases by id, pattern or path.

        Args:
            pattern: Id, pattern with `*` and `?`, or path of a case file, which ends in .toml.

        Raises:
            InputError: There is no such case, or the cases of a distribution are invalid.
        """
        if (entry := self.find_id(pattern)) is not None:
            return [entry]
        if pattern.endswith(".toml"):
            return [_name_file(Path(pattern))]
        known = self._list_cases(pattern)
        matches = [entry for name, entry in known.items() if fnmatchcase(name, pattern)]
        if not matches:
            raise InputError(
                f"case '{pattern}'",
                "there is no case with this id",
                suggest_names(pattern, list(known)) + " `pantocheck cases` lists all cases.",
            )
        return matches

    def find_id(self, name: str) -> CaseEntry | None:
        """Case with an id; None if there is none. Errors as in `find`."""
        return self._list_cases(name).get(name)

    def _list_cases(self, pattern: str) -> dict[str, CaseEntry]:
        """Listed cases, and those of the distributions whose ids the pattern may match."""
        if not pattern.startswith(OUTSIDE_PREFIX):
            return self.listed
        return self.listed | _join_sources((*self.folders, *list_case_sources(pattern)))


LIBRARY = Catalogue()
"""Catalogue without folders of the user."""


def open_catalogue(folders: Sequence[Path | str]) -> Catalogue:
    """Catalogue of the library, installed distributions and folders of the user.

    Raises:
        InputError: A folder has no cases, an id that is not its own, or an id of another folder.
    """
    sources = tuple(open_case_folder(folder) for folder in dict.fromkeys(Path(folder).resolve() for folder in folders))
    named = {name: None for source in sources for name in source.cases}
    _join_sources((*sources, *dict.fromkeys(other for name in named for other in list_case_sources(name))))
    return Catalogue(sources)


def _name_file(path: Path) -> CaseEntry:
    """Entry of a case file that is named by its path; a file that cannot be read is refused when the case is read."""
    digest = file_digest(path) if path.is_file() else ""
    return CaseEntry(path, CaseOrigin(kind="file", name=path.name, version="", digest=digest))


def _join_sources(sources: Sequence[CaseSource]) -> dict[str, CaseEntry]:
    joined: dict[str, CaseEntry] = {}
    for name, entry in _list_entries(sources):
        if (other := joined.setdefault(name, entry)) != entry:
            raise build_repeated_id_error(name, _place(other), _place(entry))
    return joined


def _list_entries(sources: Sequence[CaseSource]) -> Iterator[tuple[str, CaseEntry]]:
    for source in sources:
        for name, path in source.cases.items():
            yield name, CaseEntry(path, source.origin)


def _place(entry: CaseEntry) -> str:
    return f"{entry.path} ({entry.origin.text})" if entry.origin is not None else str(entry.path)
