"""JSON files: bounded reading, parsing and validation."""

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, PlainSerializer, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from pantocheck.conformance.core.files import read_bytes, write_atomically
from pantocheck.conformance.core.format_versions import check_version
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.parsed_values import check_values, collect_pairs

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
        InputError: The file cannot be read, is too large, is not JSON, or holds a value that `check_values` refuses.
    """
    where = f"{kind} '{path.name}'"
    return parse_json(read_bytes(path, where, largest), where, largest)


def parse_json(content: bytes, where: str, largest: int) -> Any:
    """Parse JSON from bytes; parameters and errors as in `read_json`."""
    if len(content) > largest:
        raise InputError(where, f"has {len(content)} bytes", f"At most {largest} bytes are accepted.")
    try:
        parsed = json.loads(content, object_pairs_hook=collect_pairs)
    except (ValueError, RecursionError) as error:
        raise InputError(
            where,
            f"is not valid JSON ({_clean(str(error))})",
            "Write the file again with the same command of the suite.",
        ) from None
    check_values(parsed, where)
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


# Base of the JSON files of an identification, whose numbers have eight significant digits.
SIGNIFICANT_DIGITS = 8
"""Digits of a number in a file: more than every uncertainty needs, and equal on all machines."""


def round_significant(value: float) -> float:
    """Round to `SIGNIFICANT_DIGITS`; a value that is not finite becomes 0, because a measured value is never 0."""
    return float(f"{value:.{SIGNIFICANT_DIGITS}g}") if math.isfinite(value) else 0.0


def round_tree(tree: object) -> object:
    """Round every number of nested dictionaries and lists to `SIGNIFICANT_DIGITS`."""
    if isinstance(tree, dict):
        return {key: round_tree(part) for key, part in tree.items()}
    if isinstance(tree, list | tuple):
        return [round_tree(part) for part in tree]
    return round_significant(tree) if isinstance(tree, float) else tree


Rounded = Annotated[float, PlainSerializer(round_significant, return_type=float)]
"""Number with full precision in memory and `SIGNIFICANT_DIGITS` in a file."""


class RoundedModel(BaseModel):
    """Part of a JSON file; unknown keys of a newer file are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True, defer_build=True)

    def rounded(self) -> Self:
        """Same model with rounded numbers, so that values in memory and in the file are equal."""
        return type(self).model_validate(self.model_dump())


def format_json(tree: Any, ascii_only: bool = True) -> str:
    """Text of lists, dictionaries with text keys, texts and numbers, as `json.dumps` with an indent of 1 writes it.

    `json.dumps` indents in Python, one number at a time; this function joins the numbers of a curve at once.

    Raises:
        ValueError: A number is not finite.
    """
    return "".join(_list_parts(tree, json.JSONEncoder(ensure_ascii=ascii_only, allow_nan=False).encode, "\n"))


def _list_parts(tree: Any, encode: Callable[[Any], str], line: str) -> Iterator[str]:
    """Parts of the text of a value; `line` is a line break with its indent."""
    inner = line + " "
    if isinstance(tree, dict) and tree:
        before = "{"
        for key, value in tree.items():
            yield f"{before}{inner}{encode(key)}: "
            yield from _list_parts(value, encode, inner)
            before = ","
        yield line + "}"
    elif isinstance(tree, list) and tree:
        if set(map(type, tree)) == {float} and all(map(math.isfinite, tree)):
            yield f"[{inner}{f',{inner}'.join(map(float.__repr__, tree))}"
        else:
            before = "["
            for value in tree:
                yield before + inner
                yield from _list_parts(value, encode, inner)
                before = ","
        yield line + "]"
    else:
        yield encode(tree)


def write_model(path: Path, model: BaseModel) -> None:
    """Write a model as JSON; equal models give equal bytes.

    Raises:
        InputError: The file cannot be written.
    """
    text = format_json(model.model_dump(mode="json", by_alias=True))
    write_atomically(path, (text + "\n").encode("ascii"))
