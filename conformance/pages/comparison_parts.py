"""Parts of the pages of all comparisons of a model with measured values: kind, criteria, remarks and ranges."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from pydantic import BaseModel

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import (
    clean_tree,
    format_beside_limits,
    format_plain,
    format_value,
    quantity_label,
)
from pantocheck.conformance.results.comparison_format import ComparisonCriterion, ModelComparison

C = TypeVar("C", bound=ModelComparison)
M = TypeVar("M", bound=BaseModel)


@dataclass(frozen=True)
class PageKind(Generic[C]):
    """Texts and blocks of the page of one kind of comparison."""

    heading: str
    statement: str
    headlines: Mapping[str, str]
    scope: str
    """Paragraph on what the comparison states."""
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


def name_criterion(criterion: ComparisonCriterion) -> str:
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


def build_criteria_sections(criteria: tuple[ComparisonCriterion, ...]) -> tuple[doc.Section, ...]:
    """Section with the table of the criteria; none without criteria.

    The columns of the error of the model and of the source are left out if no criterion has them.
    """
    if not criteria:
        return ()
    has_model = any(item.discretisation is not None for item in criteria)
    has_source = any(item.source is not None for item in criteria)
    columns = [doc.Column("Criterion", share=3), doc.Column("Value", number=True), doc.Column("Limit", number=True)]
    columns += [doc.Column("± model", number=True)] if has_model else []
    columns += [doc.Column("± measured", number=True), doc.Column("Verdict")]
    columns += [doc.Column("Source", share=1)] if has_source else []
    columns += [doc.Column("Remark", share=2)]
    rows = []
    for item in criteria:
        row: list[doc.RichText] = [name_criterion(item), *format_beside_limits(item.value, item.lower, item.upper)]
        row += [format_value(item.discretisation, 2)] if has_model else []
        row += ["not stated" if item.measurement is None else format_value(item.measurement, 2)]
        row += [doc.VerdictMark(item.verdict)]
        row += [item.source or "–"] if has_source else []
        rows.append((*row, item.reason or "–"))
    return (doc.Section("Criteria", (doc.Table(tuple(columns), tuple(rows)),)),)
