"""Files for contributors, citations and list of changes agree with the project."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import yaml

from pantocheck.conformance.core.trust import Trust

ROOT = Path(__file__).parents[2]
FORMS = sorted(set((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")) - {ROOT / ".github/ISSUE_TEMPLATE/config.yml"})
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
HEADING = re.compile(r"^## (\d+\.\d+\.\d+) \((unreleased|\d{4}-\d{2}-\d{2})\)$", re.MULTILINE)


def test_version_agrees_with_citation_and_changelog() -> None:
    released = HEADING.findall((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert released[0][0] == PROJECT["version"] == CITATION["version"]
    # A version has a date exactly when it is released.
    state = released[0][1]
    assert str(CITATION.get("date-released", "unreleased")) == state
    assert all(date != "unreleased" for _, date in released[1:])
    versions = [tuple(map(int, version.split("."))) for version, _ in released]
    assert versions == sorted(set(versions), reverse=True)


def test_citation_templates_and_guide_agree_with_the_project() -> None:
    own, *_ = PROJECT["license"].split(" AND ")  # the others are licences of packaged libraries
    assert CITATION["license"] == own
    assert {"cff-version", "message", "title", "authors"} <= CITATION.keys()
    for path in FORMS:
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        assert {"name", "description", "body"} <= form.keys(), path
        assert any(part.get("validations", {}).get("required") for part in form["body"]), path
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert all(f"| `{level}` |" in guide for level in get_args(Trust))
