"""A document as one HTML file: complete without its script, nothing fetched, every text escaped."""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache
from html import escape
from itertools import count

from jinja2 import Environment, FunctionLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from pantocheck.conformance.core.drawn_data import pack_drawn_data
from pantocheck.conformance.core.reproducibility import format_date
from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.document import (
    SCENES_ID,
    Document,
    encode_data_block,
    encode_exploration,
    encode_scenes,
    to_plain,
)
from pantocheck.conformance.pages.figure_files import list_figures
from pantocheck.conformance.pages.page_code import (
    SCENE_SCRIPTS,
    PageCode,
    read_explorer_code,
    read_plain_code,
    read_results_code,
)
from pantocheck.conformance.pages.translation import translate, translate_document, translate_tree
from pantocheck.conformance.pages.words import bind_page_units, read_words
from pantocheck.conformance.results.report_files import BLOCK_ID


def render_html(document: Document) -> str:
    """HTML text of a document; its results or scenes are embedded as a data block."""
    language = document.language
    name, block, code = _choose_code(document)
    page = _build_environment().get_template("page.html")
    words = read_words()
    return page.render(
        document=bind_page_units(
            to_plain(replace(translate_document(document), results=None, scenes=(), exploration=None))
        ),
        translate=lambda text: translate(text, language).text,
        verdicts=translate_tree(words["verdict"], language),
        trusts=translate_tree(words["trust"], language),
        styles=tuple(map(Markup, code.styles)),
        scripts=tuple(map(Markup, code.scripts)),
        policy=Markup(code.policy),
        notice=Markup(code.notice),
        results=block and Markup(block),  # the encoded text holds no character that HTML interprets
        date="" if document.results is None else format_date(document.date),
        results_id=name,
        figure_numbers=count(1),
        figure_points=iter(_pack_points(document)),
    )


def _pack_points(document: Document) -> list[str]:
    """Data behind the figures of a page without results, which has no other file of them; else empty texts."""
    if document.results is None:
        return [pack_drawn_data(figure.svg) for figure in list_figures(document.blocks)]
    return [""] * sum(1 for _ in list_figures(document.blocks))


def _choose_code(document: Document) -> tuple[str, str | None, PageCode]:
    """Identity and content of the data block of a page, and its code."""
    if document.results is not None:
        return BLOCK_ID, encode_data_block(document.results), read_results_code(document.language)
    if document.scenes:
        return SCENES_ID, encode_scenes(document.scenes), read_plain_code(document.language, SCENE_SCRIPTS)
    if document.exploration is not None:
        return SCENES_ID, encode_exploration(document.exploration), read_explorer_code()
    return "", None, read_plain_code(document.language)


@cache
def _build_environment() -> Environment:
    environment = Environment(
        loader=FunctionLoader(lambda name: (TEMPLATES / name).read_text("utf-8")),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    # Figures and drawings are made by this project, with every text escaped, and may enter the page as markup.
    environment.filters |= {"inline_svg": Markup, "inline_figure": _inline}
    return environment


@pass_context
def _inline(context: Context, figure: Mapping[str, str]) -> Markup:
    """Markup of a figure, with a number of its own on the page."""
    prefix, points = f"figure-{next(context['figure_numbers'])}-", next(context["figure_points"])
    return Markup(inline_figure(figure["svg"], figure["alternative"], prefix, points))


# A figure as a part of an HTML page: its text can be searched, and no style of it reaches the page.
#
# The policy of the page refuses style attributes, and the ids of all figures of a page share one name space. Text of a
# figure may come from a file of unknown origin; matplotlib escapes it, and only tags are changed here.
TAG = re.compile(r"<[^/>][^>]*>")
"""A tag, but not the end of an element: matplotlib escapes `>` in texts and in attributes."""

STYLE_ELEMENT = re.compile(r"<style\b[^>]*>[^<]*</style>")
STYLE_ATTRIBUTE = re.compile(r'\bstyle="([^"]*)"')
SIZE = re.compile(r'\s(?:width|height)="[^"]*"')
IDENTITY = re.compile(r'\sid="([^"]*)"')
REFERENCE = re.compile(r'(?<=href="#)[^"]+|(?<=url\(#)[^)"]+')

DEFAULTS = {"stroke-linejoin": "round", "stroke-linecap": "butt"}
"""Presentation attributes that matplotlib states in a style element."""


def inline_figure(svg: str, alternative: str, prefix: str, points: str = "") -> str:
    """Markup of a figure inside a page.

    Args:
        svg: Figure of this project.
        alternative: Alternative text.
        prefix: Prefix of every id of the figure, not used by another figure of the page.
        points: Packed data behind the figure; empty: none.

    Returns:
        An element `svg` with the role of an image, without style attributes; ids that nothing refers to are left out.
    """
    drawing = STYLE_ELEMENT.sub("", svg)
    used = frozenset(REFERENCE.findall(drawing))
    start, end = TAG.match(drawing).span()  # type: ignore[union-attr]  # a figure begins with its tag
    attributes = {"role": "img", "aria-label": escape(alternative), **DEFAULTS}
    if points:
        attributes["data-points"] = points
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
