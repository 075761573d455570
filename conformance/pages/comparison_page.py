"""Page of any comparison of a model with measured values: verdict, remarks, criteria, figures and tables."""

from typing import Any

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import PageKind, build_criteria_sections, clean_model, list_remarks
from pantocheck.conformance.pages.drop_sections import DROP_PAGE
from pantocheck.conformance.pages.pantograph_pages import RESPONSE_PAGE
from pantocheck.conformance.pages.static_sections import STATIC_PAGE
from pantocheck.conformance.results.comparison_format import ModelComparison, ResponseComparison, StaticComparison
from pantocheck.conformance.results.drop_comparison_format import DropComparison

PAGES: dict[type[ModelComparison], PageKind[Any]] = {
    StaticComparison: STATIC_PAGE,
    ResponseComparison: RESPONSE_PAGE,
    DropComparison: DROP_PAGE,
}
"""Texts and blocks of the page by kind of comparison."""


def find_headline(comparison: ModelComparison) -> str:
    """Verdict of a comparison in a sentence."""
    return PAGES[type(comparison)].headlines[comparison.verdict]


def build_comparison(comparison: ModelComparison) -> doc.Document:
    """Compose the page of a comparison."""
    kind, comparison = PAGES[type(comparison)], clean_model(comparison)
    suite = f"Pantocheck {comparison.suite.version}"
    header = doc.VerdictHeader(
        kind.heading,
        comparison.verdict,
        kind.statement,
        kind.headlines[comparison.verdict],
        f"{kind.describe(comparison)} {suite}.",
        f"{suite} · {kind.label(comparison)}",
    )
    blocks: tuple[doc.Block, ...] = (
        *doc.warn(list_remarks(comparison)),
        *(doc.Paragraph(kind.scope), *kind.opening(comparison), *build_criteria_sections(comparison.criteria)),
        *(*kind.sections(comparison), *kind.closing(comparison)),
    )
    return doc.Document(header.heading, header, blocks)
