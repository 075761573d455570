"""Versions of file formats: a file of another version is refused.

A format has the id `pantocheck.NAME/VERSION`, in the key `schema` of its files (docs/format-versions.md).
"""

import re
from collections.abc import Mapping
from importlib.metadata import version
from typing import Final

from pantocheck.conformance.core.input_error import InputError

VERSION: Final = 1
"""Version of every format."""

_ID = re.compile(r"pantocheck\.([a-z-]{1,40})/([0-9]{1,6})")


def check_version(content: object, where: str) -> None:
    """Refuse a file of another version; a file without the key `schema` has one version only.

    Args:
        content: Parsed TOML or JSON.
        where: Name of the file in messages.

    Raises:
        InputError: The file states another version of its format.
    """
    stated = content.get("schema") if isinstance(content, Mapping) else None
    match = _ID.fullmatch(stated) if isinstance(stated, str) else None
    if match is not None and int(match[2]) != VERSION:
        suite = f"Pantocheck {version('pantocheck')}"
        raise InputError(
            f"{where}, key schema",
            f"version {int(match[2])} of the format {match[1]}; {suite} reads version {VERSION}",
            "Install the version of Pantocheck that wrote the file.",
        )
