"""Pictures of the site: every user page has one with an alternative text, and every shown picture has a builder."""

import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
OTHERS = ("Evidence (appendix)", "Development", "Gallery")
"""Captions of the navigation whose pages are no user pages, or have figures only."""

FIGURE = re.compile(r'!\[(?P<alt>[^\]]*)\]\((?P<path>[^)]+)\)|<iframe src="(?P<page>[^"]+)" title="(?P<title>[^"]*)"')


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> None:
    """Import path of the modules of the site."""
    monkeypatch.syspath_prepend(str(DOCS))
    monkeypatch.setenv("MPLBACKEND", "agg")


def list_figures(page: Path) -> list[tuple[str, str]]:
    """Path and alternative text of each figure of a page, or page and title of each moving passage."""
    found = FIGURE.finditer(page.read_text("utf-8"))
    return [(match["path"] or match["page"], match["alt"] or match["title"] or "") for match in found]


def test_every_user_page_has_a_figure_with_an_alternative_text(site: None) -> None:
    navigation = import_module("site_pages.page_list").read_navigation()
    names = [name for caption, names in navigation.items() if caption not in OTHERS for name in names]
    pages = [DOCS / f"{name}.md" for name in names if not name.startswith("generated/")]
    assert len(pages) > 40
    assert [page.name for page in pages if not list_figures(page)] == []
    figures = [(page.name, alt) for page in (*pages, DOCS / "passages.md") for _, alt in list_figures(page)]
    assert [(name, alt) for name, alt in figures if len(alt) < 12] == []


def test_every_shown_picture_is_made_by_the_build(site: None) -> None:
    pictures, passages = import_module("site_pages.page_pictures"), import_module("site_pages.moving_passages")
    elements = (DOCS / "site_pages" / "element_pictures.py").read_text("utf-8")
    shown = [path for page in DOCS.glob("*.md") for path, _ in list_figures(page)]
    own = {path.removeprefix("generated/pictures/pages/")[:-4] for path in shown if "/pictures/pages/" in path}
    assert own == set(pictures.STEPS) | set(pictures.FIGURES)
    drawn = {name.replace("_", "-") for name in re.findall(r"^def draw_(\w+)", elements, re.MULTILINE)}
    assert {Path(path).stem for path in shown if "/elements/" in path} == drawn
    assert {path for path in shown if path.startswith("passages/")} == {f"passages/{n}.html" for n in passages.PASSAGES}
    tutorials = {page.stem: page.read_text("utf-8") for page in (DOCS / "tutorials").glob("*.md")}
    for path in shown:
        folder, _, name = path.removeprefix("generated/pictures/").partition("/")
        assert folder not in tutorials or f"pictures/{folder}/{name}" in tutorials[folder], path


def test_sketches_and_drawings_are_the_same_every_time(site: None) -> None:
    sketches, elements = import_module("site_pages.sketches"), import_module("site_pages.element_pictures")
    assert sketches.draw_steps("a|b", "c") == sketches.draw_steps("a|b", "c")
    assert "a<b" not in sketches.draw_screen(["$ a<b"])
    assert elements.draw_dropper() == elements.draw_dropper()
