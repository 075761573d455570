"""Line files with their equal spans, and their supports, listed one by one."""

from dataclasses import replace
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile


def list_spans(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of a line file of equal spans in the long form."""
    geometry = {
        key: value for key, value in tables["geometry"].items() if key not in {"span_m", "spans", "provisional"}
    }
    spans = [{"length_m": tables["geometry"]["span_m"]}] * tables["geometry"]["spans"]
    return tables | {"geometry": geometry | {"span_list": spans}}


def list_supports(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of a line file with listed spans and every value of every support; those of the line are wrong."""
    parts = {name: _numbers(tables[name]) for name in ("steady_arm", "messenger_support")}
    geometry = dict(tables["geometry"])
    last = len(geometry["span_list"])
    staggers = {key: geometry.pop(key, 0.0) for key in ("stagger_contact_wire_m", "stagger_messenger_m")}
    heights = {"contact_wire_height_m": 0.0, "encumbrance_m": geometry["encumbrance_m"]}
    geometry |= {"contact_wire_height_m": 1.0, "encumbrance_m": 0.1 + geometry["encumbrance_m"]}
    geometry["support"] = [
        {"number": n}
        | {key: value if n % 2 == 0 else -value for key, value in staggers.items()}
        | heights
        | (parts if 0 < n < last else {})
        for n in range(last + 1)
    ]
    wrong = {
        name: tables[name] | {key: _other(key, value) for key, value in part.items()} for name, part in parts.items()
    }
    return tables | wrong | {"geometry": geometry}


def vary_short_line(case: Case) -> Case:
    """The same case on listed spans; supports 3 and 4 differ in height, one arm and one messenger support in stiffness.

    The analysis section has the spans 3 and 4, of 60 m and 54 m.
    """
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    tables["geometry"]["span_list"] = [
        {"length_m": 60.0},
        {"length_m": 60.0},
        {"length_m": 60.0},
        {"length_m": 54.0, "droppers": {"x_m": [5.0, 12.0, 19.5, 27.0, 34.5, 42.0, 49.0]}},
        {"length_m": 60.0},
    ]
    tables["geometry"]["support"] = [
        {"number": 3, "contact_wire_height_m": 0.05, "steady_arm": {"vertical_stiffness_N_m": 600.0}},
        {"number": 4, "contact_wire_height_m": 0.1, "messenger_support": {"stiffness_N_m": 2e5}},
    ]
    return replace(case, line=LineFile.model_validate(tables))


def _numbers(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key not in {"trust", "source", "provisional", "note"}}


def _other(key: str, value: Any) -> Any:
    """Another value of the same key."""
    others = {"level": "none", "none": "level", "pull": "push", "push": "pull", "free": "fixed", "fixed": "free"}
    return others[value] if isinstance(value, str) else value / 2 + 1.0
