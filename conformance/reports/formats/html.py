"""A document as one HTML file: no script, nothing fetched, every text escaped by the template engine."""

import base64
from dataclasses import replace

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from pantocheck.conformance.reports.document import Document, to_plain
from pantocheck.conformance.reports.formats.embedded_results import BLOCK_ID, encode_data_block
from pantocheck.conformance.reports.words import TEMPLATES, read_words


def render_html(document: Document) -> str:
    """HTML text of a document; its results are embedded as a data block."""
    # The encoded results hold no character that HTML interprets.
    block = None if document.results is None else Markup(encode_data_block(document.results))
    page = _build_environment().get_template("page.html")
    return page.render(document=to_plain(replace(document, results=None)), results=block, results_id=BLOCK_ID)


def _build_environment() -> Environment:
    environment = Environment(
        loader=FunctionLoader(lambda name: (TEMPLATES / name).read_text("utf-8")),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    # Drawings are made by this project from numbers alone and may enter the page as markup; nothing else may.
    environment.filters |= {"inline_svg": Markup, "data_uri": _encode_svg}
    environment.globals |= {
        "stylesheet": Markup((TEMPLATES / "page.css").read_text("utf-8")),
        "verdicts": read_words()["verdict"],
        "trusts": read_words()["trust"],
    }
    return environment


def _encode_svg(svg: str) -> str:
    """Address of an image that holds the image itself."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode("utf-8")).decode("ascii")
