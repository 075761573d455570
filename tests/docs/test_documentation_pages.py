"""Pages that the program names: they exist under their titles, and no text for a user names a file of the clone."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.core.texts import DocumentationPage

ROOT = Path(__file__).parents[2]
TITLES = {path.stem: path.read_text().partition("\n")[0][2:].partition(":")[0] for path in (ROOT / "docs").glob("*.md")}
TEMPLATES = sorted((ROOT / "templates").glob("new-*.toml"))
FILE = re.compile(r"docs/[a-z-]+\.md")


def test_pages_and_drafts_have_the_titles_of_their_files() -> None:
    for page in DocumentationPage:
        assert TITLES[page.name.lower().replace("_", "-")] == page.value
        assert f"See {page}." == f"See the page '{page.value}' of the documentation."
    named = re.findall(r"the page\s+(?:# )?'([^']+)'", "".join(path.read_text() for path in TEMPLATES))
    assert len(named) >= 8
    assert set(named) <= set(TITLES.values())


def test_no_text_for_a_user_names_a_file_of_the_clone() -> None:
    found = {path.name: text for path in sorted((ROOT / "conformance").rglob("*.py")) for text in _list_texts(path)}
    found |= {path.name: path.read_text() for path in TEMPLATES}
    assert [name for name, text in found.items() if FILE.search(text)] == []


def _list_texts(path: Path) -> Iterator[str]:
    """Texts with the name of such a file, outside of docstrings."""
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source if FILE.search(source) else "")
    described = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        text = node.value if isinstance(node, ast.Constant) and id(node) not in described else None
        if isinstance(text, str) and FILE.search(text):
            yield text
