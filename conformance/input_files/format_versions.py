"""Versions of file formats: a file of an earlier version is converted step by step, one of a later version is refused.

A format has the id `pantocheck.NAME/VERSION`, in the key `schema` of its files. A key that is added keeps the version.
A key that is removed or renamed, or whose meaning changes, needs the next version and a migration
(docs/format-versions.md).
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.profile_migration import migrate_profile_1

Migration = Callable[[Mapping[str, Any], str], dict[str, Any]]
"""Conversion of the content of a file to the next version, without its key `schema`. The second argument is the name of
the file in messages; a content that the next version cannot express raises `InputError`."""

_ID = re.compile(r"pantocheck\.([a-z-]{1,40})/([0-9]{1,6})")


@dataclass(frozen=True)
class FileFormat:
    """A file format.

    Parameters
    ----------
    name : str
        Name in the id of the format.
    migrations : tuple of Migration
        Conversions from each earlier version to the next; the first converts version 1.
    """

    name: str
    migrations: tuple[Migration, ...] = ()

    @property
    def version(self) -> int:
        """Current version."""
        return 1 + len(self.migrations)

    @property
    def id(self) -> str:
        """Id of the current version, as in the key `schema`."""
        return f"pantocheck.{self.name}/{self.version}"

    def convert(self, content: Mapping[str, Any], stated: int, where: str) -> dict[str, Any]:
        """Convert the content of a file to the current version.

        Parameters
        ----------
        content : mapping
            Content of the file.
        stated : int
            Its version, at most the current one.
        where : str
            Name of the file in messages.
        """
        for migration in self.migrations[stated - 1 :]:
            content = migration(content, where)
        return {**content, "schema": self.id}


VERSIONED_FORMATS: dict[str, FileFormat] = {
    file_format.name: file_format
    for file_format in (
        FileFormat("campaign"),
        FileFormat("comparison"),
        FileFormat("comparison-limits"),
        FileFormat("converged"),
        FileFormat("damping"),
        FileFormat("dossier"),
        FileFormat("drop-comparison"),
        FileFormat("guide"),
        FileFormat("identification"),
        FileFormat("pantograph-fit"),
        FileFormat("population"),
        FileFormat("profile", (migrate_profile_1,)),
        FileFormat("record"),
        FileFormat("response"),
        FileFormat("response-comparison"),
        FileFormat("results"),
        FileFormat("static"),
        FileFormat("static-comparison"),
        FileFormat("summary"),
    )
}
"""All formats of files with a version, by name."""


def find_stated_version(content: object) -> tuple[str, int] | None:
    """Name and version of the format of a file; None if it states none."""
    stated = content.get("schema") if isinstance(content, Mapping) else None
    match = _ID.fullmatch(stated) if isinstance(stated, str) else None
    return None if match is None else (match[1], int(match[2]))


def update_content(content: Any, where: str, formats: Mapping[str, FileFormat] = VERSIONED_FORMATS) -> Any:
    """Content of a file in the current version of its format; content without a version is unchanged.

    Parameters
    ----------
    content : Any
        Parsed TOML or JSON.
    where : str
        Name of the file in messages.
    formats : mapping of str to FileFormat
        Known formats by name.

    Raises
    ------
    InputError
        The version is later than the current one, or the current version cannot express the content.
    """
    stated = find_stated_version(content)
    if stated is None or stated[0] not in formats:
        return content
    file_format, number = formats[stated[0]], stated[1]
    if not 1 <= number <= file_format.version:
        known = "version 1" if file_format.version == 1 else f"versions 1 to {file_format.version}"
        raise InputError(
            f"{where}, key schema",
            f"version {number} of the format {file_format.name}; Pantocheck {version('pantocheck')} reads {known}",
            "Install the version of Pantocheck that wrote the file, or a later one.",
        )
    return content if number == file_format.version else file_format.convert(content, number, where)
