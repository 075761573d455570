"""The same results give the same bytes: results without times, and a date from the environment."""

import json
import os
from typing import Any

from pantocheck.conformance.input_files.input_error import InputError

NAME = "results.json"

LATEST = 253402300799
"""End of the year 9999 [s since 1970], the last date that can be written."""


def read_source_date() -> int | None:
    """`SOURCE_DATE_EPOCH` [s since 1970]; None if the environment does not set it.

    Raises
    ------
    InputError
        `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch is None:
        return None
    if not (epoch.isascii() and epoch.isdigit() and int(epoch[:15]) <= LATEST):
        raise InputError("SOURCE_DATE_EPOCH", f"'{epoch}' is not a date", "Give whole seconds since 1970-01-01 UTC.")
    return int(epoch)


def strip_times(results: dict[str, Any]) -> dict[str, Any]:
    """Results whose times are null, so that two runs of the same input give the same certificate."""
    return results | {
        "started": None,
        "cases": [
            case | {"run": case["run"] | {"wall_s": None}} if "wall_s" in (case.get("run") or {}) else case
            for case in results["cases"]
        ],
    }


def encode_attachment(results: dict[str, Any]) -> bytes:
    """JSON text in ASCII with sorted keys: equal results give equal bytes."""
    return (json.dumps(results, indent=1, sort_keys=True, allow_nan=False) + "\n").encode("ascii")
