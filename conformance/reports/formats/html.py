"""The certificate as one HTML file: no script, nothing fetched, every text escaped by the template engine."""

import base64
from pathlib import Path
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.reports.certificate.certificate_page import build_certificate
from pantocheck.conformance.reports.words import TEMPLATES, read_words


def write_certificate_html(results: dict[str, Any], path: Path) -> None:
    """Write `certificate.html`.

    Parameters
    ----------
    results : dict[str, Any]
        results.json as a dictionary.
    path : Path
        The file to write.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_atomically(path, render_html(results).encode("utf-8"))


def render_html(results: dict[str, Any]) -> str:
    """The certificate's HTML text."""
    made = build_environment()
    # The bars are made here from numbers alone, so they may enter the page as markup; nothing else may.
    made.filters["inline_svg"] = Markup
    return made.get_template("certificate.html").render(
        page=build_certificate(results), verdicts=read_words()["verdict"], trusts=read_words()["trust"]
    )


def build_environment() -> Environment:
    """The template engine of every page: it escapes all texts, and knows the stylesheet and pictures as addresses."""
    made = Environment(
        loader=FunctionLoader(lambda name: (TEMPLATES / name).read_text("utf-8")),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    made.filters["data_uri"] = data_uri
    made.globals["stylesheet"] = Markup((TEMPLATES / "certificate.css").read_text("utf-8"))
    return made


def data_uri(svg: str) -> str:
    """A picture as an address that holds it."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode("utf-8")).decode("ascii")
