"""Check of the pages: they are made again from the embedded results, and compared byte by byte.

The pages follow from the results, the versions of the software and the date. Where the versions agree, every difference
is a contradiction. Where they do not, the texts are compared, and the check stays incomplete.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from html import unescape
from html.parser import HTMLParser
from itertools import zip_longest
from typing import assert_never

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import (
    DocumentCheck,
    compare_lines,
    judge_details,
    quote,
    quote_difference,
    shorten_details,
)
from pantocheck.conformance.documents.document_reading import (
    DATA_BLOCK,
    HtmlCertificate,
    PdfCertificate,
    list_version_differences,
)
from pantocheck.conformance.documents.statement_check import check_date
from pantocheck.conformance.grading.results_building import TIME_FORMAT
from pantocheck.conformance.pages.certificate_page import HEADING, build_dated_certificate
from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.translation import translate
from pantocheck.conformance.pages.verdict_marks import mark_results
from pantocheck.conformance.pages.words import name_verdict
from pantocheck.conformance.results.report_files import LANGUAGES, Language

# Parts of an HTML page that could run, fetch or hide something.
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


class _Page(HTMLParser):
    """Tags with their attributes, texts and comments of a page in their order, and its active parts."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tokens: list[tuple[str, str]] = []
        self.texts: list[str] = []
        self.parts: Counter[tuple[str, str]] = Counter()
        self.foreign: list[str] = []
        self.policies: list[str] = []
        self.open = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note elements, events, styles and addresses that can change or load a part of the page."""
        self.open = tag
        self.tokens.append(("tag", " ".join([tag, *(f'{name}="{value}"' for name, value in attrs)])))
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

    def handle_endtag(self, tag: str) -> None:
        self.open = ""
        self.tokens.append(("end of", tag))

    def handle_data(self, data: str) -> None:
        """Keep a text, and the content of a style sheet or script."""
        line = " ".join(data.split())
        if not line:
            return
        self.tokens.append(("text", line))
        if self.open == "style":
            self.parts["a style sheet", data] += 1
        elif self.open != "script":
            self.texts.append(line)
        elif not data.startswith("{"):
            self.parts["a script", data] += 1

    def handle_comment(self, data: str) -> None:
        self.tokens.append(("comment", data))

    def handle_decl(self, decl: str) -> None:
        self.tokens.append(("declaration", decl))


def list_active_parts(stated: str, expected: str) -> Iterator[str]:
    """Active parts of a page that the page of its results does not have, or lacks."""
    parts, others = _Page(stated).parts, _Page(expected).parts
    for (name, text), number in (parts - others).items():
        yield f"the page has {name} that the results do not give{_quote(text)}{_count(number)}"
    for (name, text), number in (others - parts).items():
        yield f"the page lacks {name}{_quote(text)}{_count(number)}"


def list_foreign_elements(stated: str) -> Iterator[str]:
    """Parts of a page that no version of Pantocheck writes; parameter and sentences as in `list_active_parts`."""
    page = _Page(stated)
    yield from (f"the page has {part}" for part in dict.fromkeys(page.foreign))
    if len(page.policies) != 1 or not page.policies[0].startswith(POLICY):
        yield "the page lacks the content security policy that fetches nothing"


def _quote(text: str) -> str:
    short = " ".join(text.split())[:80]
    return f": {short}" if short else ""


def _count(number: int) -> str:
    return f" ({number} times)" if number > 1 else ""


# Comparison of an HTML page with the one that its results give: tags, attributes and texts in their order.
TITLE = re.compile("<title>([^<]*)</title>")

LANGUAGE = re.compile(r'<html lang="([a-z]+)">')
"""Language of an HTML page."""

DATE = re.compile('<meta name="dcterms.created" content="([0-9: -]+UTC)">')


def compare_html(stated: str, expected: str) -> Iterator[str]:
    """Differences of a page from the expected one; at least one.

    Yields:
        The first different tag or text; if there is none, the kind of the difference.
    """
    page, other = _Page(_cut_data(stated)), _Page(_cut_data(expected))
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


# Verdict of the check, for every kind of document.
@dataclass(frozen=True)
class PageDifferences:
    """Differences of a document from the one that its results give."""

    same: bool
    """Whether all bytes are equal."""
    all: tuple[str, ...] = ()
    """Differences of any kind; at least one if the bytes differ."""
    texts: tuple[str, ...] = ()
    """Differences of the texts alone."""
    foreign: tuple[str, ...] = ()
    """Parts that no version of Pantocheck writes."""


def check_pages(document: HtmlCertificate | PdfCertificate) -> DocumentCheck:
    """Check the pages of a document against its results.

    Raises:
        InputError: The date of a PDF cannot be read.
    """
    proved = "Texts, figures and metadata are those that the embedded results give, byte for byte."
    contradicted = "The document is not the one that its embedded results give."
    date = _read_date(document)
    stated = datetime.fromtimestamp(date, UTC).strftime(TIME_FORMAT)
    if late := tuple(check_date(stated, "the document is dated")):
        return DocumentCheck("contradicted", "The document has a date in the future.", late)
    try:
        found = _compare(document, date)
    except (KeyError, IndexError, ValueError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        text = f"no page can be made from the embedded results, which contradict themselves ({type(error).__name__})"
        return DocumentCheck("contradicted", contradicted, (text,))
    if found.same:
        return DocumentCheck("proved", proved)
    if not list_version_differences(document):
        return judge_details(proved, contradicted, shorten_details(found.all))
    if wrong := [*found.foreign, *_find_other_verdict(document)]:
        return judge_details(proved, "The document shows something else than its embedded results.", wrong)
    if found.texts:
        statement = "The texts are not those of the installed version."
    else:
        statement = "All texts are those of the installed version. Figures and layout were not compared."
    return DocumentCheck("incomplete", statement, shorten_details(found.texts))


def _read_date(document: HtmlCertificate | PdfCertificate) -> int:
    """Date of a document [s since 1970]; 0 if there is none."""
    if isinstance(document, HtmlCertificate):
        return read_html_date(document.text)
    from pantocheck.conformance.documents.pdf_check import read_date

    return read_date(document.reader, document.name)


def _compare(document: HtmlCertificate | PdfCertificate, date: int) -> PageDifferences:
    match document:
        case HtmlCertificate(_, text):
            page = render_html(_build_certificate(document, date))
            if text == page:
                return PageDifferences(True)
            return PageDifferences(
                False,
                (*list_active_parts(text, page), *compare_html(text, page)),
                tuple(compare_lines(_Page(_cut_data(text)).texts, _Page(_cut_data(page)).texts)),
                tuple(list_foreign_elements(text)),
            )
        case PdfCertificate():
            return _compare_pdf(document, date)
        case never:
            assert_never(never)


def _compare_pdf(document: PdfCertificate, date: int) -> PageDifferences:
    from pantocheck.conformance.documents.pdf_check import compare_pdfs, list_foreign_parts

    page = render_pdf(_build_certificate(document, date))
    if document.original == page:
        return PageDifferences(True)
    foreign = tuple(list_foreign_parts(document.reader, document.original))
    found, texts = compare_pdfs(document.reader, page)
    return PageDifferences(False, (*foreign, *found), tuple(texts), foreign)


def _build_certificate(document: HtmlCertificate | PdfCertificate, date: int) -> Document:
    """Certificate of the results of a document, in the language that the document states."""
    return replace(build_dated_certificate(document.results, date), language=_read_language(document))


def _read_language(document: HtmlCertificate | PdfCertificate) -> Language:
    """Language that a document states; English if it states none of the suite."""
    match document:
        case HtmlCertificate(_, text):
            found = LANGUAGE.search(text)
            stated = found.group(1) if found else ""
        case PdfCertificate():
            from pantocheck.conformance.documents.pdf_check import read_language

            stated = read_language(document.reader)
        case never:
            assert_never(never)
    return next((language for language in LANGUAGES if language == stated), LANGUAGES[0])


def _find_other_verdict(document: HtmlCertificate | PdfCertificate) -> Iterator[str]:
    """Title and heading of every version name the verdict."""
    language = _read_language(document)
    word = translate(name_verdict(mark_results(document.results)), language).text
    match document:
        case HtmlCertificate(_, text, _):
            title = heading = read_title(text)
        case PdfCertificate():
            from pantocheck.conformance.documents.pdf_check import read_title_and_heading

            title, heading = read_title_and_heading(document.reader, translate(HEADING, language).text)
        case never:
            assert_never(never)
    if not title.startswith(word):
        yield f"the title does not begin with the verdict {word}: {quote(title)}"
    if word not in heading:
        yield f"the first page does not print the verdict {word} in its heading: {quote(heading)}"
