"""JSON files: bounded reading, parsing and validation."""

import json
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from pantocheck.conformance.input_files.bounded_file import read_bytes
from pantocheck.conformance.input_files.format_versions import check_version
from pantocheck.conformance.input_files.input_error import InputError, join_errors

T = TypeVar("T")


def read_json(path: Path, kind: str, largest: int) -> Any:
    """Read a JSON file.

    Args:
        path: The file.
        kind: Name of its kind in messages, e.g. `results`.
        largest: Largest accepted size [bytes].

    Returns:
        Parsed content.

    Raises:
        InputError: The file cannot be read, is too large or is not JSON.
    """
    where = f"{kind} '{path.name}'"
    return parse_json(read_bytes(path, where, largest), where, largest)


def parse_json(content: bytes, where: str, largest: int) -> Any:
    """Parse JSON from bytes; parameters and errors as in `read_json`."""
    if len(content) > largest:
        raise InputError(where, f"has {len(content)} bytes", f"At most {largest} bytes are accepted.")
    try:
        parsed = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(
            where,
            f"is not valid JSON ({_clean(str(error))})",
            "Write the file again with the same command of the suite.",
        ) from None
    check_version(parsed, where)
    return parsed


def validate_json(data: Any, model: TypeAdapter[T], where: str, hint: str) -> T:
    """Validate parsed JSON.

    Args:
        data: Parsed JSON.
        model: Required structure.
        where: Name of the file in messages.
        hint: Next step of the user, such as the command that writes a valid file.

    Returns:
        Validated model.

    Raises:
        InputError: The data do not fit the model; there is one message for each key at fault.
    """
    try:
        return model.validate_python(data)
    except ValidationError as error:
        raise join_errors([_explain(detail, where, hint) for detail in error.errors(include_url=False)]) from None


def _explain(detail: ErrorDetails, where: str, hint: str) -> InputError:
    # Items of a list are numbered from 1, as in messages about TOML files.
    parts = (f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in detail["loc"])
    key = "".join(parts).removeprefix(".")
    message = detail["msg"]
    return InputError(f"{where}, key {_clean(key) or 'top level'}", _clean(message[:1].lower() + message[1:]), hint)


def _clean(text: str) -> str:
    """One printable line of at most 300 characters."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))[:300]
