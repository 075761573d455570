"""Values of parsed JSON and TOML files that no file of the suite holds, and that programs read in different ways."""

import math
from typing import Any

from pantocheck.conformance.core.input_error import InputError

LARGEST_INTEGER = 2**63 - 1
"""Largest whole number that TOML and most programs can read."""

_FLOAT = frozenset((float,))


def check_values(tree: object, where: str) -> None:
    """Check every key, text and number of nested dictionaries and lists, nested as deeply as the parser allows.

    Args:
        tree: Parsed content.
        where: Name of the file in messages.

    Raises:
        InputError: A text has half of a surrogate pair, a whole number has more than 63 bits, or a number is infinite
            or NaN.
    """
    waiting: list[tuple[str, Any]] = [("", tree)]
    while waiting:
        key, value = waiting.pop()
        if isinstance(value, dict):
            for name, item in value.items():
                _check_text(name, key, where)
                waiting.append((f"{key}.{name}".lstrip("."), item))
        elif isinstance(value, list):
            if _FLOAT.issuperset(map(type, value)) and all(map(math.isfinite, value)):
                continue  # a curve
            waiting += [(f"{key}[{number}]", item) for number, item in enumerate(value, 1)]
        elif isinstance(value, str):
            _check_text(value, key, where)
        elif isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            found = f"is a whole number of {value.bit_length()} bits"
            raise InputError(name_key(where, key), found, f"Give a number of at most {LARGEST_INTEGER}.")
        elif isinstance(value, float) and not math.isfinite(value):
            raise InputError(name_key(where, key), f"{value} is not a finite number", "Give a finite number.")


def name_key(where: str, key: str) -> str:
    """Place of a key in a message: long or nested keys are shortened."""
    shown = key if len(key) <= 80 else f"{key[:40]}...{key[-37:]}"
    return f"{where}, key {shown}" if key else where


def collect_pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Table of the pairs of a JSON object.

    Raises:
        ValueError: A key occurs twice: programs differ in the value that they take.
    """
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"key {next(name for name in names if names.count(name) > 1)!r} occurs twice")
    return table


def _check_text(text: str, key: str, where: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError as error:
        found = f"has half of a surrogate pair at character {error.start + 1}"
        raise InputError(name_key(where, key), found, "Write the character itself, or both halves.") from None
