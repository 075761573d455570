"""Tables of pages from the numbers of the guide, `docs/guide-values.json`."""

import json
from pathlib import Path

from site_pages.markdown_table import build_markdown_table

VALUES = Path(__file__).parents[1] / "guide-values.json"
COMPARISONS = {
    "closed_forms": "closed forms and orders of convergence",
    "formulations": "values inside the limits of the verification",
    "contained": "extrapolated values inside the half-width of the discretisation",
    "published": "values inside their published range",
    "faults_records": "faults of records that are detected",
    "faults_numerical": "numerical faults that are detected",
}


def read_guide_values() -> dict[str, float]:
    """Numbers of the guide by name."""
    values: dict[str, float] = json.loads(VALUES.read_text("utf-8"))["values"]
    return values


def build_guide_counts() -> str:
    """Table with the number of agreeing results of each kind."""
    values = read_guide_values()
    rows = [
        (text, f"{values[f'counts/{name}_agreeing']:g}", f"{values[f'counts/{name}']:g}")
        for name, text in COMPARISONS.items()
    ]
    return build_markdown_table(("comparison", "agreeing", "of"), rows) + "\n"
