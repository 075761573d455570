"""Display of the Python interface: values in one line, tables, and warnings of missing formats."""

import importlib.util
import textwrap
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

LONGEST_DESCRIPTION = 160
"""Longest line that describes a value: two lines of a terminal of 80 columns."""


def describe_in_one_line(value: object, *facts: str) -> str:
    """Class of a value with facts about it, shortened to one line."""
    return f"<{type(value).__name__} {textwrap.shorten(', '.join(facts), LONGEST_DESCRIPTION, placeholder=' ...')}>"


def tabulate_columns(columns: Mapping[str, NDArray[Any]]) -> Any:
    """Table of equally long columns: of pandas if that is installed, otherwise the columns themselves."""
    if importlib.util.find_spec("pandas") is None:
        return dict(columns)
    import pandas

    return pandas.DataFrame(dict(columns))


def tabulate_rows(rows: Sequence[Mapping[str, object]], names: Sequence[str]) -> Any:
    """Table of rows with the same keys; see `tabulate_columns`. A number that is missing is NaN."""
    return tabulate_columns({name: build_column([row[name] for row in rows]) for name in names})


def build_column(values: Sequence[object]) -> NDArray[Any]:
    """Array of numbers if every value is a number or missing, otherwise of objects."""
    if all(value is None or (isinstance(value, float | int) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else value for value in values])
    column = np.empty(len(values), object)
    for place, value in enumerate(values):  # a list stays the value of one cell
        column[place] = value
    return column


def warn_missing_formats(stated: Sequence[str] | None = None) -> None:
    """Warn the caller of a method of the interface of formats, stated or default, whose extra is not installed."""
    from pantocheck.conformance.pages.report_writers import remark_missing_formats  # pages, which most values need not

    for remark in remark_missing_formats(stated):
        warnings.warn(remark, stacklevel=3)
