"""The words of the pages, read from the templates' `words.toml`."""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

from pantocheck.conformance.quantities.registry import QUANTITIES

TEMPLATES = files("pantocheck.templates")


@cache
def read_words() -> dict[str, Any]:
    """All of `words.toml`."""
    return tomllib.loads((TEMPLATES / "words.toml").read_text("utf-8"))


def quantity_label(quantity: str) -> str:
    """What a quantity is called; its own name if it has no other."""
    return QUANTITIES[quantity].label if quantity in QUANTITIES else quantity


def quantity_unit(quantity: str) -> str:
    """Unit of a quantity, empty if it has none or is not known."""
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else ""


def holder(key: str | int | None) -> str:
    """Whose a value is: `pantograph 1`, or `line`."""
    return "line" if key in (None, 0, "0") else f"pantograph {key}"


def owner(row: dict[str, Any]) -> str:
    """Whose value a criterion grades, with its number among several: `pantograph 1`, `line, no. 3`."""
    return holder(row.get("pantograph")) + (f", no. {row['item']}" if row.get("item") else "")
