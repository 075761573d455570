"""Design of a campaign: axes, conditions, and runs that follow from their number, so that it takes no memory."""

import operator
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import prod
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from pantocheck.conformance.campaigns.campaign_file import (
    ColumnVariation,
    InputLink,
    InputSampling,
    RangeVariation,
    TableVariation,
    ValueRange,
    ValueVariation,
)
from pantocheck.conformance.campaigns.distributions import Discrete, Distribution, Seed
from pantocheck.conformance.cases.input_changes import parse_value
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError, suggest_names
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


def list_identifying_rows(axis: DesignAxis) -> list[object]:
    """Keys, length, and first and last rows of a range or sample; all rows of a list or table."""
    rows = range(len(axis)) if isinstance(axis, ColumnAxis) else (0, len(axis) - 1)
    return [list(axis.keys), len(axis), *(axis.row(i) for i in rows)]


def build_axis(
    variation: ValueVariation | RangeVariation | ColumnVariation | TableVariation, folder: Path
) -> DesignAxis:
    """Axis of a variation; a table of designs is read from a folder."""
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


# Conditions on the inputs of a design, such as `speed_km_h <= 320` or `spacing_m < geometry.spans`.
RELATIONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "!=": operator.ne,
    "==": operator.eq,
    "<": operator.lt,
    ">": operator.gt,
}
"""Relations by their sign; longer signs come first, because `<` is a part of `<=`."""

_CONDITION = re.compile("(.+?)(" + "|".join(RELATIONS) + ")(.+)")


@dataclass(frozen=True)
class Condition:
    """Relation of a varied input to a value or to another varied input."""

    text: str
    """The condition as the user wrote it."""
    key: str
    """Varied input on the left."""
    relation: str
    """One of `RELATIONS`."""
    value: object
    """Value on the right, or the key of a varied input."""

    def holds(self, inputs: Inputs) -> bool:
        """Whether the inputs of a design meet the condition."""
        right = inputs[self.value] if isinstance(self.value, str) and self.value in inputs else self.value
        try:
            return bool(RELATIONS[self.relation](inputs[self.key], right))
        except TypeError:
            found = f"compares {inputs[self.key]!r} with {right!r}"
            raise InputError(f"campaign, condition {self.text!r}", found, "Compare numbers with numbers.") from None


def parse_condition(text: str, keys: Collection[str]) -> Condition:
    """Condition from its text, which is the key of a varied input, a relation, and a value or another key."""
    where = f"campaign, condition {text[:80]!r}"
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise InputError(where, "is not a condition", "Write KEY RELATION VALUE, e.g. speed_km_h <= 320 .")
    key, relation, right = (part.strip() for part in match.groups())
    if key not in keys:
        raise InputError(where, f"{key!r} is not a varied input", suggest_names(key, list(keys)))
    return Condition(text, key, relation, right if right in keys else parse_value(right, where))


@dataclass(frozen=True)
class PlannedRun:
    """Run of a campaign."""

    number: int
    """Number of the run, from 1."""
    design: int
    """Number of the design, from 1; the same for all systems."""
    case_id: str
    """Id of the base case."""
    system: str
    """System as in the option `--system`."""
    inputs: Inputs
    """Values of the varied inputs by key."""


@dataclass(frozen=True)
class CampaignDesign:
    """Every base case with every combination of the axes, on every system.

    The case changes slowest, then the axes in their order; the system changes from run to run. A design that breaks a
    condition is left out; the numbers of the others stay.
    """

    case_ids: tuple[str, ...]
    """Ids of the base cases."""
    axes: tuple[DesignAxis, ...]
    """Axes of the grid; the last one changes fastest."""
    links: tuple[InputLink, ...]
    """Inputs that follow a varied input."""
    conditions: tuple[Condition, ...]
    """Conditions on the inputs."""
    systems: tuple[str, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the varied inputs, linked ones last."""
        return (*(key for axis in self.axes for key in axis.keys), *(link.key for link in self.links))

    @property
    def candidates(self) -> int:
        """Number of designs before the conditions."""
        return len(self.case_ids) * prod(len(axis) for axis in self.axes)

    def count_runs(self) -> int:
        """Count the runs; with conditions, all designs are computed one by one."""
        if not self.conditions:
            return self.candidates * len(self.systems)
        return sum(1 for _ in self.list_runs())

    def list_runs(self) -> Iterator[PlannedRun]:
        """List the runs in the order of their numbers, one at a time."""
        for design in range(self.candidates):
            case_id, inputs = self._locate(design)
            if all(condition.holds(inputs) for condition in self.conditions):
                for i, system in enumerate(self.systems):
                    number = design * len(self.systems) + i + 1
                    named = system.replace("{design}", str(design + 1))
                    yield PlannedRun(number, design + 1, case_id, named, inputs)

    def _locate(self, design: int) -> tuple[str, Inputs]:
        """Id of the base case and inputs of a design, by the digits of its number in the lengths of the axes."""
        rows: list[Inputs] = []
        for axis in reversed(self.axes):
            design, place = divmod(design, len(axis))
            rows.append(axis.row(place))
        inputs: Inputs = {}
        for row in reversed(rows):
            inputs |= row
        for link in self.links:
            inputs[link.key] = link.factor * inputs[link.follows] + link.offset
        return self.case_ids[design], inputs
