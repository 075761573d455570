"""The page on releases: versions agree everywhere, and the named files exist."""

import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "releasing.md").read_text(encoding="utf-8")
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
HEADING = re.compile(r"^## (\d+\.\d+\.\d+) \((unreleased|\d{4}-\d{2}-\d{2})\)$", re.MULTILINE)


def test_version_agrees_with_citation_and_changelog() -> None:
    released = HEADING.findall((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert released[0][0] == VERSION == CITATION["version"]
    # A version has a date exactly when it is released.
    state = released[0][1]
    assert str(CITATION.get("date-released", "unreleased")) == state
    assert all(date != "unreleased" for _, date in released[1:])
    versions = [tuple(map(int, version.split("."))) for version, _ in released]
    assert versions == sorted(set(versions), reverse=True)


def test_files_and_commands_of_the_page_exist() -> None:
    for name in re.findall(r"`([\w./-]+\.(?:py|yml|toml|md|cff))`|`(\.ci/\w+)`", PAGE):
        assert (ROOT / (name[0] or name[1])).exists(), name
    section = re.search(r"section `(\w+)` of `.ci/thorough`", PAGE)
    assert section is not None
    assert f"\n{section[1]}() {{" in (ROOT / ".ci" / "thorough").read_text(encoding="utf-8")
