"""Converged values of the library, from their files: both formulations and their difference."""

from pantocheck.conformance.cases.converged_file import FOLDER, ConvergedFile, ConvergedValue
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from site_pages.markdown_table import build_markdown_table, escape_text

HEADINGS = ("pantograph", "quantity", "converged", "half-width", "order", "second formulation", "difference [%]")


def build_converged_page() -> str:
    """Page with a table for every case."""
    parts = [
        "# Converged values",
        "Extrapolated values of the reference simulator and of the [second formulation](../second-formulation.md), "
        "which shares no code with it. Forces in N, uplift in mm, elasticity in mm/N. The difference of an extreme is "
        "relative to its distance from the mean contact force.",
    ]
    folder = library_folder() / FOLDER
    for path in sorted(folder.rglob("*.toml")):
        parts += _build_case(read_model(path, ConvergedFile, "converged values"))
    return "\n\n".join(parts) + "\n"


def _build_case(file: ConvergedFile) -> list[str]:
    forces = ", ".join(f"{force:.3f}" for force in file.uplift_force_N)
    rows = [_describe(value) for value in file.value]
    rows += [
        (_name_owner(item.owner), f"`{item.quantity}`", escape_text(item.reason), *[""] * 4) for item in file.omitted
    ]
    facts = [f"Uplift force {forces} N."] if forces else []
    return [f"## {file.case}", *facts, build_markdown_table(HEADINGS, rows)]


def _name_owner(owner: int) -> str:
    return str(owner) if owner else "line"


def _describe(value: ConvergedValue) -> tuple[str, ...]:
    order = "-" if value.order is None else f"{value.order:.1f}"
    numbers = (f"{value.value:.6g}", f"{value.half_width:.2g}", order, f"{value.second_value:.6g}")
    return _name_owner(value.owner), f"`{value.quantity}`", *numbers, f"{value.difference_pct:+.2f}"
