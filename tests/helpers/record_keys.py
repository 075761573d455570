"""Keys of the sidecar of a record of contact forces."""

from typing import Any


def record_keys(**keys: Any) -> dict[str, Any]:
    """Sidecar of an unfiltered record in `a.csv`, with further keys."""
    return {"schema": "pantocheck.record/1", "file": "a.csv", "filter_applied_Hz": "none", **keys}
