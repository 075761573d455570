"""Links of the built site: every internal link, anchor and picture leads somewhere; external links are listed.

    python docs/site_pages/built_links.py SITE     # exit code 1 with the broken links; writes SITE/external-links.txt

No network is used. An external link is checked for its form only.
"""

import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

EXTERNAL = re.compile(r"https?://[\w.-]+\.[a-z]{2,}(:\d+)?(/[^\s<>\"]*)?(\?[^\s]*)?(#\S*)?")
"""Form of an external link: scheme, host with a domain, no blank."""


class PageLinks(HTMLParser):
    """Anchors and targets of a page.

    Args:
        text: The page in HTML.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.targets: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the anchors and the target of an element."""
        values = dict(attrs)
        self.anchors.update(value for key in ("id", "name") if (value := values.get(key)))
        target = values.get("src" if tag in ("img", "script") else "href")
        if target and tag in ("a", "img", "script", "link"):
            self.targets.append(target)


def find_broken_links(site: Path) -> list[str]:
    """Page and target of every link that leads nowhere, and of external links of a wrong form."""
    pages = {path.resolve(): PageLinks(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    return [f"{path.relative_to(site.resolve())}: {target}" for path, target in _list_broken(pages)]


def _list_broken(pages: dict[Path, PageLinks]) -> Iterator[tuple[Path, str]]:
    for path, links in pages.items():
        for target in dict.fromkeys(links.targets):
            if not _is_sound(path, target, pages):
                yield path, target


def _is_sound(path: Path, target: str, pages: dict[Path, PageLinks]) -> bool:
    parts = urlsplit(target)
    if parts.scheme in ("http", "https"):
        return EXTERNAL.fullmatch(target) is not None
    if parts.scheme in ("data", "mailto"):
        return True
    file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if not file.is_file():
        return False
    return not parts.fragment or file not in pages or unquote(parts.fragment) in {"", *pages[file].anchors}


def list_external_links(site: Path) -> list[str]:
    """External links of all pages, each once."""
    pages = (PageLinks(path.read_text(encoding="utf-8")) for path in site.rglob("*.html"))
    return sorted({target for page in pages for target in page.targets if target.startswith(("http://", "https://"))})


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    external = list_external_links(folder)
    (folder / "external-links.txt").write_text("\n".join(external) + "\n", encoding="utf-8")
    broken = find_broken_links(folder)
    print("\n".join(broken) or f"every internal link leads to a file and an anchor; {len(external)} external links")
    sys.exit(1 if broken else 0)
