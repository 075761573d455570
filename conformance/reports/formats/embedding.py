"""Results embedded in a certificate: all but the times."""

import json
from typing import Any

NAME = "results.json"


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
