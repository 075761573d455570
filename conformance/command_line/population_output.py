"""Output of `pantocheck drop identify --each`: population.json, its pages, and lines for the terminal."""

from pathlib import Path

from pantocheck.conformance.command_line.console import format_number
from pantocheck.conformance.identification.population import Population
from pantocheck.conformance.identification.population_analysis import analyse_population
from pantocheck.conformance.identification.population_format import PooledGroup
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.reports.formats.report_writers import write_document
from pantocheck.conformance.reports.mass_drop.population_report import build_population_document


def write_population(population: Population, out: Path) -> tuple[tuple[str, ...], list[Path]]:
    """Write population.json, .html and .pdf to a folder.

    Returns:
        Lines for the terminal.
        Written files.

    Raises:
        InputError: A file cannot be written.
    """
    content = analyse_population(population)
    document = build_population_document(content)
    write_model(out / "population.json", content)
    pages = write_document(document, out / "population")
    warnings = (f"warning: {text}" for text in content.warnings)
    lines = (document.header.headline, *map(_format_group, content.groups), *warnings)
    return lines, [out / "population.json", *pages]


def _format_group(group: PooledGroup) -> str:
    joint = None if group.joint_median is None else 100 * group.joint_median
    return (
        f"group {group.group}: median over tests {format_number(100 * group.median)} % "
        f"({format_number(100 * group.interval[0])}-{format_number(100 * group.interval[1])} %), joint result "
        f"{format_number(joint)} %, outliers: {group.outliers_above} above, {group.outliers_below} below"
    )
