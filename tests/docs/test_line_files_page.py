"""The examples of docs/line-files.md are parts of a valid line."""

import tomllib
from pathlib import Path
from typing import Any

from helpers.listed_spans import list_spans
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile

PAGE = Path(__file__).parents[2] / "docs" / "line-files.md"


def read_examples() -> list[dict[str, Any]]:
    """Tables `geometry` of the page."""
    blocks = PAGE.read_text(encoding="utf-8").split("```toml\n")[1:]
    return [tomllib.loads(block.split("```")[0])["geometry"] for block in blocks]


def test_examples_form_a_valid_line() -> None:
    spans, supports = read_examples()
    tables = list_spans(read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line"))
    tables["geometry"] |= spans | supports
    layout = LineFile.model_validate(tables).layout
    assert [limit.position for limit in layout.limits] == [0.0, 63.0, 121.5, 175.5, 238.5]
    rise = [0.0, 0.003 * 3.0, 0.003 * 61.5, 0.003 * 115.5, 0.003 * 120.0]
    heights = [5.3, 5.3, 5.3, 5.32, 5.32]
    for limit, height, risen in zip(layout.limits, heights, rise, strict=True):
        assert abs(limit.contact_wire_height - height - risen) < 1e-12
    assert layout.supports[2].steady_arm.acts == "push"
