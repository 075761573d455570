"""Texts and numbers as a page shows them."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from pydantic import BaseModel

from pantocheck.conformance.input_files.shown_text import BIDIRECTIONAL, UNSHOWABLE, is_control
from pantocheck.conformance.quantities.limit_text import ROUNDED_DIGITS, format_graded, format_rounded, format_stated

Content = TypeVar("Content")

LONGEST = 2000
"""Largest number of characters of a text."""


def clean_text(text: str) -> str:
    """Text on one line for any page: without control characters, at most `LONGEST` characters.

    Each format escapes the text; this function only removes characters that no format can hold.
    """
    text = UNSHOWABLE.sub("\N{REPLACEMENT CHARACTER}", BIDIRECTIONAL.sub("", text))
    text = " ".join("".join(" " if is_control(c) else c for c in text).split())
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def clean_tree(value: Content) -> Content:
    """Models, dictionaries and lists with every text, keys included, cleaned by `clean_text`."""
    return change_texts(value, clean_text)


def change_texts(value: Content, change: Callable[[str], str]) -> Content:
    """Models, dictionaries and lists with every text, keys included, changed by a function."""
    changed: Any = value
    if isinstance(value, str):
        changed = change(value)
    elif isinstance(value, BaseModel):
        changed = value.model_copy(update={name: change_texts(part, change) for name, part in value})
    elif isinstance(value, dict):
        changed = {change_texts(key, change): change_texts(item, change) for key, item in value.items()}
    elif isinstance(value, list | tuple):
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
    return "–" if value is None else replace_minus(format_stated(value))


def replace_minus(text: str) -> str:
    """Replace ASCII hyphens by minus signs."""
    return text.replace("-", "−")


def format_beside_limits(value: float | None, lower: float | None, upper: float | None) -> tuple[str, str]:
    """A value and its limits with typographic signs: `28.12` and `26 to 31`, `≤ 225`, `≥ 30`, `= 0` or `none`."""
    texts = format_graded(value, lower, upper)
    bounds = replace_minus(texts.bounds).replace("<=", "≤").replace(">=", "≥")
    return format_value(None) if value is None else replace_minus(texts.value), bounds
