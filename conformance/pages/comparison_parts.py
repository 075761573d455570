"""Parts of the pages of all comparisons of a model with measured values: kind, criteria, remarks and ranges."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from pydantic import BaseModel

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import (
    clean_tree,
    format_beside_limits,
    format_plain,
    format_value,
    quantity_label,
)
from pantocheck.conformance.results.comparison_format import ModelComparison

C = TypeVar("C", bound=ModelComparison)
M = TypeVar("M", bound=BaseModel)


@dataclass(frozen=True)
class PageKind(Generic[C]):
    """Texts and blocks of the page of one kind of comparison."""

    heading: str
    statement: str
    headlines: Mapping[str, str]
    scope: str
    """Paragraph on the statement of the comparison and its limits."""
    describe: Callable[[C], str]
    """Sources in the header."""
    label: Callable[[C], str]
    """Short name of the subject on every page."""
    opening: Callable[[C], tuple[doc.Block, ...]]
    """Blocks before the criteria."""
    sections: Callable[[C], tuple[doc.Section, ...]]
    """Figures and tables."""
    closing: Callable[[C], tuple[doc.Block, ...]] = lambda comparison: ()
    """Blocks at the end."""


def clean_model(model: M) -> M:
    """Content of a JSON file for a page: numbers as in the file, texts without characters that no page can hold."""
    return type(model).model_validate(clean_tree(model.model_dump(mode="json", by_alias=True)))


def list_remarks(comparison: ModelComparison) -> list[str]:
    """Caveats of a comparison: its warnings, and criteria close to their limit."""
    close = (f"{name_criterion(item)} {text}" for item in comparison.criteria for text in item.close)
    return [*comparison.warnings, *close]


def name_criterion(criterion: Criterion) -> str:
    """Criterion in words: quantity, motion, sensor, window, band, static force, height and unit."""
    where = criterion.where
    parts = [
        quantity_label(criterion.quantity)
        + (f" of the {where.motion}" if where.motion else "")
        + ("" if where.sensor is None else f" at sensor {where.sensor}"),
        None if where.window_s is None else f"{format_range(where.window_s)} s",
        None if where.band_Hz is None else f"{format_range(where.band_Hz)} Hz",
        None if where.static_force_N is None else f"{format_plain(where.static_force_N)} N",
        None if where.height_m is None else f"{format_plain(where.height_m)} m",
    ]
    return ", ".join(filter(None, parts)) + (f" [{criterion.unit}]" if criterion.unit else "")


def format_range(pair: tuple[float, float]) -> str:
    """Range of a window or band, without its unit."""
    return " to ".join(map(format_plain, pair))


def build_criteria_sections(criteria: tuple[Criterion, ...]) -> tuple[doc.Section, ...]:
    """Section with the table of the criteria; none without criteria.

    The columns of the error of the model and of the source are left out if no criterion has them.
    """
    if not criteria:
        return ()
    cells: dict[doc.Column, Callable[[Criterion], doc.RichText]] = {
        doc.Column("Criterion", share=3): name_criterion,
        doc.Column("Value", number=True): lambda item: format_beside_limits(item.value, item.lower, item.upper)[0],
        doc.Column("Limit", number=True): lambda item: format_beside_limits(item.value, item.lower, item.upper)[1],
    }
    if any(item.uncertainty is not None for item in criteria):
        cells[doc.Column("± model", number=True)] = lambda item: format_value(item.uncertainty, 2)
    cells[doc.Column("± measured", number=True)] = _format_measured
    cells[doc.Column("Verdict")] = lambda item: doc.VerdictMark(item.verdict)
    if any(item.source for item in criteria):
        cells[doc.Column("Source", share=1)] = lambda item: item.source or "–"
    cells[doc.Column("Remark", share=2)] = lambda item: item.reason or "–"
    return (doc.Section("Criteria", (doc.make_table(criteria, cells),)),)


def _format_measured(criterion: Criterion) -> str:
    width = criterion.limit_uncertainty
    return "not stated" if width is None else format_value(width, 2)
