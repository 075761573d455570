"""Pictures of the page on the look: colours, sizes of letters and symbols."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pantocheck.conformance.core.figure_style import FULL, HALF, read_style, render_svg
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.panel_figure import PanelFigure, draw_symbol, write_svg


def write_look_pictures(folder: Path) -> None:
    """Write the pictures of the page on the look."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in (("colours", draw_colours), ("sizes", draw_sizes), ("symbols", draw_symbols)):
        (folder / f"{name}.svg").write_text(draw(), "utf-8")


@render_svg
def draw_colours() -> Any:
    """Colours of both schemes on their papers, with the names of their uses."""
    look = read_look()
    figure, panels = _start_figure(FULL, 2.4, 2)
    for axes, scheme in zip(panels, ("light", "dark"), strict=True):
        colours: Mapping[str, str] = look[scheme] | look[f"{scheme}-verdict"]
        axes.set(xlim=(0, 3), ylim=(-9, 1))
        axes.add_patch(_fill(0, -9, 3, 10, colours["paper"]))
        shown = [name for name in colours if name != "paper"]
        for number, name in enumerate(shown):
            column, row = divmod(number, 8)
            axes.add_patch(_fill(column + 0.05, -row - 0.3, 0.25, 0.6, colours[name]))
            axes.text(column + 0.34, -row, name, color=colours["ink"], va="center", fontsize=7)
    return figure


@render_svg
def draw_sizes() -> Any:
    """Sizes of letters on paper, by their names."""
    sizes: Mapping[str, float] = read_look()["paper-size"]
    figure, [axes] = _start_figure(FULL, 1.9, 1)
    below = 0.0
    for name, size in sizes.items():
        axes.text(0.01, -below, f"{name}, {size:g} pt", fontsize=size, va="top")
        below += size + 5
    axes.set(xlim=(0, 1), ylim=(-below, 0))
    return figure


@write_svg
def draw_symbols() -> PanelFigure:
    """Symbols of mass, spring and damper."""
    figure = PanelFigure(HALF, 1.0)
    axes = figure.add_axes(0.0, 0.0, HALF, 1.0)
    axes.x_scale.limits, axes.y_scale.limits, axes.has_axes = (-0.5, 2.5), (0, 1.05), False
    for number, name in enumerate(read_look()["symbol"]):
        draw_symbol(axes, name, (number, 0.3), 0.3 if name == "mass" else 0.1, 0.7)
        axes.text(number, 0.05, name, 8.0, ha="center")
    return figure


def _fill(x: float, y: float, width: float, height: float, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), width, height, facecolor=colour, edgecolor="none")


def _start_figure(width: float, height: float, columns: int) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    panels = figure.subplots(1, columns, squeeze=False)[0]
    for axes in panels:
        axes.set_axis_off()
    return figure, panels


def use_look(*_: Any) -> None:
    """Let the figures of a gallery example have the look of the reports, with the letters of the site."""
    import matplotlib

    matplotlib.rcParams.update(read_style() | {"font.size": 10, "axes.labelsize": 10, "legend.fontsize": 9})
