"""A document as one HTML file: complete without its script, nothing fetched, every text escaped."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import count

from jinja2 import Environment, FunctionLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from pantocheck.conformance.input_files.documentation_pages import TEMPLATES
from pantocheck.conformance.reports.document import Document, to_plain
from pantocheck.conformance.reports.formats.embedded_results import BLOCK_ID, encode_data_block
from pantocheck.conformance.reports.formats.inline_figure import inline_figure
from pantocheck.conformance.reports.formats.page_code import read_plain_code, read_results_code
from pantocheck.conformance.reports.formats.reproducibility import format_date
from pantocheck.conformance.reports.unit_spaces import bind_page_units
from pantocheck.conformance.reports.words import read_words


def render_html(document: Document) -> str:
    """HTML text of a document; its results are embedded as a data block."""
    # The encoded results hold no character that HTML interprets.
    block = None if document.results is None else Markup(encode_data_block(document.results))
    code = read_plain_code() if document.results is None else read_results_code()
    page = _build_environment().get_template("page.html")
    return page.render(
        document=bind_page_units(to_plain(replace(document, results=None))),
        styles=tuple(map(Markup, code.styles)),
        scripts=tuple(map(Markup, code.scripts)),
        policy=Markup(code.policy),
        notice=Markup(code.notice),
        results=block,
        date="" if document.results is None else format_date(document.date),
        results_id=BLOCK_ID,
        figure_numbers=count(1),
    )


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
    environment.globals |= {"verdicts": read_words()["verdict"], "trusts": read_words()["trust"]}
    return environment


@pass_context
def _inline(context: Context, figure: Mapping[str, str]) -> Markup:
    """Markup of a figure, with a number of its own on the page."""
    return Markup(inline_figure(figure["svg"], figure["alternative"], f"figure-{next(context['figure_numbers'])}-"))
