"""Model order: poles of each order of the search, and poles after each step."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.identification.identification_format import BandOrders, OrderSearch, SearchStep
from pantocheck.conformance.reports.figures.figure_style import FULL, INK, SHADES, render_svg
from pantocheck.conformance.reports.figures.fixed_panels import PanelGrid, add_panels

STEPS_SHARE = 0.28
"""Share of the upper panel, which shows the steps, in the height of both."""

LEGEND_SHARE = 0.1
"""Share of the legend between the panels."""


@render_svg
def draw_order_search(search: OrderSearch) -> Figure:
    """Steps of the search above the stabilisation diagram; `order_search` of a line with bands."""
    grid = PanelGrid(FULL, 2.4, left=1.35, top=0.1)
    figure, panels = add_panels(grid)
    lower = panels[0][0]
    left, bottom, width, height = lower.get_position().bounds
    lower.set_position((left, bottom, width, (1 - LEGEND_SHARE - STEPS_SHARE) * height))
    upper = figure.add_axes((left, bottom + (1 - STEPS_SHARE) * height, width, STEPS_SHARE * height))
    _draw_steps(upper, search.steps)
    _draw_orders(lower, search.bands)
    upper.set_xlim(lower.get_xlim())
    return figure


def _draw_steps(axes: Axes, steps: Sequence[SearchStep]) -> None:
    """One row of ticks per step, from the top."""
    for row, step in enumerate(steps):
        frequency = step.frequency_Hz
        axes.plot(frequency, np.full(len(frequency), -row), "|", color=INK, markersize=7, markeredgewidth=0.8)
    axes.set_yticks([-row for row in range(len(steps))], [f"{step.name}: {len(step.frequency_Hz)}" for step in steps])
    axes.set_ylim(0.6 - len(steps), 0.6)
    axes.tick_params(labelbottom=False, length=0)
    axes.grid(visible=False)


def _draw_orders(axes: Axes, bands: Sequence[BandOrders]) -> None:
    """Poles over frequency and order, and the selected order of each band."""
    order = np.concatenate([np.array(band.order) for band in bands])
    frequency = np.concatenate([np.array(band.frequency_Hz) for band in bands])
    chosen = np.concatenate([np.array(band.stable) for band in bands]).astype(bool)
    axes.plot(frequency[~chosen], order[~chosen], ".", color=SHADES[3], markersize=3, label="unstable pole")
    axes.plot(frequency[chosen], order[chosen], ".", color=INK, markersize=3, label="stable pole")
    axes.hlines(
        [band.selected_order for band in bands],
        [band.from_Hz for band in bands],
        [band.to_Hz for band in bands],
        color=SHADES[2],
        linewidth=4.0,
        zorder=1,
        label="selected order",
    )
    axes.set(xlabel="frequency [Hz]", ylabel="order")
    axes.set_xlim(bands[0].from_Hz, bands[-1].to_Hz)
    axes.set_ylim(0, max(order.max(initial=1), 1) + 1)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, borderaxespad=0.1)
