"""Texts and numbers as a page shows them."""

import re
import tomllib
from collections.abc import Callable
from functools import cache
from typing import Any, TypedDict, TypeVar, cast

from pydantic import BaseModel

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.texts import BIDIRECTIONAL, TEMPLATES, UNSHOWABLE, is_control
from pantocheck.conformance.quantities.limit_text import (
    ROUNDED_DIGITS,
    format_graded,
    format_input_number,
    format_rounded,
)
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.motion_format import CodedField

Content = TypeVar("Content")

TEXTLESS = frozenset((float, int, bool, type(None)))
"""Types of values without a text: a curve is passed on as it is."""

LONGEST = 2000
"""Largest number of characters of a text."""


def clean_text(text: str) -> str:
    """Text on one line for any page: without control characters, at most `LONGEST` characters.

    Each format escapes the text; this function only removes characters that no format can hold.
    """
    if not (text.isascii() and text.isprintable()):  # most texts of results are names and plain sentences
        text = UNSHOWABLE.sub("\N{REPLACEMENT CHARACTER}", BIDIRECTIONAL.sub("", text))
        text = "".join(" " if is_control(c) else c for c in text)
    text = " ".join(text.split())
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def clean_tree(value: Content) -> Content:
    """Models, dictionaries and lists with every text, keys included, cleaned by `clean_text`."""
    return change_texts(value, clean_text)


def change_texts(value: Content, change: Callable[[str], str]) -> Content:
    """Models, dictionaries and lists with every text, keys included, changed by a function; no coded number changes."""
    changed: Any = value
    if isinstance(value, CodedField):
        return value
    if isinstance(value, str):
        changed = change(value)
    elif isinstance(value, BaseModel):
        changed = value.model_copy(update={name: change_texts(part, change) for name, part in value})
    elif isinstance(value, dict):
        changed = {change_texts(key, change): change_texts(item, change) for key, item in value.items()}
    elif isinstance(value, list | tuple) and not TEXTLESS.issuperset(map(type, value)):
        changed = type(value)(change_texts(item, change) for item in value)
    return cast(Content, changed)


def format_value(value: float | None, digits: int = ROUNDED_DIGITS) -> str:
    """A computed number with significant digits, as `119.7`; an en dash for no number."""
    return "–" if value is None else replace_minus(format_rounded(value, digits))


def format_percent(ratio: float | None, digits: int = ROUNDED_DIGITS) -> str:
    """A ratio in percent, without the sign."""
    return format_value(None if ratio is None else 100 * ratio, digits)


def format_plain(value: float | None) -> str:
    """An input number in its shortest form: `20`, `0.001`."""
    return "–" if value is None else replace_minus(format_input_number(value))


def format_signed(value: float) -> str:
    """A difference with its sign and three significant digits."""
    return replace_minus(f"{value:+.3g}")


def replace_minus(text: str) -> str:
    """Replace ASCII hyphens by minus signs."""
    return text.replace("-", "−")


def format_beside_limits(value: float | None, lower: float | None, upper: float | None) -> tuple[str, str]:
    """A value and its limits with typographic signs: `28.12` and `26 to 31`, `≤ 225`, `≥ 30`, `= 0` or `none`."""
    texts = format_graded(value, lower, upper)
    bounds = replace_minus(texts.bounds).replace("<=", "≤").replace(">=", "≥")
    return format_value(None) if value is None else replace_minus(texts.value), bounds


# Space between a number, with or without a mark, and its unit: no line of a page breaks there.
BOUND_UNITS = (
    "N", "kN", "mm", "m", "km", "km/h", "m/s", "s", "ms", "min", "h", "Hz", "kg", "g", "kg/m", "N/m", "mm/N", "N/mm",
    "Ns/m", "Nm", "Nm2", "%", "°C", "K", "rad", "J", "Pa", "MPa", "GPa", "dB", "σ",
)  # fmt: skip
"""Units of the texts of a page."""

NUMBER_AND_UNIT = re.compile(rf"(?<=[\d*]) (?=(?:{'|'.join(map(re.escape, BOUND_UNITS))})(?![\w/]))")

RANGE_DASH = re.compile(r"(?<=\d–)(?=\d)")

UNBOUND_KEYS = frozenset({"kind", "title", "anchor", "address", "svg", "code", "curves", "layout"})
"""Keys of a page whose values are markup, addresses, or lines to be copied."""


def bind_units(text: str) -> str:
    """Text with a no-break space between each number and its unit, and a word joiner behind the dash of each range."""
    return RANGE_DASH.sub("\N{WORD JOINER}", NUMBER_AND_UNIT.sub("\N{NO-BREAK SPACE}", text))


def bind_page_units(page: Any) -> Any:
    """Parts of a page, as `to_plain` gives them, with `bind_units` in every text but names in typewriter letters."""
    if isinstance(page, str):
        return bind_units(page)
    if isinstance(page, list):
        return [bind_page_units(part) for part in page]
    if isinstance(page, dict) and page.get("kind") != "Code":
        return {key: part if key in UNBOUND_KEYS else bind_page_units(part) for key, part in page.items()}
    return page


# Words of the pages, read from the templates' `words.toml`.
class VerdictWords(TypedDict):
    """Word, symbol and meaning of a verdict."""

    word: str
    symbol: str
    meaning: str


class TrustWords(TypedDict):
    """Mark and meaning of a level of trust."""

    mark: str
    meaning: str


class PageWords(TypedDict):
    """Content of `words.toml`, by the names that the results use."""

    verdict: dict[str, VerdictWords]
    trust: dict[str, TrustWords]
    step: dict[str, str]
    procedure: dict[str, str]
    claim: dict[str, str]
    label: dict[str, str]
    state: dict[str, str]


@cache
def read_words() -> PageWords:
    """All words of the pages."""
    return cast(PageWords, tomllib.loads((TEMPLATES / "words.toml").read_text("utf-8")))


def name_verdict(verdict: str) -> str:
    """Word of a verdict: `PASS`."""
    return read_words()["verdict"][verdict]["word"]


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
