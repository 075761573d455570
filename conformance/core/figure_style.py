"""One style for all figures: SVG, letters as text, no dates, the same bytes every time.

matplotlib is imported by the functions that use it: it takes half a second, which a certificate without charts does not
need.
"""

import io
from collections.abc import Callable, Iterable
from functools import cache, wraps
from importlib.resources import as_file
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.drawn_data import DrawnFigure, list_painted_data
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.reproducibility import read_source_date
from pantocheck.conformance.core.texts import TEMPLATES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

_LOOK = read_look()
INK, GREY, PALE = _LOOK["light"]["ink"], _LOOK["figure"]["grey"], _LOOK["figure"]["ground"]
SHADES: tuple[str, ...] = tuple(_LOOK["figure"]["shades"])
BAR_FILLS: tuple[str, ...] = (*_LOOK["figure"]["bars"], "white", "white")
LIMIT_FILL: str = _LOOK["figure"]["limit"]
VERDICT_COLOURS: dict[str, str] = _LOOK["light-verdict"]
CROSS = VERDICT_COLOURS["fail"]
CURVES: tuple[str, ...] = tuple(value for key, value in _LOOK["light"].items() if key.startswith("curve-"))
"""Colours of curves that line style and lightness alone do not tell apart."""

LINES = ("-", "--", "-.", ":")
LIMIT_LINE = (0, (6, 2))
FULL, HALF = 6.9, 3.4
"""Widths of a figure [in]: the text of an A4 page, and half of it."""

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

PlotStyle = dict[str, Any]
"""Keyword arguments of a drawing function of matplotlib."""


def marker_style(symbol: DrawnSymbol) -> PlotStyle:
    """Style of the points of a symbol, without their size."""
    return {
        "marker": symbol.marker,
        "linestyle": "",
        "color": INK,
        "markerfacecolor": INK if symbol.filled else "white",
    }


Arguments = ParamSpec("Arguments")
Content = TypeVar("Content")


@cache
def read_style() -> Any:
    """Settings of matplotlib of the common style."""
    import matplotlib

    with as_file(TEMPLATES / "figure.mplstyle") as path:
        settings = dict(matplotlib.rc_params_from_file(path, use_default_template=True))
    # The backend is the choice of the importing program; `render_svg` names its canvas.
    return {key: value for key, value in settings.items() if not key.startswith("backend")}


def render_svg(paint: "Callable[Arguments, Figure]") -> Callable[Arguments, str]:
    """Turn a function that paints a figure into a function that returns its SVG text in the common style."""

    @wraps(paint)
    def render(*args: Arguments.args, **kwargs: Arguments.kwargs) -> str:
        """Paint the figure in the common style; return its SVG text."""
        import matplotlib
        from matplotlib.backends.backend_svg import FigureCanvasSVG

        read_source_date()  # refuse a wrong date: matplotlib reads it as well and fails without a message
        with matplotlib.rc_context(read_style()):
            buffer = io.StringIO()
            # No metadata: they would hold the date and the version of matplotlib.
            metadata = dict.fromkeys(("Date", "Creator", "Format", "Type"))
            canvas: Any = FigureCanvasSVG(figure := paint(*args, **kwargs))
            canvas.print_svg(buffer, metadata=metadata)
        text = buffer.getvalue()
        return DrawnFigure(text[text.index("<svg") :], list_painted_data(figure))

    return render


def render_pdf_pages(paint: "Callable[[Content], Figure]", contents: Iterable[Content]) -> bytes:
    """Render figures in the common style as the pages of a PDF; equal figures give equal bytes.

    Args:
        paint: Function that paints one page.
        contents: Argument of the function for each page.
    """
    import matplotlib
    from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages

    buffer = io.BytesIO()
    with (
        matplotlib.rc_context(read_style()),
        PdfPages(buffer, metadata=dict.fromkeys(("Creator", "Producer", "CreationDate"))) as pages,
    ):
        for content in contents:
            FigureCanvasPdf(figure := paint(content))
            pages.savefig(figure)
    return buffer.getvalue()


def new_figure(width: float, height: float) -> "Figure":
    """A new figure of matplotlib of a size [in]."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height))


def add_legend(axes: "Axes", columns: int = 5) -> None:
    """A legend above the axes, where it cannot cover the data."""
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=columns, borderaxespad=0.2, columnspacing=1.4)


def use_decades(axes: "Axes") -> None:
    """A logarithmic vertical axis with one tick per decade: ticks between decades take most of the time of a figure."""
    axes.set_yscale("log")
    label_decades(axes.yaxis)
    axes.minorticks_off()


def label_decades(axis: "Axis") -> None:
    """Label the decades of a logarithmic axis with plain letters: the style reads no text as a formula."""
    from matplotlib.ticker import NullFormatter

    axis.set_major_formatter(lambda value, _: format_decade(value))
    axis.set_minor_formatter(NullFormatter())


def format_decade(value: float) -> str:
    """A power of ten as text, such as `10⁻³`; 0 for zero."""
    return "0" if value == 0 else "10" + f"{round(np.log10(value)):d}".translate(SUPERSCRIPTS)


def add_box(axes: "Axes", values: RealArray, place: float) -> None:
    """Quartiles and median of some values as a box at one place of the x axis, whose ticks are kept."""
    axes.boxplot(
        values,
        positions=[place],
        widths=0.5,
        showfliers=False,
        boxprops={"color": INK},
        medianprops={"color": INK, "linewidth": 1.6},
        whiskerprops={"color": GREY},
        capprops={"color": GREY},
        manage_ticks=False,
    )
