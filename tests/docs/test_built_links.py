"""Check of the links of the built site, on a small site with one fault of each kind."""

from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).parents[2] / "docs"
SOUND = '<h1 id="top">A</h1><a href="folder/b.html#here">b</a><a href="#top">top</a><img src="a.svg">'


@pytest.fixture
def built_links(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Module of the site that checks links."""
    monkeypatch.syspath_prepend(str(DOCS))
    return import_module("site_pages.built_links")


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Two pages that link to each other."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "a.svg").touch()
    (tmp_path / "a.html").write_text(SOUND)
    (tmp_path / "folder" / "b.html").write_text(
        '<p id="here"><a href="../a.html">a</a><a href="https://semver.org">s</a>'
    )
    return tmp_path


def test_sound_links_are_accepted_and_each_fault_is_found(built_links: ModuleType, site: Path) -> None:
    assert built_links.find_broken_links(site) == []
    assert built_links.list_external_links(site) == ["https://semver.org"]
    for target in ("c.html", "folder/b.html#there", "#nowhere", "https://no domain", "https://host"):
        (site / "a.html").write_text(f'{SOUND}<a href="{target}">x</a>')
        assert built_links.find_broken_links(site) == [f"a.html: {target}"]
    (site / "a.html").write_text(SOUND)
    (site / "a.svg").unlink()
    assert built_links.find_broken_links(site) == ["a.html: a.svg"]
