"""Parts of an HTML page that could run, fetch or hide something, and that Pantocheck did not write into it."""

from collections import Counter
from collections.abc import Iterator
from html.parser import HTMLParser

ACTIVE_ELEMENTS = frozenset(
    ("script", "style", "link", "iframe", "frame", "object", "embed", "base", "form", "applet", "template", "meta")
)
"""Elements that run, fetch, replace or hide content."""

FOREIGN_ELEMENTS = frozenset(("link", "iframe", "frame", "object", "embed", "base", "form", "applet", "template"))
"""Elements that no version of Pantocheck writes."""

POLICY = "default-src 'none'"
"""Beginning of the content security policy of every version: nothing is fetched."""

ADDRESSES = frozenset(("href", "src", "srcset", "action", "formaction", "data", "poster", "background", "xlink:href"))
"""Attributes with an address."""


class _Parts(HTMLParser):
    """Active parts of a page, each as a short text."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.parts: Counter[tuple[str, str]] = Counter()
        self.foreign: list[str] = []
        self.policies: list[str] = []
        self.open = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note elements, events, styles and addresses that can change or load a part of the page."""
        self.open = tag
        if tag in ACTIVE_ELEMENTS:
            text = " ".join(f"{name}={value}" for name, value in attrs)
            self.parts[f"an element <{tag}>", text] += 1
        if tag in FOREIGN_ELEMENTS:
            self.foreign.append(f"an element <{tag}>")
        if tag == "meta" and (dict(attrs).get("http-equiv") or "").lower() == "content-security-policy":
            self.policies.append(dict(attrs).get("content") or "")
        for name, value in attrs:
            if name.startswith("on"):
                self.foreign.append(f"an event handler {name} of <{tag}>")
                self.parts[f"an event handler {name} of <{tag}>", value or ""] += 1
            elif name == "style":
                self.parts[f"a style of <{tag}>", value or ""] += 1
            elif name in ADDRESSES and not (value or "").startswith(("#", "data:image/svg+xml;base64,")):
                self.foreign.append(f"an address outside the page in {name} of <{tag}>")
                self.parts[f"an address in {name} of <{tag}>", value or ""] += 1

    def handle_data(self, data: str) -> None:
        if self.open == "style" and data.strip():
            self.parts["a style sheet", data] += 1
        elif self.open == "script" and data.strip() and not data.startswith("{"):
            self.parts["a script", data] += 1

    def handle_endtag(self, tag: str) -> None:
        self.open = ""


def list_active_parts(stated: str, expected: str) -> Iterator[str]:
    """Active parts of a page that the page of its results does not have, or lacks.

    Args:
        stated: Text of the page.
        expected: Page that the results give.

    Yields:
        One sentence per part.
    """
    parts, others = _Parts(stated).parts, _Parts(expected).parts
    for (name, text), number in (parts - others).items():
        yield f"the page has {name} that the results do not give{_quote(text)}{_count(number)}"
    for (name, text), number in (others - parts).items():
        yield f"the page lacks {name}{_quote(text)}{_count(number)}"


def list_foreign_elements(stated: str) -> Iterator[str]:
    """Parts of a page that no version of Pantocheck writes; parameter and sentences as in `list_active_parts`."""
    page = _Parts(stated)
    yield from (f"the page has {part}" for part in dict.fromkeys(page.foreign))
    if len(page.policies) != 1 or not page.policies[0].startswith(POLICY):
        yield "the page lacks the content security policy that fetches nothing"


def _quote(text: str) -> str:
    short = " ".join(text.split())[:80]
    return f": {short}" if short else ""


def _count(number: int) -> str:
    return f" ({number} times)" if number > 1 else ""
