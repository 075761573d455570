"""Line files with their equal spans listed one by one."""

from typing import Any


def list_spans(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of a line file of equal spans in the long form."""
    geometry = {
        key: value for key, value in tables["geometry"].items() if key not in {"span_m", "spans", "provisional"}
    }
    spans = [{"length_m": tables["geometry"]["span_m"]}] * tables["geometry"]["spans"]
    return tables | {"geometry": geometry | {"span_list": spans}}
