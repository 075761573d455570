"""Line files with several tension sections, from the lines of the library."""

import tomllib
from typing import Any

from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile


def section_tables(
    name: str = "en50318-2002", spans: tuple[int, ...] = (6, 6), overlap: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Tables of a line of the library with tension sections; the overlap has three spans and a parabola of 0.5 m."""
    tables = tomllib.loads((library_folder() / name / "line.toml").read_text("utf-8"))
    overlap = overlap or {"spans": 3, "anchor_rise_m": 0.5}
    tables["geometry"]["spans"] = sum(spans) - (len(spans) - 1) * overlap["spans"]
    return tables | {"section": [{"spans": number} for number in spans], "overlap": overlap}


def section_line(
    name: str = "en50318-2002", spans: tuple[int, ...] = (6, 6), overlap: dict[str, Any] | None = None
) -> LineFile:
    """Line file of `section_tables`."""
    return LineFile.model_validate(section_tables(name, spans, overlap))
