"""Files and output of every comparison of a model with measured values."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import (
    build_table,
    escape_text,
    format_number,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.app.commands.results_output import EXIT_CODES
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.pages.comparison_page import build_comparison, find_headline
from pantocheck.conformance.pages.comparison_parts import list_remarks, name_criterion
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_document
from pantocheck.conformance.quantities.limit_text import format_graded
from pantocheck.conformance.results.comparison_format import ModelComparison


def write_comparison_files(comparison: ModelComparison, stem: Path) -> list[Path]:
    """Write the JSON file and the pages of a comparison to a path without suffix; returns the written files."""
    data = stem.with_name(f"{stem.name}.json")
    write_model(data, comparison)
    return [data, *write_document(build_comparison(comparison), stem)]


def build_comparison_output(
    comparison: ModelComparison, tables: Iterable[RenderableType], files: list[Path]
) -> CommandOutput:
    """Verdict, tables, criteria and remarks of a comparison; the exit code follows the verdict."""
    return CommandOutput(
        style_verdict(comparison.verdict) + escape_text(f" {find_headline(comparison)}"),
        comparison,
        [
            *tables,
            *_list_criteria(comparison.criteria),
            *(indent_text(remark, "warning: ") for remark in list_remarks(comparison)),
        ],
        files=files,
        remarks=remark_missing_formats(),
        exit_code=EXIT_CODES[comparison.verdict],
    )


def _list_criteria(criteria: tuple[Criterion, ...]) -> Iterator[RenderableType]:
    """Criteria as a table, and their reasons."""
    if criteria:
        table = build_table("criterion", "value", "limit", "verdict", right=("value", "limit"))
        for item in criteria:
            bounds = format_graded(item.value, item.lower, item.upper).bounds
            name = escape_text(name_criterion(item))
            table.add_row(name, format_number(item.value), bounds, style_verdict(item.verdict))
        yield table
    for item in criteria:
        if item.reason:
            yield indent_text(f"{name_criterion(item)}: {item.reason}")
