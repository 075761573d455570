"""The words of the pages, read from the templates' `words.toml`."""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

TEMPLATES = files("pantocheck.templates")


@cache
def words() -> dict[str, Any]:
    """All of `words.toml`."""
    return tomllib.loads((TEMPLATES / "words.toml").read_text("utf-8"))


def label(quantity: str) -> str:
    """What a quantity is called; its own name if it has no other."""
    return str(words()["quantity"].get(quantity, {}).get("label", quantity))


def unit(quantity: str) -> str:
    """Unit of a quantity, empty if it has none or is not known."""
    return str(words()["quantity"].get(quantity, {}).get("unit", ""))


def pantograph(number: int | str | None) -> str:
    """Who a value belongs to: the number of a pantograph, or the line."""
    return "line" if number in (None, 0, "0") else str(number)
