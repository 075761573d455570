"""Converged values of every case: both formulations and the interval that the verification uses."""

import tomllib
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.library_folder import library_folder
from site_pages.markdown_table import build_markdown_table

INTRODUCTION = """\
# Converged values

Values of the extrapolated reference simulator and of the [second formulation](../second-formulation.md) for each case.

The half-width contains both results and the discretisation of the reference simulator
([verification](../verification.md)). The difference is that of the second formulation; for extremes it is relative to
their distance from the mean contact force.
"""
HEADINGS = ("pantograph", "quantity", "converged", "half-width", "second formulation", "difference [%]")


def build_converged_page() -> str:
    """Page with a table of each case, from the stored files."""
    return "\n".join([INTRODUCTION, *(_describe_case(path) for path in sorted(_folder().rglob("*.toml")))])


def _folder() -> Path:
    return library_folder() / "converged"


def _describe_case(path: Path) -> str:
    case = tomllib.loads(path.read_text(encoding="utf-8"))
    parts = [f"## {case['case']}"]
    if "uplift_force_N" in case:
        parts.append(f"Uplift force {', '.join(f'{force:.3f}' for force in case['uplift_force_N'])} N.")
    parts.append(build_markdown_table(HEADINGS, map(_describe_value, case["value"])))
    if omitted := case.get("omitted"):
        names = ", ".join(f"`{entry['quantity']}` ({_owner(entry)})" for entry in omitted)
        parts.append(f"Not stored, because the two formulations differ by more than 1 %: {names}.")
    return "\n\n".join(parts) + "\n"


def _describe_value(entry: dict[str, Any]) -> tuple[str, ...]:
    numbers = (entry["value"], entry["half_width"], entry["second_value"])
    difference = f"{entry['difference_pct']:+.2f}"
    return _owner(entry), f"`{entry['quantity']}`", *(f"{number:g}" for number in numbers), difference


def _owner(entry: dict[str, Any]) -> str:
    return str(entry.get("pantograph", "line"))
