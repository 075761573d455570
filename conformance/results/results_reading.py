"""Reading results.json from a stranger."""

import json
from pathlib import Path

from pydantic import ValidationError

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.results_format import Results

MAX_RESULTS_BYTES = 64 * 2**20
"""Bytes of results; those of two cases have a few hundred thousand."""


def read_results(path: Path) -> Results:
    """Read and check a results.json.

    Raises
    ------
    InputError
        It cannot be read, or is not what the suite writes.
    """
    where = f"results '{path.name}'"
    try:
        if path.stat().st_size > MAX_RESULTS_BYTES:
            raise InputError(where, f"{path.stat().st_size} bytes", f"Results have at most {MAX_RESULTS_BYTES} bytes.")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(where, f"cannot be read from {path} ({error.strerror})", "Check the path.") from None
    return parse_results(content, where)


def parse_results(content: bytes, where: str) -> Results:
    """Results from the bytes of a results.json.

    Parameters
    ----------
    content : bytes
        Of the file.
    where : str
        The file, for messages.

    Raises
    ------
    InputError
        Too large, not JSON, or not what the suite writes.
    """
    if len(content) > MAX_RESULTS_BYTES:
        raise InputError(where, f"{len(content)} bytes", f"Results have at most {MAX_RESULTS_BYTES} bytes.")
    try:
        data = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InputError(where, f"not JSON ({_line(str(error))})", "Let the suite write it again.") from None
    try:
        return Results.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = _line(".".join(map(str, first["loc"]))) or "top level"
        hint = "The results must have the format that 'pantocheck schema results' prints."
        raise InputError(f"{where}, key {key}", _line(first["msg"]), hint) from None


def _line(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))[:300]
