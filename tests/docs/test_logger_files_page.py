"""Page about files of data loggers: its table lists all formats, and its sidecars are valid."""

import re
from pathlib import Path

from pantocheck.conformance.input_files.table_formats import TABLE_FORMATS

PAGE = Path(__file__).parents[2] / "docs" / "logger-files.md"


def test_page_lists_the_suffixes_and_extras_of_all_formats() -> None:
    """The table has one row per format of `TABLE_FORMATS`."""
    rows = [row.split("|") for row in PAGE.read_text(encoding="utf-8").splitlines() if re.match(r"\| .*\(`\.", row)]
    listed = {(*re.findall(r"`(\.\w+)`", row[1]), *re.findall(r"extra `(\w+)`", row[2])) for row in rows}
    assert listed == {(*row.suffixes, *filter(None, [row.extra])) for row in TABLE_FORMATS}
