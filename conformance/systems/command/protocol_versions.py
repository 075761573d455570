"""Versions of the protocol of programs.

A program of version 1 knows lines whose supports are alike, with uniform wires. Version 2 adds keys for single
supports and places, and lists by support in the derived values. Keys that a line does not use are left out of its
message, so that a line of version 1 has the same message in both.
"""

from collections.abc import Iterator
from typing import Final

from pydantic import BaseModel

from pantocheck.conformance.cases.line_file import LineFile

FIRST_VERSION: Final = "pantocheck.command/1"
PROTOCOLS: Final = (FIRST_VERSION, "pantocheck.command/2")


def find_newer_key(line: LineFile) -> str | None:
    """First key of a line that programs of version 1 do not know, with its place in the line file; None if none."""
    return next(_newer_keys(line, ""), None)


def _newer_keys(value: object, path: str) -> Iterator[str]:
    """Keys that are left out where they are not used: they came after version 1."""
    if isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            part, key = getattr(value, name), f"{path}.{name}".strip(".")
            if field.exclude_if is None:
                yield from _newer_keys(part, key)
            elif not field.exclude_if(part):
                yield key
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from _newer_keys(part, f"{path}.{name}")
    elif isinstance(value, tuple):
        for number, part in enumerate(value, 1):
            yield from _newer_keys(part, f"{path}[{number}]")
