"""Figures of panels with given margins: computing a layout would take longer than painting a small figure."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pantocheck.conformance.core.figure_style import new_figure
from pantocheck.conformance.core.panel_figure import Panel, PanelFigure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PanelGrid:
    """Sizes of a grid of panels [in]."""

    width: float
    height: float
    """Width of the figure, and height of one panel."""
    rows: int = 1
    columns: int = 1
    """Number of panels below and beside each other."""
    left: float = 0.6
    right: float = 0.1
    bottom: float = 0.42
    top: float = 0.28
    """Margins around the grid; the legend stands in the upper one."""
    between_rows: float = 0.3
    between_columns: float = 0.55
    """Gaps between the panels."""

    @property
    def total_height(self) -> float:
        """Height of the figure."""
        return self.bottom + self.top + self.rows * self.height + (self.rows - 1) * self.between_rows

    @property
    def panel_width(self) -> float:
        """Width of one panel."""
        gaps = self.left + self.right + (self.columns - 1) * self.between_columns
        return (self.width - gaps) / self.columns


def lay_panels(grid: PanelGrid) -> tuple[PanelFigure, list[list[Panel]]]:
    """Lay a grid of panels on a new figure; the panels, row by row from the upper left."""
    figure = PanelFigure(grid.width, grid.total_height)
    return figure, [
        [figure.add_axes(*_find_place(grid, row, n)) for n in range(grid.columns)] for row in range(grid.rows)
    ]


def add_panels(grid: PanelGrid) -> "tuple[Figure, list[list[Axes]]]":
    """Add a grid of panels to a new figure of matplotlib; the panels, row by row from the upper left."""
    figure = new_figure(grid.width, grid.total_height)
    figure.set_layout_engine("none")
    return figure, [[_add_panel(figure, grid, row, n) for n in range(grid.columns)] for row in range(grid.rows)]


def _find_place(grid: PanelGrid, row: int, column: int) -> tuple[float, float, float, float]:
    """Left and lower edge, width and height of a panel [in]."""
    left = grid.left + column * (grid.panel_width + grid.between_columns)
    bottom = grid.bottom + (grid.rows - 1 - row) * (grid.height + grid.between_rows)
    return left, bottom, grid.panel_width, grid.height


def _add_panel(figure: "Figure", grid: PanelGrid, row: int, column: int) -> "Axes":
    left, bottom, width, height = _find_place(grid, row, column)
    total_width, total_height = grid.width, grid.total_height
    return figure.add_axes((left / total_width, bottom / total_height, width / total_width, height / total_height))


def add_panel(width: float, height: float) -> "tuple[Figure, Axes]":
    """Add one panel of a height to a new figure of a width [in]."""
    figure, panels = add_panels(PanelGrid(width, height))
    return figure, panels[0][0]
