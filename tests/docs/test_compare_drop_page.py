"""Page on recorded drops: its limits follow their format, and its options are those of the command."""

import re
import tomllib
from pathlib import Path

from jsonschema import validate
from typer.testing import CliRunner

from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimits
from pantocheck.conformance.schemas import build_schema

TEXT = (Path(__file__).parents[2] / "docs" / "compare-drop.md").read_text(encoding="utf-8")


def test_limits_of_the_page_follow_their_format() -> None:
    tables = tomllib.loads(re.search(r"```toml\n(.*?)```", TEXT, re.DOTALL)[1])
    validate(tables, build_schema("comparison-limits"))
    (limit,) = ComparisonLimits.model_validate(tables).limit
    assert (limit.sensors, limit.window_s, limit.band_Hz) == ((1, 2, 3, 4), (0.0, 10.0), (0.3, 20.0))


def test_options_of_the_page_are_those_of_the_command() -> None:
    listed = set(re.findall(r"`(--[a-z-]+)", TEXT))
    help_text = CliRunner().invoke(app, ["drop", "compare", "--help"], env={"COLUMNS": "200"}).output
    assert listed == set(re.findall(r"(--[a-z-]+)", help_text)) - {"--help", "--out"}
