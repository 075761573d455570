"""Page about files of data loggers: its table lists all formats, and its sidecars are valid."""

import re
import tomllib
from pathlib import Path

from jsonschema import validate

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.profile_file import ExclusionRule, Profile, load_profile
from pantocheck.conformance.core.extras import EXTRA_OF_PACKAGE
from pantocheck.conformance.core.measured_table import TABLE_FORMATS
from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.records.record_sidecar import RecordSidecar

PAGE = Path(__file__).parents[2] / "docs" / "logger-files.md"


def test_page_lists_the_suffixes_and_extras_of_all_formats() -> None:
    """The table has one row per format of `TABLE_FORMATS`."""
    rows = [row.split("|") for row in PAGE.read_text(encoding="utf-8").splitlines() if re.match(r"\| .*\(`\.", row)]
    listed = {(*re.findall(r"`(\.\w+)`", row[1]), *re.findall(r"extra `(\w+)`", row[2])) for row in rows}
    extras = {row: [EXTRA_OF_PACKAGE[row.library]] if row.library else [] for row in TABLE_FORMATS}
    assert listed == {(*row.suffixes, *extras[row]) for row in TABLE_FORMATS}


SIDECARS = re.findall(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_layout_of_the_page_is_valid() -> None:
    assert TextSettings.model_validate(tomllib.loads(SIDECARS[0])["table"]).header_lines == 4


def test_exclusion_of_the_page_is_valid() -> None:
    rule = ExclusionRule.model_validate(tomllib.loads(SIDECARS[-3])["exclusion"])
    assert rule.kinds == ("overlap", "tunnel")


def test_sidecars_of_the_page_are_valid_and_follow_their_schema() -> None:
    for text in (*SIDECARS[1:-3], SIDECARS[-2]):
        tables = tomllib.loads(text)
        validate(tables, build_schema("record"))
        read = RecordSidecar.model_validate(tables)
        assert set(read.model_dump(by_alias=True, exclude_unset=True)) == tables.keys()


def test_profile_of_the_page_is_valid() -> None:
    part = tomllib.loads(SIDECARS[-1])
    base = load_profile("acceptance-ac").model_dump(mode="json", by_alias=True)
    assert Profile.model_validate({**base, **part}).shortest_contact_loss_s == 0.005
