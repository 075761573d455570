"""A figure as a part of an HTML page: its text can be searched, and no style of it reaches the page.

The policy of the page refuses style attributes, and the ids of all figures of a page share one name space. Text of a
figure may come from a file of unknown origin; matplotlib escapes it, and only tags are changed here.
"""

import re
from functools import lru_cache
from html import escape

TAG = re.compile(r"<[^/>][^>]*>")
"""A tag, but not the end of an element: matplotlib escapes `>` in texts and in attributes."""

STYLE_ELEMENT = re.compile(r"<style\b[^>]*>[^<]*</style>")
STYLE_ATTRIBUTE = re.compile(r'\bstyle="([^"]*)"')
SIZE = re.compile(r'\s(?:width|height)="[^"]*"')
IDENTITY = re.compile(r'\sid="([^"]*)"')
REFERENCE = re.compile(r'(?<=href="#)[^"]+|(?<=url\(#)[^)"]+')

DEFAULTS = {"stroke-linejoin": "round", "stroke-linecap": "butt"}
"""Presentation attributes that matplotlib states in a style element."""


def inline_figure(svg: str, alternative: str, prefix: str) -> str:
    """Markup of a figure inside a page.

    Args:
        svg: Figure of this project.
        alternative: Alternative text.
        prefix: Prefix of every id of the figure, not used by another figure of the page.

    Returns:
        An element `svg` with the role of an image, without style attributes; ids that nothing refers to are left out.
    """
    drawing = STYLE_ELEMENT.sub("", svg)
    used = frozenset(REFERENCE.findall(drawing))
    start, end = TAG.match(drawing).span()  # type: ignore[union-attr]  # a figure begins with its tag
    attributes = {"role": "img", "aria-label": escape(alternative), **DEFAULTS}
    root = SIZE.sub("", drawing[start + len("<svg") : end])
    written = "".join(f' {name}="{value}"' for name, value in attributes.items())

    def change_tag(match: re.Match[str]) -> str:
        tag = STYLE_ATTRIBUTE.sub(lambda found: _state_attributes(found[1]), match[0])
        tag = IDENTITY.sub(lambda found: f' id="{prefix}{found[1]}"' if found[1] in used else "", tag)
        return REFERENCE.sub(lambda found: prefix + found[0], tag) if "#" in tag else tag

    return f"<svg{written}{root}{TAG.sub(change_tag, drawing[end:])}"


@lru_cache(maxsize=1000)  # a figure has few styles and many elements
def _state_attributes(style: str) -> str:
    """Presentation attributes instead of a style attribute."""
    pairs = (declaration.split(":", 1) for declaration in style.split(";") if ":" in declaration)
    return " ".join(f'{name.strip()}="{value.strip()}"' for name, value in pairs)
