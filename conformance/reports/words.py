"""Words of the pages, read from the templates' `words.toml`."""

import tomllib
from functools import cache
from typing import Any

from pantocheck.conformance.input_files.documentation_pages import TEMPLATES
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.criterion_format import Criterion


@cache
def read_words() -> dict[str, Any]:
    """All of `words.toml`."""
    return tomllib.loads((TEMPLATES / "words.toml").read_text("utf-8"))


def quantity_label(quantity: str) -> str:
    """Label of a quantity, or of a value of the procedure; a name that the suite does not know remains.

    A value of the procedure may have conditions behind its name, such as `complex_deviation_pct, 5 to 20 Hz`.
    """
    if quantity in QUANTITIES:
        return QUANTITIES[quantity].label
    name, comma, conditions = quantity.partition(", ")
    return f"{read_words()['label'].get(name, name)}{comma}{conditions}"


def quantity_unit(quantity: str) -> str:
    """Unit of a quantity; empty for a ratio and for a quantity that the suite does not know."""
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else ""


def name_pantograph(key: str | int) -> str:
    """Owner of values by the number of a pantograph: `pantograph 1`, or `line` for 0."""
    return "line" if key in (0, "0") else f"pantograph {key}"


def name_owner(criterion: Criterion) -> str:
    """Owner of the value of a criterion, with its number among several: `pantograph 1`, `line, no. 3`."""
    number = f", no. {criterion.item}" if criterion.item else ""
    return f"{name_pantograph(criterion.pantograph)}{number}"
