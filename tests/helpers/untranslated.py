"""Certificates and summaries in a language, and texts of them that the catalogue of a language lacks."""

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pantocheck.conformance.pages import translation
from pantocheck.conformance.pages.certificate_page import build_certificate, build_summary
from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.results.report_files import Language
from pantocheck.conformance.results.results_format import Results

DATA_KEYS = frozenset(
    (
        *("id", "title", "name", "version", "kind", "notes", "source", "edition", "superseded_by", "origin", "text"),
        *("sentence", "printed", "tolerance", "sensitivity", "statement", "started", "schema", "digest", "values"),
        *("system", "label", "note", "line", "pantographs"),
    )
)
"""Keys of results whose texts belong to a case, a user or a record, and stay as they are."""

VERSIONS = re.compile(r"Pantocheck ([\d.]+|reference simulator)|python [\d.]+|\d+-\d+-\d+ [\d:]+ UTC")


def build_pages(results: dict[str, Any], language: Language) -> tuple[Document, Document]:
    """Certificate and summary of results in a language."""
    read = Results.model_validate(results)
    certificate, summary = build_certificate(read), build_summary(read, ["certificate.html"])
    return replace(certificate, language=language), replace(summary, language=language)


def find_untranslated(results: dict[str, Any]) -> list[str]:
    """Texts of certificate and summary that stay English and are no data of a case, a user or a record."""
    data = "\n".join(_list_data(results))
    missing: set[str] = set()

    def collect(text: str) -> str:
        missing.update(translation.translate(text, "de").missing, list_kept_words(text, "de"))
        return text

    for page in build_pages(results, "de"):
        translation._change_parts(page, collect)
    return [text for text in sorted(missing) if text not in data and not VERSIONS.search(text)]


def list_kept_words(text: str, language: Language) -> list[str]:
    """Five words in a row that a translation leaves as they are: an argument has swallowed a text without an entry."""
    words = [word for word in text.split() if "et al." not in text]
    runs = (words[n : n + 5] for n in range(len(words) - 4))
    plain = (" ".join(run) for run in runs if all(re.fullmatch(r"[^\W\d_]+", word) for word in run))
    translated = translation.translate(text, language).text
    return [run for run in plain if run in translated]


def _list_data(value: Any, key: str = "") -> Iterator[str]:
    """Texts of results that belong to a case, a user or a record."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _list_data(part, name if key not in DATA_KEYS else key)
            yield name
    elif isinstance(value, list):
        for part in value:
            yield from _list_data(part, key)
    elif isinstance(value, str) and key in DATA_KEYS:
        yield value
