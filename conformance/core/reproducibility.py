"""Date of a document from the environment, so that the same results give the same bytes."""

import os
from datetime import UTC, datetime

from pantocheck.conformance.core.input_error import InputError

LATEST = 253402300799
"""End of the year 9999 [s since 1970], the last date that can be written."""


def read_source_date() -> int | None:
    """`SOURCE_DATE_EPOCH` [s since 1970]; None if the environment does not set it.

    Raises:
        InputError: `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch is None:
        return None
    if not (epoch.isascii() and epoch.isdigit() and int(epoch[:15]) <= LATEST):
        raise InputError("SOURCE_DATE_EPOCH", f"'{epoch}' is not a date", "Give whole seconds since 1970-01-01 UTC.")
    return int(epoch)


def format_date(seconds: int) -> str:
    """Date of a document [s since 1970] in words; empty if it is not known."""
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC" if seconds else ""
