"""Equations of the site: every one becomes MathML, without a script and without a network."""

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip("latex2mathml", reason="the extra docs is not installed")
DOCS = Path(__file__).parents[2] / "docs"
EQUATIONS = re.findall(r"\$\$(.+?)\$\$|(?<!\$)\$([^$]+)\$", (DOCS / "theory.md").read_text("utf-8"), re.DOTALL)


@pytest.fixture
def write_equation(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], str]:
    monkeypatch.syspath_prepend(str(DOCS))
    return import_module("site_pages.equations").write_equation  # type: ignore[no-any-return]


def test_every_equation_of_the_theory_is_written(write_equation: Callable[[str, str], str]) -> None:
    """No command of TeX is left as text, which is the sign of one that the converter does not know."""
    assert len(EQUATIONS) > 80
    for display, inline in EQUATIONS:
        tree = ElementTree.fromstring(write_equation(display or inline, "block" if display else "inline"))
        assert "\\" not in "".join(tree.itertext()), display or inline


def test_primes_stand_beside_their_letter(write_equation: Callable[[str, str], str]) -> None:
    for text, primes in (("w''''", "\u2057"), ("N''^{T}", "\u2033"), ("z_0'", "\u2032")):
        tree = ElementTree.fromstring(write_equation(text, "inline"))
        assert [element.text for element in tree.iter("{http://www.w3.org/1998/Math/MathML}mo")] == [primes]
