"""Figures of panels with given margins: computing a layout would take longer than painting a small figure."""

from dataclasses import dataclass

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


def add_panels(grid: PanelGrid) -> tuple[Figure, list[list[Axes]]]:
    """Add a grid of panels to a new figure.

    Returns:
        The panels, row by row from the upper left.
    """
    figure = Figure(figsize=(grid.width, grid.total_height))
    figure.set_layout_engine("none")
    return figure, [[_add_panel(figure, grid, row, n) for n in range(grid.columns)] for row in range(grid.rows)]


def _add_panel(figure: Figure, grid: PanelGrid, row: int, column: int) -> Axes:
    left = grid.left + column * (grid.panel_width + grid.between_columns)
    bottom = grid.bottom + (grid.rows - 1 - row) * (grid.height + grid.between_rows)
    width, height = grid.width, grid.total_height
    return figure.add_axes((left / width, bottom / height, grid.panel_width / width, grid.height / height))


def add_panel(width: float, height: float) -> tuple[Figure, Axes]:
    """Add one panel of a height to a new figure of a width [in]."""
    figure, panels = add_panels(PanelGrid(width, height))
    return figure, panels[0][0]
