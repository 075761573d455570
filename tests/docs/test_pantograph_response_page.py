"""Page on measured responses: sidecar, limits and units follow the formats."""

import re
import tomllib
from pathlib import Path

from jsonschema import validate

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimits
from pantocheck.conformance.core.units import convert_key
from pantocheck.conformance.pantograph.response_record import (
    RESPONSE_FORMS,
    ResponseSidecar,
    list_response_columns,
    read_response,
)

TEXT = (Path(__file__).parents[2] / "docs" / "pantograph-response.md").read_text(encoding="utf-8")
SIDECAR, COLUMNS, LIMITS = re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)


def test_sidecar_and_table_of_the_page_can_be_read(tmp_path: Path) -> None:
    table = re.search(r"```\n(frequency_Hz;.*?)```", TEXT, re.DOTALL)
    assert table is not None
    (tmp_path / "at-70N.csv").write_text(table[1], encoding="utf-8")
    (tmp_path / "at-70N.toml").write_text(SIDECAR.replace("rows = 120", "rows = 3"), encoding="utf-8")
    assert read_response(tmp_path / "at-70N.csv").frequency.tolist() == [0.5, 0.6, 0.7]
    tables = tomllib.loads(SIDECAR + COLUMNS)
    validate(tables, build_schema("response"))
    sidecar = ResponseSidecar.model_validate(tables)
    assert set(sidecar.columns) <= set(list_response_columns(sidecar.kind))


def test_limits_of_the_page_follow_their_format() -> None:
    tables = tomllib.loads(LIMITS)
    validate(tables, build_schema("comparison-limits"))
    assert ComparisonLimits.model_validate(tables).limit[0].heights_m == (0.6, 1.2)


def test_units_of_the_page_are_those_of_each_kind() -> None:
    rows = re.findall(r"^\| `(\w+)` \| [\w ]+ over \w+ \| (.*) \|$", TEXT, re.MULTILINE)
    assert {kind for kind, _ in rows} == set(RESPONSE_FORMS)
    for kind, units in rows:
        for unit in re.findall(r"`_(\w+)`", units):
            assert convert_key(f"modulus_{unit}", list_response_columns(kind)) is not None, (kind, unit)
