"""TOML files: bounded reading, parsing and validation."""

import re
import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from pantocheck.conformance.input_files.bounded_file import read_text
from pantocheck.conformance.input_files.format_versions import check_version
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_syntax import explain_syntax_error
from pantocheck.conformance.input_files.validation_messages import build_input_error

MAX_TOML_BYTES = 5_000_000
"""Largest TOML file that is read [bytes]; no line or case needs more, and gigabytes would block the parser."""

MOST_PARTS = 100
"""Largest number of parts of a dotted key; the time and memory of the parser grow with the square of it."""

_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![\w.-])(?:{_PART}[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}")

T = TypeVar("T", bound=BaseModel)


def read_model(path: Path, model: type[T], kind: str) -> T:
    """Read and validate a TOML file.

    Args:
        path: The file.
        model: Required structure.
        kind: Name of its kind in messages, e.g. `line`.

    Returns:
        Validated content.

    Raises:
        InputError: The file cannot be read, is not TOML or does not fit the model.
    """
    return validate_model(read_toml(path, kind), model, f"{kind} '{path.name}'")


def validate_model(tree: dict[str, Any], model: type[T], where: str) -> T:
    """Validate the content of a TOML file.

    Args:
        tree: Content of the file.
        model: Required structure.
        where: Name of the file in messages, e.g. `line 'line.toml'`.

    Returns:
        Validated content.

    Raises:
        InputError: The content does not fit the model; the error lists all problems.
    """
    try:
        return model.model_validate(tree)
    except ValidationError as error:
        raise build_input_error(error, model, where, tree) from None


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Read a TOML file without validation of its keys; see `read_model`."""
    where = f"{kind} '{path.name}'"
    tree = parse_toml(read_text(path, where, MAX_TOML_BYTES), where)
    check_version(tree, where)
    return tree


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """Parse the text of a TOML file.

    Args:
        text: Text of the file.
        where: Name of the file in messages.

    Raises:
        InputError: It is not TOML, or too long in a part.
    """
    if (long := _LONG_KEY.search(text)) is not None:
        line = text.count("\n", 0, long.start()) + 1
        raise InputError(
            f"{where}, line {line}", "has a key with too many dots", f"A key may have at most {MOST_PARTS} parts."
        )
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, *explain_syntax_error(text, error)) from None
    except (ValueError, RecursionError):
        # The grammar allows numbers of thousands of digits and tables nested thousands of levels deep.
        raise InputError(
            where, "holds a number that is too long, or tables nested too deeply", "Shorten the number or the nesting."
        ) from None
