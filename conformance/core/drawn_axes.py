"""Axes of the figures of the Python interface, in the style of the reports."""

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec

from pantocheck.conformance.core.look import read_look

INK: str = read_look()["light"]["ink"]
GREY: str = read_look()["figure"]["grey"]

Arguments = ParamSpec("Arguments")


def in_report_style(plot: Callable[Arguments, Any]) -> Callable[Arguments, Any]:
    """Let a function draw new figures in the style of the reports; given `axes` keep the style of the user."""

    @wraps(plot)
    def draw(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Any:
        """Draw the figure; return its axes."""
        if kwargs.get("axes") is not None:
            return plot(*args, **kwargs)
        import matplotlib

        from pantocheck.conformance.core.figure_style import read_style

        with matplotlib.rc_context(read_style()):
            return plot(*args, **kwargs)

    return draw


def provide_axes(axes: Any, width: float = 6.9, height: float = 2.6) -> Any:
    """The given axes of matplotlib, or those of a new figure of this size [inch]."""
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def label_logarithms(axes: Any) -> None:
    """Label logarithmic axes at 1, 2 and 5 of each decade with plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
