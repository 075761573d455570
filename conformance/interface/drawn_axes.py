"""Axes of the figures of the Python interface."""

from typing import Any


def provide_axes(axes: Any, width: float = 8.0, height: float = 3.0) -> Any:
    """The given axes of matplotlib, or those of a new figure of this size [inch]."""
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]
