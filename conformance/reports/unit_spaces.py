"""Space between a number, with or without a mark, and its unit: no line of a page breaks there."""

import re
from typing import Any

BOUND_UNITS = (
    "N", "kN", "mm", "m", "km", "km/h", "m/s", "s", "ms", "min", "h", "Hz", "kg", "g", "kg/m", "N/m", "mm/N", "N/mm",
    "Ns/m", "Nm", "Nm2", "%", "°C", "K", "rad", "J", "Pa", "MPa", "GPa", "dB", "σ",
)  # fmt: skip
"""Units of the texts of a page."""

NUMBER_AND_UNIT = re.compile(rf"(?<=[\d*]) (?=(?:{'|'.join(map(re.escape, BOUND_UNITS))})(?![\w/]))")

UNBOUND_KEYS = frozenset({"kind", "title", "anchor", "address", "svg", "code", "curves", "layout"})
"""Keys of a page whose values are markup, addresses, or lines to be copied."""


def bind_units(text: str) -> str:
    """Text with a no-break space between each number and its unit.

    Args:
        text: Text of a page.
    """
    return NUMBER_AND_UNIT.sub("\N{NO-BREAK SPACE}", text)


def bind_page_units(page: Any) -> Any:
    """Parts of a page, as `to_plain` gives them, with `bind_units` in every text but names in typewriter letters.

    Args:
        page: Part of a page.
    """
    if isinstance(page, str):
        return bind_units(page)
    if isinstance(page, list):
        return [bind_page_units(part) for part in page]
    if isinstance(page, dict) and page.get("kind") != "Code":
        return {key: part if key in UNBOUND_KEYS else bind_page_units(part) for key, part in page.items()}
    return page
