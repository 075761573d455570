"""Figures that a session of pytest has drawn before: equal arguments give equal SVG, and drawing takes most of a page.

Tests in `PAINTED` paint a figure and write an empty picture in its place.

Loaded before all other helpers, because the functions of the pages are decorated when their modules are imported.
"""

import pickle
from collections.abc import Callable
from functools import wraps
from typing import Any, TextIO

import pytest
from matplotlib.backends.backend_svg import FigureCanvasSVG

from pantocheck.conformance.core import figure_style
from pantocheck.conformance.core.reproducibility import read_source_date

Draw = Callable[..., str]
MEMORY: dict[bytes, str] = {}
decorate = figure_style.render_svg


def remember_figures(paint: Callable[..., Any]) -> Draw:
    """As `render_svg`, but a figure with the arguments of an earlier one is that figure."""
    draw = decorate(paint)

    @wraps(paint)
    def recall(*args: Any, **kwargs: Any) -> str:
        read_source_date()  # a wrong date is refused in any case
        try:
            key = pickle.dumps((paint.__module__, paint.__qualname__, args, kwargs))
        except (pickle.PicklingError, TypeError, AttributeError):
            return draw(*args, **kwargs)
        if key not in MEMORY:
            MEMORY[key] = draw(*args, **kwargs)
        return MEMORY[key]

    return recall


figure_style.render_svg = remember_figures


class Forgetful(dict[bytes, str]):
    """Memory that never holds a figure for a second use."""

    def __contains__(self, key: object) -> bool:
        return False


@pytest.fixture
def fresh_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw every figure anew: for tests of the drawing itself, as of equal bytes."""
    monkeypatch.setitem(globals(), "MEMORY", Forgetful())


PAINTED = {"commands", "comparison", "drops", "network", "notebook"}
"""Folders whose tests read texts, numbers and exit codes; the tests of the pages read the figures."""

EMPTY: dict[bytes, str] = {}


def write_empty(_: object, file: TextIO, **__: object) -> None:
    """Write an empty picture in place of a painted figure."""
    file.write('<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"></svg>')


@pytest.fixture(autouse=True)
def paint_figures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Paint figures without writing them, which takes four fifths of their time; not with `fresh_figures`."""
    if request.path.parent.name in PAINTED and "fresh_figures" not in request.fixturenames:
        monkeypatch.setitem(globals(), "MEMORY", EMPTY)
        monkeypatch.setattr(FigureCanvasSVG, "print_svg", write_empty)
