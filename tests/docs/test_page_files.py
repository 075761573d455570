"""Files that pages show: sidecars, limits, profiles and lines can be read and follow their schemas."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import validate

from helpers.docs_pages import list_blocks, read_page
from helpers.listed_spans import list_spans
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.profile_file import ExclusionRule, Profile, load_profile
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimits
from pantocheck.conformance.core.extras import EXTRA_OF_PACKAGE
from pantocheck.conformance.core.measured_table import TABLE_FORMATS
from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.core.units import convert_key
from pantocheck.conformance.drops.drop_sidecar import DropSidecar
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.response_record import (
    RESPONSE_FORMS,
    ResponseSidecar,
    list_response_columns,
    read_response,
)
from pantocheck.conformance.records.record_sidecar import RecordSidecar


def read_tables(text: str, schema: str) -> dict[str, Any]:
    """Tables of a block, which follow a schema."""
    tables = tomllib.loads(text)
    validate(tables, build_schema(schema))
    return tables


def read_limits(text: str) -> ComparisonLimits:
    return ComparisonLimits.model_validate(read_tables(text, "comparison-limits"))


def test_limits_and_sidecar_of_a_drop(tmp_path: Path) -> None:
    (limit,) = read_limits(list_blocks("compare-drop.md", "toml")[0]).limit
    assert (limit.sensors, limit.window_s, limit.band_Hz) == ((1, 2, 3, 4), (0.0, 10.0), (0.3, 20.0))
    text = list_blocks("identification.md", "toml")[0]
    (tmp_path / "drop.toml").write_text(text, encoding="utf-8")
    sidecar = read_model(tmp_path / "drop.toml", DropSidecar, "sidecar")
    assert (sidecar.drop.mass_kg, sidecar.record.trigger_nominal_s) == (40.0, 6.0)
    assert [channel.unit for channel in sidecar.channel] == ["m/s2"]
    read_tables(text, "mass-drop")


def test_sidecar_table_and_limits_of_a_response(tmp_path: Path) -> None:
    described, columns, limits = list_blocks("pantograph-response.md", "toml")
    table = next(text for text in list_blocks("pantograph-response.md", "") if text.startswith("frequency_Hz;"))
    (tmp_path / "at-70N.csv").write_text(table, encoding="utf-8")
    (tmp_path / "at-70N.toml").write_text(described.replace("rows = 120", "rows = 3"), encoding="utf-8")
    assert read_response(tmp_path / "at-70N.csv").frequency.tolist() == [0.5, 0.6, 0.7]
    sidecar = ResponseSidecar.model_validate(read_tables(described + columns, "response"))
    assert set(sidecar.columns) <= set(list_response_columns(sidecar.kind))
    assert read_limits(limits).limit[0].heights_m == (0.6, 1.2)


def test_units_of_a_response_are_those_of_each_kind() -> None:
    rows = re.findall(r"^\| `(\w+)` \| [\w ]+ over \w+ \| (.*) \|$", read_page("pantograph-response.md"), re.MULTILINE)
    assert {kind for kind, _ in rows} == set(RESPONSE_FORMS)
    for kind, units in rows:
        for unit in re.findall(r"`_(\w+)`", units):
            assert convert_key(f"modulus_{unit}", list_response_columns(kind)) is not None, (kind, unit)


def test_suffixes_and_extras_of_logger_files() -> None:
    """The table has one row per format of `TABLE_FORMATS`."""
    rows = [row.split("|") for row in read_page("logger-files.md").splitlines() if re.match(r"\| .*\(`\.", row)]
    listed = {(*re.findall(r"`(\.\w+)`", row[1]), *re.findall(r"extra `(\w+)`", row[2])) for row in rows}
    extras = {row: [EXTRA_OF_PACKAGE[row.library]] if row.library else [] for row in TABLE_FORMATS}
    assert listed == {(*row.suffixes, *extras[row]) for row in TABLE_FORMATS}


def test_sidecars_and_profile_of_logger_files() -> None:
    layout, *sidecars, exclusion, last, profile = list_blocks("logger-files.md", "toml")
    assert TextSettings.model_validate(tomllib.loads(layout)["table"]).header_lines == 4
    for text in (*sidecars, last):
        tables = read_tables(text, "record")
        read = RecordSidecar.model_validate(tables)
        assert set(read.model_dump(by_alias=True, exclude_unset=True)) == tables.keys()
    assert ExclusionRule.model_validate(tomllib.loads(exclusion)["exclusion"]).kinds == ("overlap", "tunnel")
    base = load_profile("acceptance-ac").model_dump(mode="json", by_alias=True)
    assert Profile.model_validate({**base, **tomllib.loads(profile)}).shortest_contact_loss_s == 0.005


def test_spans_and_supports_of_a_line() -> None:
    *parts, tolerances = map(tomllib.loads, list_blocks("line-files.md", "toml"))
    spans, supports = (part["geometry"] for part in parts)
    tables = list_spans(read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line"))
    tables["geometry"] |= spans | supports
    line = LineFile.model_validate(tables | tolerances)
    assert line.covariance_of(["dropper_stiffness", "steady_arm_stiffness"], [0.01, 0.01]).tolist() == [
        [pytest.approx(0.01), 0.0],
        [0.0, pytest.approx(1e-4)],
    ]
    layout = line.layout
    assert [limit.position for limit in layout.limits] == [0.0, 63.0, 121.5, 175.5, 238.5]
    rise = [0.0, 0.003 * 3.0, 0.003 * 61.5, 0.003 * 115.5, 0.003 * 120.0]
    heights = [5.3, 5.3, 5.3, 5.32, 5.32]
    for limit, height, risen in zip(layout.limits, heights, rise, strict=True):
        assert abs(limit.contact_wire_height - height - risen) < 1e-12
    assert line.steady_arm_at(layout.supports[2]).acts == "push"
