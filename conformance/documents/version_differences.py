"""Versions of the software that wrote a document, against those that are installed.

Only the same versions lay out the same pages. Their differences are named, because then the bytes of pages cannot be
compared.
"""

from collections.abc import Collection
from typing import assert_never

from pantocheck.conformance.documents.document_reading import Certificate, HtmlCertificate, PdfCertificate, ResultsFile
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.results.renderer_identity import identify_renderer
from pantocheck.conformance.results.results_format import Renderer, Results


def list_suite_differences(results: Results) -> list[str]:
    """Differences of the suite that graded the system from the installed suite; none if their digests agree."""
    stated, installed = results.suite, build_suite()
    if stated.digest == installed.digest:
        return []  # `find_false_version` compares the versions
    if stated.version != installed.version:
        return [f"Pantocheck {stated.version}; installed is {installed.version}"]
    return [f"Pantocheck {stated.version} with the digest {stated.digest[:19]}; installed is {installed.digest[:19]}"]


def find_false_version(results: Results) -> list[str]:
    """Contradiction of a stated version with the digest of the installed files; none if the digests differ."""
    stated, installed = results.suite, build_suite()
    if stated.digest != installed.digest or stated.version == installed.version:
        return []
    return [f"Pantocheck {stated.version} stated; the stated digest is that of Pantocheck {installed.version}"]


def list_version_differences(document: Certificate) -> list[str]:
    """All differences of the software that made a document from the installed one, as sentences."""
    return [*list_suite_differences(document.results), *_list_renderer_differences(document.results, _layout(document))]


def _layout(document: Certificate) -> frozenset[str]:
    """Fields of `Renderer` on which a document depends: Typst lays out no HTML page, and nothing a results.json."""
    match document:
        case ResultsFile():
            return frozenset()
        case HtmlCertificate():
            return frozenset(Renderer.model_fields) - {"typst"}
        case PdfCertificate():
            return frozenset(Renderer.model_fields)
        case never:
            assert_never(never)


def _list_renderer_differences(results: Results, software: Collection[str]) -> list[str]:
    """Differences of the software that made the pages from the installed one."""
    stated, installed = results.renderer, identify_renderer()
    return [
        f"{name} {getattr(stated, name)}; installed is {getattr(installed, name)}"
        for name in Renderer.model_fields
        if name in software and getattr(stated, name) != getattr(installed, name)
    ]
