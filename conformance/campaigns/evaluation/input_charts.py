"""Charts of values against one input, and maps over two inputs."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.campaigns.evaluation.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.results.campaign_format import ValueMap
from pantocheck.conformance.results.figure_data import Chart, Mark, Series

FEWEST_POINTS = 3
"""Fewest different values of an input that make a curve or a side of a map."""

MOST_CURVES = 8
"""Largest number of curves in a chart; with more, the runs are points."""


def build_input_charts(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str]
) -> Iterator[Chart]:
    """Charts of each quantity against each numeric input of the grid.

    Parameters
    ----------
    columns : CampaignColumns
        Runs with a result.
    values : sequence of EvaluatedValue
        Evaluated values; those of one quantity share a chart.
    grid_keys : sequence of str
        Inputs of the grid. Curves are the mean over all random designs.

    Yields
    ------
    Chart
        Chart with the limits of the quantity.
    """
    for key in _list_curve_keys(columns, grid_keys):
        groups = columns.group([other for other in grid_keys if other != key])
        for quantity in dict.fromkeys(value.quantity for value in values):
            owners = [value for value in values if value.quantity == quantity]
            series = [
                _build_series(columns, key, value, name, numbers, len(owners) * len(groups) > MOST_CURVES)
                for value in owners
                for name, numbers in groups.items()
            ]
            yield Chart(
                caption=f"{owners[0].label} against {key}; bands and bars: 95 % interval, if it is known.",
                alternative=f"Chart of {owners[0].label} against {key}.",
                x_label=key,
                y_label=owners[0].label,
                series=[item for item in series if item.x],
                marks=[mark for value in owners[:1] for mark in mark_limit(value, "y")],
            )


def build_maps(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str]
) -> Iterator[ValueMap]:
    """Maps of each value over each pair of numeric inputs; parameters as in `build_input_charts`."""
    for x_key, y_key in combinations(_list_curve_keys(columns, grid_keys), 2):
        groups = columns.group([other for other in grid_keys if other not in (x_key, y_key)])
        for value in values:
            for name, numbers in groups.items():
                suffix = f" ({name})" if name else ""
                x, y = (np.array(columns.inputs[key], float)[numbers] for key in (x_key, y_key))
                cells = _average_cells(x, y, columns.values[value.column][numbers])
                yield ValueMap(
                    caption=f"{value.title} over {x_key} and {y_key}{suffix}.",
                    alternative=f"Map of {value.title} over {x_key} and {y_key}{suffix}.",
                    x_label=x_key,
                    y_label=y_key,
                    value_label=value.title,
                    x=np.unique(x).tolist(),
                    y=np.unique(y).tolist(),
                    values=[[None if np.isnan(cell) else float(cell) for cell in row] for row in cells],
                    lower=value.lower,
                    upper=value.upper,
                )


def mark_limit(value: EvaluatedValue, axis: str) -> list[Mark]:
    """Lines of a chart at the bounds of a limit."""
    bounds = [bound for bound in (value.lower, value.upper) if bound is not None]
    return [Mark(label="limit", axis="y" if axis == "y" else "x", low=bound) for bound in bounds]


def _list_curve_keys(columns: CampaignColumns, keys: Sequence[str]) -> list[str]:
    return [key for key in keys if columns.is_numeric(key) and len(columns.distinct(key)) >= FEWEST_POINTS]


def _build_series(
    columns: CampaignColumns, key: str, value: EvaluatedValue, name: str, numbers: RealArray, as_points: bool
) -> Series:
    x, y = np.array(columns.inputs[key], float)[numbers], columns.values[value.column][numbers]
    width = columns.widths.get(value.column, np.full(columns.designs.size, np.nan))[numbers]
    known = ~np.isnan(y)
    x, y, width = x[known], y[known], width[known]
    places = np.unique(x)
    is_single = places.size == x.size  # the mean of several runs has no interval of its own
    if not as_points:
        order = [np.flatnonzero(x == place) for place in places]
        x, y, width = places, np.array([y[i].mean() for i in order]), np.array([width[i].mean() for i in order])
    return Series(
        label=", ".join(filter(None, (value.owner, name))) or "runs",
        style="points" if as_points else "line",
        x=x.tolist(),
        y=y.tolist(),
        error=width.tolist() if x.size and (is_single or as_points) and not np.isnan(width).any() else None,
    )


def _average_cells(x: RealArray, y: RealArray, values: RealArray) -> RealArray:
    """Mean value of each cell, (y, x); NaN without a value."""
    x_places, column = np.unique(x, return_inverse=True)
    y_places, row = np.unique(y, return_inverse=True)
    known = ~np.isnan(values)
    sums, counts = np.zeros((2, y_places.size, x_places.size))
    np.add.at(sums, (row[known], column[known]), values[known])
    np.add.at(counts, (row[known], column[known]), 1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
