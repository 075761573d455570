"""Axes of the figures of the Python interface."""

from typing import Any


def provide_axes(axes: Any, width: float = 8.0, height: float = 3.0) -> Any:
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
