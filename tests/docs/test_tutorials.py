"""Tutorials: every block runs in the order of the page, prints the lines of the page, and leaves its pictures."""

from importlib import import_module
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).parents[2] / "docs"
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))


@pytest.fixture
def tutorial_pages(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Module of the site that runs tutorials."""
    monkeypatch.syspath_prepend(str(DOCS))
    monkeypatch.setenv("MPLBACKEND", "agg")
    return import_module("site_pages.tutorial_pages")


@pytest.mark.thorough
@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_tutorial_runs_as_written(tutorial_pages: ModuleType, page: Path, tmp_path: Path) -> None:
    run = tutorial_pages.run_tutorial(page, tmp_path / "clone")
    for name in tutorial_pages.list_pictures(page):
        tutorial_pages.place_picture(run.current, name.removeprefix(f"{page.stem}/"), tmp_path / "pictures")
        assert (tmp_path / "pictures" / name.removeprefix(f"{page.stem}/")).stat().st_size > 5000


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_tutorial_is_complete(tutorial_pages: ModuleType, page: Path) -> None:
    """Needed time, a picture, and a way onwards; every shown output belongs to a block that runs."""
    text = page.read_text(encoding="utf-8")
    assert "**Time:**" in text
    assert "## What next" in text
    assert len(tutorial_pages.list_pictures(page)) >= 1
    blocks = tutorial_pages.read_blocks(page)
    assert blocks[0].language == "sh"
    for before, block in pairwise(blocks):
        assert block.language != "output" or before.runs, block.text
