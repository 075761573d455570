"""Reading of results.json."""

from pathlib import Path

from pydantic import TypeAdapter

from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.json_file import parse_json, validate_json
from pantocheck.conformance.results.results_format import CaseResult, Results

MAX_RESULTS_BYTES = 64 * 2**20
"""Largest results.json that is read [bytes]; the results of two cases have a few hundred thousand."""


def read_results(path: Path) -> Results:
    """Read and validate a results.json.

    Raises:
        InputError: It cannot be read or is not in the format of the suite.
    """
    where = f"results '{path.name}'"
    return parse_results(read_bytes(path, where, MAX_RESULTS_BYTES), where)


def parse_results(content: bytes, where: str) -> Results:
    """Parse and validate the content of a results.json.

    Args:
        content: Content of the file or of the attachment.
        where: Name of the file in messages.

    Raises:
        InputError: Too large, not JSON, or not in the format of the suite.
    """
    CaseResult.model_rebuild()  # else it would be built inside the whole, and once more when a case is graded again
    return validate_json(
        parse_json(content, where, MAX_RESULTS_BYTES),
        TypeAdapter(Results),
        where,
        "The results must have the format that 'pantocheck schema results' prints.",
    )
