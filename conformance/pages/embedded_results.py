"""Results inside a certificate, from which it can be made again: one home for their selection and encoding.

The PDF has an attachment, the HTML page a data block. Both keep the order of the results, which is that of the rows of
the pages. The PDF omits the times of the run, so that two runs of the same input give the same bytes. The HTML page
prints these times, so its data block keeps them.
"""

import hashlib
import json
from datetime import datetime

from pantocheck.conformance.core.reproducibility import read_source_date
from pantocheck.conformance.results.results_format import Results

NAME = "results.json"
"""Name of the attachment."""

BLOCK_ID = "pantocheck-results"
"""Identity of the data block, a script element of the type `application/json`, which no browser executes."""

ESCAPES = str.maketrans({character: f"\\u{ord(character):04x}" for character in "<>&"})
"""Escapes of JSON for the characters that could end the data block or begin a comment in it."""


def strip_times(results: Results) -> Results:
    """Results whose times are null, so that two runs of the same input give the same certificate."""
    cases = [case.model_copy(update={"run": case.run.model_copy(update={"wall_s": None})}) for case in results.cases]
    return results.model_copy(update={"started": None, "cases": cases})


def encode_attachment(results: Results) -> bytes:
    """Attachment of the PDF: results without times as JSON text in ASCII; equal results give equal bytes."""
    return (json.dumps(strip_times(results).to_dict(), indent=1, allow_nan=False) + "\n").encode("ascii")


def digest_results(results: Results) -> str:
    """SHA-256 of the attachment of the PDF; both formats of a certificate state it."""
    return f"sha256:{hashlib.sha256(encode_attachment(results)).hexdigest()}"


def encode_data_block(results: Results) -> str:
    """Content of the data block of the HTML page: results as JSON text in ASCII without `<`, `>` and `&`."""
    return json.dumps(results.to_dict(), separators=(",", ":"), allow_nan=False).translate(ESCAPES)


def find_date(results: Results) -> int:
    """Date of a document [s since 1970]: `SOURCE_DATE_EPOCH`, else the start of the run, else 0.

    Raises:
        InputError: `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    date = read_source_date()
    if date is not None:
        return date
    started = results.started
    return int(datetime.fromisoformat(started).timestamp()) if started else 0
