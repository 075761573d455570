"""Page of any comparison of a model with measured values: verdict, remarks, criteria, figures and tables."""

from typing import Any, TypeVar

from pydantic import BaseModel

from pantocheck.conformance.comparison.drop_comparison_format import DropComparison
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.comparison.comparison_parts import (
    PageKind,
    build_criteria_sections,
    list_remarks,
)
from pantocheck.conformance.reports.comparison.drop_sections import DROP_PAGE
from pantocheck.conformance.reports.comparison.response_sections import RESPONSE_PAGE
from pantocheck.conformance.reports.comparison.static_sections import STATIC_PAGE
from pantocheck.conformance.reports.page_text import clean_tree
from pantocheck.conformance.results.comparison_format import ModelComparison, ResponseComparison, StaticComparison

PAGES: dict[type[ModelComparison], PageKind[Any]] = {
    StaticComparison: STATIC_PAGE,
    ResponseComparison: RESPONSE_PAGE,
    DropComparison: DROP_PAGE,
}
"""Texts and blocks of the page by kind of comparison."""

M = TypeVar("M", bound=BaseModel)


def clean_model(model: M) -> M:
    """Content of a JSON file for a page: numbers as in the file, texts without characters that no page can hold."""
    return type(model).model_validate(clean_tree(model.model_dump(mode="json", by_alias=True)))


def find_headline(comparison: ModelComparison) -> str:
    """Verdict of a comparison in a sentence."""
    return PAGES[type(comparison)].headlines[comparison.verdict]


def build_comparison(comparison: ModelComparison) -> doc.Document:
    """Compose the page of a comparison.

    Args:
        comparison: Content of its JSON file.

    Returns:
        The page.
    """
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
    remarks = tuple(list_remarks(comparison))
    blocks: list[doc.Block] = [doc.WarningBox(remarks)] if remarks else []
    blocks += [doc.Paragraph(kind.scope), *kind.opening(comparison), *build_criteria_sections(comparison.criteria)]
    blocks += [*kind.sections(comparison), *kind.closing(comparison)]
    return doc.Document(header.heading, header, tuple(blocks))
