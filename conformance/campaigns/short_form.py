"""Variations on the command line: `--vary KEY=200:350:10` and `--vary KEY=85,200`."""

import re
import tomllib
from typing import Any

from pantocheck.conformance.cases.input_changes import build_change, parse_value
from pantocheck.conformance.input_files.input_error import InputError

VARY_OPTION = "option --vary"
"""Option of the command line that varies an input."""

HINT = "Write KEY=START:STOP:STEP or KEY=VALUE,VALUE, e.g. speed_km_h=200:350:10 ."

_NUMBER = r"\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*"
_RANGE = re.compile(f"{_NUMBER}:{_NUMBER}:{_NUMBER}")


def parse_variation(text: str) -> dict[str, Any]:
    """Parse a variation of the command line into a [[vary]] table of a campaign file.

    Args:
        text: `KEY=START:STOP:STEP` or `KEY=VALUE,VALUE,...`.

    Raises:
        InputError: The text is no variation.
    """
    key, equals, values = (part.strip() for part in text.partition("="))
    where = f"{VARY_OPTION} {text[:80]!r}"
    if not equals or not key or not values:
        raise InputError(where, "is no variation", HINT)
    if (match := _RANGE.fullmatch(values)) is not None:
        start, stop, step = (parse_value(number, where) for number in match.groups())
        return {"key": key, "range": {"start": start, "stop": stop, "step": step}}
    try:
        return {"key": key, "values": tomllib.loads(f"values = [{values}]")["values"]}
    except (ValueError, RecursionError):
        return {"key": key, "values": [parse_value(value.strip(), where) for value in values.split(",")]}


def check_variation(variation: dict[str, Any]) -> None:
    """Check the key of a variation of the command line, with its first value.

    Raises:
        InputError: The key does not exist, or cannot be changed.
    """
    values = variation["values"] if "values" in variation else [variation["range"]["start"]]
    build_change(variation["key"], next(iter(values), None), VARY_OPTION)
