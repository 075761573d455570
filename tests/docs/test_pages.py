"""Pages in the repository: links lead to files, tables are whole, and the README has its two lines."""

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [*sorted(ROOT.glob("*.md")), *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("tutorials/*.md"))]
BUILT = tuple((DOCS / name).resolve() for name in ("generated", "gallery"))
"""Folders of docs/ whose files are made when the site is built; Sphinx checks the links to them."""


def list_broken_links(page: Path, text: str) -> list[str]:
    """Links of a page to local files that do not exist."""
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
    files = {target: (page.parent / target).resolve() for target in targets if "://" not in target}
    built = {target for target, file in files.items() if any(file.is_relative_to(folder) for folder in BUILT)}
    return [target for target, file in files.items() if target not in built and not file.exists()]


def list_loose_rows(text: str) -> Iterator[str]:
    """First rows of tables without head and rule, which are shown as raw text."""
    lines = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE).splitlines()
    for before, line, after in zip(["", *lines], lines, [*lines[1:], ""], strict=False):
        if line.startswith("|") and not before.startswith("|") and not re.match(r"\|[\s:]*-", after):
            yield line


def test_links_and_tables_of_every_page() -> None:
    wrong = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        wrong += [f"{page.name}: link to {target}" for target in list_broken_links(page, text)]
        wrong += [f"{page.name}: row {row}" for row in list_loose_rows(text)] if DOCS in page.parents else []
    assert wrong == []
    assert list_broken_links(DOCS / "index.md", "[a](nowhere.md) [b](index.md) [c](generated/x.md)") == ["nowhere.md"]
    assert list(list_loose_rows("| a | b |\n\n| a |\n|---|\n| 1 |\n")) == ["| a | b |"]


def test_readme_has_one_line_for_each_job_of_the_continuous_integration() -> None:
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    for command in ("pytest", "pantocheck run"):
        assert len([line for line in lines if re.match(rf"python3 -m venv .*{command}", line)]) == 1, command
