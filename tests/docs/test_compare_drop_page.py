"""Page on recorded drops: its limits follow their format."""

import re
import tomllib
from pathlib import Path

from jsonschema import validate

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimits

TEXT = (Path(__file__).parents[2] / "docs" / "compare-drop.md").read_text(encoding="utf-8")


def test_limits_of_the_page_follow_their_format() -> None:
    tables = tomllib.loads(re.search(r"```toml\n(.*?)```", TEXT, re.DOTALL)[1])
    validate(tables, build_schema("comparison-limits"))
    (limit,) = ComparisonLimits.model_validate(tables).limit
    assert (limit.sensors, limit.window_s, limit.band_Hz) == ((1, 2, 3, 4), (0.0, 10.0), (0.3, 20.0))
