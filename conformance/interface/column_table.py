"""Tables of the Python interface: pandas if it is installed, otherwise columns of numpy."""

import importlib.util
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def tabulate_columns(columns: Mapping[str, NDArray[Any]]) -> Any:
    """Table of equally long columns.

    Args:
        columns: Columns by name.

    Returns:
        A table of pandas if that is installed, otherwise the columns.
    """
    if importlib.util.find_spec("pandas") is None:
        return dict(columns)
    import pandas

    return pandas.DataFrame(dict(columns))


def tabulate_rows(rows: Sequence[Mapping[str, object]], names: Sequence[str]) -> Any:
    """Table of rows with the same keys; see `tabulate_columns`. A number that is missing is NaN."""
    return tabulate_columns({name: _build_column([row[name] for row in rows]) for name in names})


def _build_column(values: Sequence[object]) -> NDArray[Any]:
    """Array of numbers if every value is a number or missing, otherwise of objects."""
    if all(value is None or (isinstance(value, float | int) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else value for value in values])
    return np.array(values, dtype=object)
