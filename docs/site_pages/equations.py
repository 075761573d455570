"""Equations of the site as MathML, which browsers show without a script and without a network."""

import re
from typing import Any

from latex2mathml.converter import convert

PRIMES = re.compile(r"(\w'+)\^")
"""A letter with primes before a superscript, as in `N''^{T}`: two superscripts, which the converter refuses."""

RAISED = re.compile(r"<(msup|msubsup)>(<mi>\w</mi>)(<m[in]>\w</m[in]>)?<mi>(&#x0(?:2032|2033|2034|2057);)</mi></\1>")
"""Primes as a superscript: fonts without tables for equations raise them twice."""


def write_equation(text: str, display: str) -> str:
    """MathML of an equation in TeX; `display` is `inline` or `block`."""
    return RAISED.sub(_write_primes, convert(PRIMES.sub(r"{\1}^", text), display=display))


def _write_primes(found: re.Match[str]) -> str:
    base = f"<msub>{found[2]}{found[3]}</msub>" if found[3] else found[2]
    return f'<mrow>{base}<mo lspace="0" rspace="0.1em">{found[4]}</mo></mrow>'


def add_equations(app: Any) -> None:
    """Register the writer of equations with Sphinx."""
    app.add_html_math_renderer("mathml", (_write_inline, None), (_write_display, None))


def _write_inline(writer: Any, node: Any) -> None:
    from docutils.nodes import SkipNode

    writer.body.append(write_equation(node.astext(), "inline"))
    raise SkipNode


def _write_display(writer: Any, node: Any) -> None:
    from docutils.nodes import SkipNode

    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    writer.body.append(write_equation(node.astext(), "block"))
    writer.body.append("</div>")
    raise SkipNode
