"""Axes of a design: rows of inputs that are found by their number, so that no list of runs is built."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from pantocheck.conformance.campaigns.campaign_file import (
    ColumnVariation,
    InputSampling,
    RangeVariation,
    TableVariation,
    ValueRange,
    ValueVariation,
)
from pantocheck.conformance.campaigns.distributions import Discrete, Distribution, Seed
from pantocheck.conformance.cases.input_changes import parse_value
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.spreadsheet import read_spreadsheet

Inputs = dict[str, Any]
"""Values by key."""

_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")


class DesignAxis(Protocol):
    """Sequence of rows; each row has values of the same keys."""

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of every row."""

    def __len__(self) -> int:
        """Number of rows."""

    def row(self, number: int) -> Inputs:
        """Values of a row; rows count from 0."""


@dataclass(frozen=True)
class RangeAxis:
    """Equidistant values of one key, computed in decimals: 0.1 + 0.2 is 0.3."""

    key: str
    values: ValueRange

    @property
    def keys(self) -> tuple[str, ...]:
        """The key."""
        return (self.key,)

    def __len__(self) -> int:
        """Number of values."""
        start, stop, step = (Decimal(repr(value)) for value in (self.values.start, self.values.stop, self.values.step))
        return int((stop - start) // step) + 1

    def row(self, number: int) -> Inputs:
        """Value of a number; whole numbers stay whole."""
        start, step = self.values.start, self.values.step
        if isinstance(start, int) and isinstance(step, int):
            return {self.key: start + number * step}
        return {self.key: float(Decimal(repr(start)) + number * Decimal(repr(step)))}


@dataclass(frozen=True)
class ColumnAxis:
    """Values of several keys that vary together."""

    keys: tuple[str, ...]
    columns: tuple[Sequence[Any], ...]
    """Values of each key, all of the same length."""

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.columns[0])

    def row(self, number: int) -> Inputs:
        """Values of a row."""
        return {key: column[number] for key, column in zip(self.keys, self.columns, strict=True)}


@dataclass(frozen=True)
class SampleAxis:
    """Random designs: points of the unit cube, turned into values by the distributions of the inputs."""

    sampling: InputSampling
    values: tuple[RealArray, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the random inputs."""
        return tuple(sampled.key for sampled in self.sampling.input)

    def __len__(self) -> int:
        """Number of designs."""
        return self.values[0].size

    def row(self, number: int) -> Inputs:
        """Values of a design."""
        row: Inputs = {}
        for sampled, values in zip(self.sampling.input, self.values, strict=True):
            row[sampled.key] = _name_value(sampled.distribution, float(values[number]))
        return row

    @property
    def ordered_keys(self) -> tuple[str, ...]:
        """Keys of the random inputs whose values have an order: all but seeds."""
        return tuple(sampled.key for sampled in self.sampling.input if not isinstance(sampled.distribution, Seed))


def build_axis(
    variation: ValueVariation | RangeVariation | ColumnVariation | TableVariation, folder: Path
) -> DesignAxis:
    """Build the axis of a variation; a table of designs is read from a folder.

    Raises:
        InputError: The table cannot be read, or a cell is not a value.
    """
    match variation:
        case ValueVariation(key=key, values=values):
            return ColumnAxis((key,), (values,))
        case RangeVariation(key=key, range=values):
            return RangeAxis(key, values)
        case ColumnVariation(columns=columns):
            return ColumnAxis(tuple(columns), tuple(columns.values()))
        case TableVariation(table=name):
            return _read_table(folder / name)


def sample_inputs(sampling: InputSampling) -> SampleAxis:
    """Draw the random designs of a campaign; the same seed gives the same designs."""
    dimension = len(sampling.input)
    if sampling.method == "saltelli":
        points = _exchange_inputs(_draw_points("sobol", 2 * dimension, sampling.runs, sampling.seed))
    else:
        points = _draw_points(sampling.method, dimension, sampling.runs, sampling.seed)
    columns = zip(points.T, sampling.input, strict=True)
    return SampleAxis(sampling, tuple(_draw_values(sampled.distribution, column) for column, sampled in columns))


def _draw_values(distribution: Distribution, probability: RealArray) -> RealArray:
    """Values of a distribution, or places of the values of a discrete one, at some probabilities."""
    match distribution:
        case Discrete():
            return distribution.choices(probability)
        case Seed():
            return distribution.seeds(probability)
        case _:
            return distribution.quantiles(probability)


def _name_value(distribution: Distribution, drawn: float) -> Any:
    """Value of an input from a drawn number."""
    match distribution:
        case Discrete(values=values):
            return values[int(drawn)]
        case Seed():
            return int(drawn)
        case _:
            return drawn


def _draw_points(method: str, dimension: int, runs: int, seed: int) -> RealArray:
    """Points of the unit cube, (runs, dimension)."""
    from scipy.stats import qmc  # imported here: it takes a second, which the workers do not need

    samplers = {"latin-hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}
    if method not in samplers:
        return np.random.default_rng(seed).random((runs, dimension))
    points: RealArray = samplers[method](dimension, rng=seed).random(runs)
    return points


def _exchange_inputs(points: RealArray) -> RealArray:
    """Designs of Saltelli (2010) from points of twice the dimension k: A, B, and A with input i of B, side by side.

    The k + 2 designs of a point follow each other, so that a part of the runs is a smaller design.
    """
    runs, dimension = points.shape[0], points.shape[1] // 2
    base, other = points[:, :dimension], points[:, dimension:]
    sets = np.repeat(base[:, None, :], dimension + 2, axis=1)
    sets[:, 1] = other
    for i in range(dimension):
        sets[:, 2 + i, i] = other[:, i]
    return sets.reshape(runs * (dimension + 2), dimension)


def _read_table(path: Path) -> ColumnAxis:
    """Axis of a table of designs; decimal commas are read where columns are separated by another mark."""
    table = read_spreadsheet(path)
    columns = []
    for index in range(len(table.head.cells)):
        values = []
        for row in table.rows:
            text = row.cells[index]
            if table.delimiter != "," and _DECIMAL_COMMA.fullmatch(text):
                text = text.replace(",", ".")
            values.append(parse_value(text, table.locate(row, index)))
        columns.append(values)
    return ColumnAxis(table.head.cells, tuple(columns))
