"""TOML files: bounded reading, parsing and validation."""

import re
import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from pantocheck.conformance.core.files import read_text
from pantocheck.conformance.core.format_versions import check_version
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.parsed_values import check_values
from pantocheck.conformance.core.validation_messages import build_input_error

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
    check_values(tree, where)
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


# Syntax errors of TOML files: the line, and a hint at frequent causes.
LONGEST_QUOTE = 80
"""Largest number of characters of a line that is quoted."""

_PLACE = re.compile(r"\(at line (\d+), column \d+\)")
_DECIMAL_COMMA = re.compile(r"=\s*([+-]?\d+,\d+)")
_FOLDER_SEPARATOR = re.compile(r"""=\s*\[?\s*"[^"']*\\""")
_NUMBER_WITH_UNIT = re.compile(r"[=\[,]\s*([+-]?\d[\d_]*(?:\.\d+)?(?:[eE][+-]?\d+)?)\s*([A-Za-z%°µΩ][\w/%°²³]*)")


def explain_syntax_error(text: str, error: tomllib.TOMLDecodeError) -> tuple[str, str]:
    """Explain a syntax error.

    Args:
        text: Content of the file.
        error: Error of the parser.

    Returns:
        found: Message of the parser with the quoted line.
        hint: Next step of the user.
    """
    message = f"is not valid TOML: {str(error)[:200]}"
    place = _PLACE.search(str(error))
    if place is None:
        return message, "Complete the end of the file; see toml.io."
    line = text.split("\n")[int(place[1]) - 1].strip()
    quoted = line if len(line) <= LONGEST_QUOTE else line[:LONGEST_QUOTE] + "..."
    return f"{message}: {quoted!r}", _suggest_correction(line[:LONGEST_QUOTE])


def _suggest_correction(line: str) -> str:
    if found := _DECIMAL_COMMA.search(line):
        return f"Write a decimal point: {found[1].replace(',', '.')} in place of {found[1]} ."
    if found := _NUMBER_WITH_UNIT.search(line):
        return f"Write {found[1]} without {found[2]!r}: the end of the key states the unit, e.g. _N or _m."
    if _FOLDER_SEPARATOR.search(line):
        return "Write a path with forward slashes, or in single quotes: 'C:\\records'."
    return "Correct this line; see toml.io."


# Lines of tables and keys in TOML files, for messages at the right line.

# Longest forms first. A text without its end reaches to the end of the line or file, so that no place is read twice.
_TEXT_OR_COMMENT = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"""|\Z)'
    r"|'''(?:[^']|'(?!''))*+(?:'''|\Z)"
    r'|"(?:[^"\\\n]|\\[^\n])*+"?'
    r"|'[^'\n]*+'?"
    r"|#[^\n]*+",
    re.DOTALL,
)
_ANY_TABLE = re.compile(r"^[ \t]*+\[", re.MULTILINE)


def list_table_lines(text: str, name: str) -> tuple[int, ...]:
    """Lines of the headers `[[name]]` of a list of tables.

    Args:
        text: Content of a TOML file.
        name: Name of the list. Tables that are written inside other values, or with a quoted name, are not found.

    Returns:
        Number of each line, from 1.
    """
    header = re.compile(rf"^[ \t]*+\[\[[ \t]*+{re.escape(name)}[ \t]*+\]\]", re.MULTILINE)
    bare = _blank_texts(text)
    return tuple(_line_of(bare, match.start()) for match in header.finditer(bare))


def find_key_line(text: str, key: str) -> int | None:
    """Line of a key before the first table of a file; None without it.

    Args:
        text: Content of a TOML file.
        key: Name of the key, without dots.

    Returns:
        Number of the line, from 1.
    """
    bare = _blank_texts(text)
    table = _ANY_TABLE.search(bare)
    head = bare if table is None else bare[: table.start()]
    found = re.search(rf"^[ \t]*+{re.escape(key)}[ \t]*+=", head, re.MULTILINE)
    return None if found is None else _line_of(bare, found.start())


def _blank_texts(text: str) -> str:
    """Content without texts and comments; the line breaks remain."""
    return _TEXT_OR_COMMENT.sub(lambda match: "\n" * match[0].count("\n"), text)


def _line_of(text: str, start: int) -> int:
    return text.count("\n", 0, start) + 1
