"""Links between the pages, and README lines that the continuous integration runs."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [*sorted(ROOT.glob("*.md")), *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("tutorials/*.md"))]
BUILT = ("generated", "gallery")
"""Folders of docs/ whose files are made when the site is built; Sphinx checks the links to them."""


def linked_files(page: Path) -> set[Path]:
    """Local files to which a page links."""
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    return {(page.parent / target).resolve() for target in targets if "://" not in target}


def test_every_link_leads_to_a_file() -> None:
    built = tuple((DOCS / name).resolve() for name in BUILT)
    assert [
        (page.name, target)
        for page in PAGES
        for target in linked_files(page)
        if not target.exists() and not any(target.is_relative_to(folder) for folder in built)
    ] == []


@pytest.mark.parametrize("command", ["pytest", "pantocheck run"])
def test_readme_has_one_line_for_each_job_of_the_continuous_integration(command: str) -> None:
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len([line for line in lines if re.match(rf"python3 -m venv .*{command}", line)]) == 1
