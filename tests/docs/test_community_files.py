"""Files for contributors and citations agree with the project."""

import tomllib
from pathlib import Path
from typing import get_args

import yaml

from pantocheck.conformance.core.trust import Trust

ROOT = Path(__file__).parents[2]
FORMS = sorted(set((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")) - {ROOT / ".github/ISSUE_TEMPLATE/config.yml"})
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_citation_templates_and_guide_agree_with_the_project() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    own, *_ = PROJECT["license"].split(" AND ")  # the others are licences of packaged libraries
    assert (citation["version"], citation["license"]) == (PROJECT["version"], own)
    assert {"cff-version", "message", "title", "authors"} <= citation.keys()
    for path in FORMS:
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        assert {"name", "description", "body"} <= form.keys(), path
        assert any(part.get("validations", {}).get("required") for part in form["body"]), path
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert all(f"| `{level}` |" in guide for level in get_args(Trust))
