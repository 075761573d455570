"""Comparison of an HTML page with the one that its results give: tags, attributes and texts in their order."""

import re
from collections.abc import Iterator
from datetime import UTC, datetime
from html import unescape
from html.parser import HTMLParser
from itertools import zip_longest

from pantocheck.conformance.authenticity.html_certificate import DATA_BLOCK
from pantocheck.conformance.authenticity.text_differences import compare_lines, quote_difference

TITLE = re.compile("<title>([^<]*)</title>")

DATE = re.compile('<meta name="dcterms.created" content="([0-9: -]+UTC)">')

WITHOUT_TEXT = frozenset(("style", "script"))
"""Elements whose content is no text of the page."""


class _Tokens(HTMLParser):
    """Tags with their attributes, texts and comments of a page, in their order."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tokens: list[tuple[str, str]] = []
        self.texts: list[str] = []
        self.open = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open = tag
        self.tokens.append(("tag", " ".join([tag, *(f'{name}="{value}"' for name, value in attrs)])))

    def handle_endtag(self, tag: str) -> None:
        self.open = ""
        self.tokens.append(("end of", tag))

    def handle_data(self, data: str) -> None:
        if line := " ".join(data.split()):
            self.tokens.append(("text", line))
            if self.open not in WITHOUT_TEXT:
                self.texts.append(line)

    def handle_comment(self, data: str) -> None:
        self.tokens.append(("comment", data))

    def handle_decl(self, decl: str) -> None:
        self.tokens.append(("declaration", decl))


def compare_html(stated: str, expected: str) -> Iterator[str]:
    """Differences of a page from the expected one; at least one.

    Args:
        stated: Page, whose text differs.
        expected: Page that the results give.

    Yields:
        The first different tag or text; if there is none, the kind of the difference.
    """
    page, other = _Tokens(_cut_data(stated)), _Tokens(_cut_data(expected))
    for token, wanted in zip_longest(page.tokens, other.tokens):
        if token != wanted:
            texts = (None if pair is None else f"{pair[0]} {pair[1]}" for pair in (token, wanted))
            found, follows = quote_difference(*texts)
            yield f"{found} stands where {follows} follows from the results"
            return
    if _blocks(stated) != _blocks(expected):
        yield "the embedded results are not as Pantocheck writes them: keys, their order, digits or spaces differ"
    else:
        yield "spaces, line breaks or the spelling of tags differ; texts and tags agree"


def compare_html_texts(stated: str, expected: str) -> Iterator[str]:
    """First difference of the texts of two pages; parameters as in `compare_html`."""
    yield from compare_lines(_Tokens(_cut_data(stated)).texts, _Tokens(_cut_data(expected)).texts)


def read_html_date(page: str) -> int:
    """Date in the metadata of a page [s since 1970]; 0 if there is none."""
    found = DATE.search(page)
    if found is None:
        return 0
    try:
        return int(datetime.strptime(found.group(1), "%Y-%m-%d %H:%M:%S UTC").replace(tzinfo=UTC).timestamp())
    except ValueError:
        return 0


def read_title(page: str) -> str:
    """Title of a page; empty if there is none."""
    found = TITLE.search(page)
    return unescape(found.group(1)).strip() if found else ""


def _cut_data(page: str) -> str:
    return DATA_BLOCK.sub("", page)


def _blocks(page: str) -> list[str]:
    return DATA_BLOCK.findall(page)
