"""Charts of values against one input, and maps over two inputs."""

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Literal

import numpy as np

from pantocheck.conformance.campaigns.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.results.campaign_format import ValueMap

FEWEST_POINTS = 3
"""Fewest different values of an input that make a curve or a side of a map."""

MOST_CURVES = 8
"""Largest number of curves in a chart; with more, the runs of all other inputs form one curve with its range."""

MOST_PLACES = 500
"""Largest number of points of a curve; more values of an input are put together in intervals of equal length."""

MOST_MAPS_OF_A_VALUE = 4
"""Largest number of maps of one value over one pair of inputs; with more, one map has the mean over all others."""

MOST_MAPS = 36
"""Largest number of maps of a report: those of all pairs of three inputs and twelve values."""

MOST_CELLS = 40
"""Largest number of cells along a side of a map; more values of an input are put together."""

RANGE = (0.05, 0.95)
"""Quantiles at the ends of the range of the runs at one value of an input."""

RANGE_NOTE = "; shaded: 5 to 95 % of the runs at one value"
INTERVAL_NOTE = "; shaded: 95 % interval of each run"


def build_input_charts(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str]
) -> Iterator[Chart]:
    """Charts of each quantity against each numeric input of the grid, with limits; values of a quantity share a chart.

    Several runs at one value of the input give their mean and their range.
    """
    for key in _list_curve_keys(columns, grid_keys):
        for quantity in dict.fromkeys(value.quantity for value in values):
            owners = [value for value in values if value.quantity == quantity]
            groups = _group_others(columns, grid_keys, (key,), MOST_CURVES // len(owners))
            series = [
                item
                for value in owners
                for name, places in groups.items()
                for item in _build_curve(columns, key, value, name, places)
            ]
            yield Chart(
                caption=f"{owners[0].label} against {key}{_explain_shade(series)}.",
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
        groups = _group_others(columns, grid_keys, (x_key, y_key), MOST_MAPS_OF_A_VALUE)
        x, y = (_merge_places(np.array(columns.inputs[key], float), MOST_CELLS) for key in (x_key, y_key))
        for value in values:
            for name, places in groups.items():
                suffix = f" ({name})" if name else ""
                cells = _average_cells(x[places], y[places], columns.values[value.column][places])
                yield ValueMap(
                    caption=f"{value.title} over {x_key} and {y_key}{suffix}.",
                    alternative=f"Map of {value.title} over {x_key} and {y_key}{suffix}.",
                    x_label=x_key,
                    y_label=y_key,
                    value_label=value.title,
                    x=np.unique(x[places]).tolist(),
                    y=np.unique(y[places]).tolist(),
                    values=[[None if np.isnan(cell) else float(cell) for cell in row] for row in cells],
                    lower=value.lower,
                    upper=value.upper,
                )


def mark_limit(value: EvaluatedValue, axis: Literal["x", "y"]) -> list[Mark]:
    """Lines of a chart at the bounds of a limit."""
    bounds = {"lower limit": value.lower, "upper limit": value.upper}
    return [Mark(label=label, axis=axis, low=bound) for label, bound in bounds.items() if bound is not None]


def _list_curve_keys(columns: CampaignColumns, keys: Sequence[str]) -> list[str]:
    return [key for key in keys if columns.is_numeric(key) and len(columns.distinct(key)) >= FEWEST_POINTS]


def _group_others(
    columns: CampaignColumns, grid_keys: Sequence[str], drawn: Sequence[str], most: int
) -> dict[str, IntegerArray]:
    """Runs that agree in all inputs of the grid but the drawn ones; all runs of a case if there are more groups."""
    groups = columns.group([key for key in grid_keys if key not in drawn])
    if len(groups) <= max(most, 1):
        return groups
    by_case = columns.group(())
    return by_case if len(by_case) <= max(most, 1) else {"all cases": np.arange(len(columns.cases))}


def _build_curve(
    columns: CampaignColumns, key: str, value: EvaluatedValue, name: str, runs: IntegerArray
) -> Iterator[Series]:
    """Curve of a value against an input: the runs with their intervals, or the mean of several runs with its range."""
    x, y = _merge_places(np.array(columns.inputs[key], float)[runs], MOST_PLACES), columns.values[value.column][runs]
    width = columns.widths.get(value.column, np.full(columns.designs.size, np.nan))[runs]
    known = ~np.isnan(y)
    order = np.argsort(x[known], kind="stable")
    x, y, width = (part[known][order] for part in (x, y, width))
    places, start = np.unique(x, return_index=True)
    label = ", ".join(filter(None, (value.owner, name))) or "runs"
    if places.size == x.size:
        error = width.tolist() if x.size and not np.isnan(width).any() else None
        yield Series(label=label, style="line", x=x.tolist(), y=y.tolist(), error=error)
        return
    parts = np.split(y, start[1:])
    low, high = (np.array([np.quantile(part, end) for part in parts]).tolist() for end in RANGE)
    yield Series(label=label, style="line", x=places.tolist(), y=[float(part.mean()) for part in parts])
    yield Series(label=label, style="band", x=places.tolist(), y=low, high=high)


def _explain_shade(series: Sequence[Series]) -> str:
    """Meaning of the shaded areas of a chart, for its caption."""
    if any(item.style == "band" for item in series):
        return RANGE_NOTE
    return INTERVAL_NOTE if any(item.error is not None for item in series) else ""


def _merge_places(x: RealArray, most: int) -> RealArray:
    """Values of an input; of more than `most` different ones, the middle of their interval."""
    if np.unique(x).size <= most:
        return x
    low, length = x.min(), np.ptp(x) / most
    return np.asarray(low + length * (np.minimum((x - low) // length, most - 1) + 0.5))


def _average_cells(x: RealArray, y: RealArray, values: RealArray) -> RealArray:
    """Mean value of each cell, (y, x); NaN without a value."""
    x_places, column = np.unique(x, return_inverse=True)
    y_places, row = np.unique(y, return_inverse=True)
    known = ~np.isnan(values)
    sums, counts = np.zeros((2, y_places.size, x_places.size))
    np.add.at(sums, (row[known], column[known]), values[known])
    np.add.at(counts, (row[known], column[known]), 1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
