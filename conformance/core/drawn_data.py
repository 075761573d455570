"""Data behind a figure: the curves that it shows, beside its SVG text."""

import csv
import io
import zlib
from base64 import b64encode
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from pantocheck.conformance.core.array_types import RealArray


@dataclass(frozen=True)
class DrawnData:
    """Curve, bars or corners of an area in a panel of a figure."""

    panel: str
    """Quantities of the axes: `contact force [N] over position along the track [m]`; empty: the panel has none."""
    label: str
    """Name in the legend; empty: none."""
    x: RealArray
    y: RealArray
    """Points; infinite: the edge of the panel, NaN: a gap."""


class DrawnFigure(str):
    """SVG text of a figure that knows the data behind it."""

    data: tuple[DrawnData, ...]

    def __new__(cls, text: str, data: Iterable[DrawnData]) -> Self:
        """Text with its data."""
        figure = super().__new__(cls, text)
        figure.data = tuple(data)
        return figure

    def __getnewargs__(self) -> tuple[str, tuple[DrawnData, ...]]:  # type: ignore[override]
        """Arguments of a copy in another process."""
        return str(self), self.data


def name_panel(x: str, y: str) -> str:
    """Name of a panel by those of its axes."""
    return f"{y} over {x}" if x and y else x or y


def list_painted_data(figure: Any) -> list[DrawnData]:
    """Lines, bars and segments of a figure of matplotlib; the values of images and maps are left out."""
    found = []
    for axes in figure.axes:
        panel = name_panel(axes.get_xlabel(), axes.get_ylabel().replace("\n", " "))
        for line in axes.lines:
            x, y = (np.ma.filled(np.ma.asarray(part, np.float64), np.nan) for part in line.get_data())
            found.append(DrawnData(panel, _clean_label(line), x, y))
        for container in axes.containers:
            if bars := [bar for bar in container if hasattr(bar, "get_height")]:
                x = np.array([bar.get_x() + bar.get_width() / 2 for bar in bars])
                found.append(DrawnData(panel, _clean_label(container), x, np.array([bar.get_height() for bar in bars])))
        for collection in axes.collections:
            segments: list[RealArray] = getattr(collection, "get_segments", list)()
            if segments:
                gap = np.full((1, 2), np.nan)
                points = np.vstack([np.vstack((segment, gap)) for segment in segments])
                found.append(DrawnData(panel, _clean_label(collection), points[:, 0], points[:, 1]))
    return found


def _clean_label(artist: Any) -> str:
    """Name of a curve in the legend; matplotlib begins those of unnamed ones with an underscore."""
    label = str(artist.get_label() or "")
    return "" if label.startswith("_") else label


def render_drawn_data(data: Iterable[DrawnData]) -> str:
    """Comma-separated values with a row for each point; a gap and the edge of a panel have empty cells.

    An unnamed curve is named by its number.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("panel", "curve", "x", "y"))
    for number, part in enumerate(data, 1):
        label = part.label or f"curve {number}"
        cells = ([f"{value:.9g}" if np.isfinite(value) else "" for value in axis.tolist()] for axis in (part.x, part.y))
        writer.writerows((part.panel, label, x, y) for x, y in zip(*cells, strict=True))
    return text.getvalue()


def pack_drawn_data(figure: str) -> str:
    """Data behind a figure, compressed by zlib, as base64 text; empty without data."""
    if not isinstance(figure, DrawnFigure) or not figure.data:
        return ""
    return b64encode(zlib.compress(render_drawn_data(figure.data).encode(), 9)).decode()
