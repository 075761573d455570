"""Check of the pages: they are made again from the embedded results, and compared byte by byte.

The pages follow from the results, the versions of the software and the date. Where the versions agree, every difference
is a contradiction. Where they do not, the texts are compared, and the check stays incomplete.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import assert_never

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, judge_details, shorten_details
from pantocheck.conformance.documents.document_reading import Certificate, HtmlCertificate, PdfCertificate, ResultsFile
from pantocheck.conformance.documents.html_check import (
    compare_html,
    compare_html_texts,
    list_active_parts,
    list_foreign_elements,
    read_html_date,
    read_title,
)
from pantocheck.conformance.documents.number_comparison import quote
from pantocheck.conformance.documents.version_differences import list_version_differences
from pantocheck.conformance.pages.certificate_page import HEADING, build_dated_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.words import read_words


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


def check_pages(document: Certificate) -> DocumentCheck:
    """Check the pages of a document against its results.

    Args:
        document: Document with its results.

    Raises:
        InputError: The date of a PDF cannot be read.
    """
    proved, contradicted = _statements(document)
    try:
        found = _compare(document)
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
    if isinstance(document, ResultsFile):
        return DocumentCheck("incomplete", "The layout of the file was not compared.")
    if found.texts:
        return DocumentCheck(
            "incomplete", "The texts are not those of the installed version.", shorten_details(found.texts)
        )
    return DocumentCheck(
        "incomplete", "All texts are those of the installed version. Figures and layout were not compared."
    )


def _compare(document: Certificate) -> PageDifferences:
    match document:
        case ResultsFile(_, content, results):
            same = content == results.to_json()
            text = "the file is not as Pantocheck writes it: keys, their order, digits or spaces differ"
            return PageDifferences(same, (text,))
        case HtmlCertificate(_, text, results):
            page = render_html(build_dated_certificate(results, read_html_date(text)))
            if text == page:
                return PageDifferences(True)
            return PageDifferences(
                False,
                (*list_active_parts(text, page), *compare_html(text, page)),
                tuple(compare_html_texts(text, page)),
                tuple(list_foreign_elements(text)),
            )
        case PdfCertificate():
            return _compare_pdf(document)
        case never:
            assert_never(never)


def _compare_pdf(document: PdfCertificate) -> PageDifferences:
    from pantocheck.conformance.documents.pdf_check import compare_pdfs, compare_texts, list_foreign_parts, read_date

    date = read_date(document.reader, document.name)
    page = render_pdf(build_dated_certificate(document.results, date))
    if document.original == page:
        return PageDifferences(True)
    foreign = tuple(list_foreign_parts(document.reader, document.original))
    return PageDifferences(
        False,
        (*foreign, *compare_pdfs(document.reader, page)),
        tuple(compare_texts(document.reader, page)),
        foreign,
    )


def _find_other_verdict(document: Certificate) -> Iterator[str]:
    """Title and heading of every version name the verdict."""
    word = str(read_words()["verdict"][document.results.verdict]["word"])
    match document:
        case ResultsFile():
            return
        case HtmlCertificate(_, text, _):
            title = heading = read_title(text)
        case PdfCertificate():
            from pantocheck.conformance.documents.pdf_check import read_title_and_heading

            title, heading = read_title_and_heading(document.reader, HEADING)
        case never:
            assert_never(never)
    if not title.startswith(word):
        yield f"the title does not begin with the verdict {word}: {quote(title)}"
    if word not in heading.split():
        yield f"the first page does not print the verdict {word} in its heading: {quote(heading)}"


def _statements(document: Certificate) -> tuple[str, str]:
    if isinstance(document, ResultsFile):
        return "The file is as Pantocheck writes it.", "The file is not as Pantocheck writes it."
    return (
        "Texts, figures and metadata are those that the embedded results give, byte for byte.",
        "The document is not the one that its embedded results give.",
    )
