"""Columns of a campaign: the inputs and the evaluated values of all runs that have a result."""

from array import array
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice
from sys import intern
from typing import Any

import numpy as np

from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.quantities.limit_text import format_bounds
from pantocheck.conformance.quantities.registry import QUANTITIES

SHOWN_QUANTITIES = (
    *("mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N"),
    *("contact_loss_pct", "max_uplift_at_support_mm"),
)
"""Quantities that are evaluated without a limit."""

MOST_EVALUATED = 12
"""Largest number of evaluated values: six quantities of two pantographs."""


@dataclass(frozen=True)
class EvaluatedValue:
    """Value of every run that is evaluated."""

    column: str
    """Name of its column, such as `1.std_force_N`."""
    lower: float | None = None
    upper: float | None = None
    """Bounds of its limit."""

    @property
    def quantity(self) -> str:
        """Name of the quantity."""
        return self.column.partition(".")[2].partition("[")[0]

    @property
    def owner(self) -> str:
        """Owner in words; empty for the line."""
        number, _, name = self.column.partition(".")
        item = f" {name[name.index('[') :]}" if "[" in name else ""
        return ("" if number == "0" else f"pantograph {number}") + item

    @property
    def label(self) -> str:
        """Quantity and unit."""
        quantity = QUANTITIES[self.quantity]
        return f"{quantity.label} [{quantity.unit or '-'}]"

    @property
    def title(self) -> str:
        """Quantity, owner and unit."""
        return f"{self.label}, {self.owner}" if self.owner else self.label

    @property
    def limit(self) -> str | None:
        """Bounds as text; None without a limit."""
        return None if self.lower is None and self.upper is None else format_bounds(self.lower, self.upper)


@dataclass(frozen=True)
class CampaignColumns:
    """Runs with a result, by columns."""

    cases: tuple[str, ...]
    systems: tuple[str, ...]
    """Case and system of every run."""
    inputs: dict[str, tuple[Any, ...]]
    """Values of every varied input."""
    values: dict[str, RealArray]
    """Numbers of every evaluated value by its column; NaN: not in the result."""
    designs: IntegerArray
    """Number of the design of every run, from 1, (n,)."""
    widths: dict[str, RealArray] = field(default_factory=dict)
    """Half-widths of the 95 % intervals of the values by column; NaN: not known."""

    def is_numeric(self, key: str) -> bool:
        """Whether an input is a number in all runs."""
        return all(isinstance(value, int | float) and not isinstance(value, bool) for value in self.inputs[key])

    def distinct(self, key: str) -> list[Any]:
        """Different values of an input, in the order of the runs."""
        return list(dict.fromkeys(map(_make_hashable, self.inputs[key])))

    def select(self, places: IntegerArray) -> "CampaignColumns":
        """Some of the runs, by their places from 0."""
        return CampaignColumns(
            tuple(self.cases[i] for i in places),
            tuple(self.systems[i] for i in places),
            {key: tuple(values[i] for i in places) for key, values in self.inputs.items()},
            {name: numbers[places] for name, numbers in self.values.items()},
            self.designs[places],
            {name: widths[places] for name, widths in self.widths.items()},
        )

    def group(self, keys: Sequence[str]) -> dict[str, IntegerArray]:
        """Numbers of the runs (from 0) that agree in case, system and some inputs, by a text that names their group."""
        parts: list[tuple[str, list[Any]]] = [("", list(self.cases)), ("", list(self.systems))]
        parts += [(f"{key} = ", [_make_hashable(value) for value in self.inputs[key]]) for key in keys]
        shown = [(prefix, column) for prefix, column in parts if len(set(column)) > 1]
        names = [", ".join(f"{prefix}{column[i]}" for prefix, column in shown) for i in range(len(self.cases))]
        places: dict[str, list[int]] = {}
        for i, name in enumerate(names):
            places.setdefault(name, []).append(i)
        return {name: np.array(numbers) for name, numbers in places.items()}


def choose_values(store: CampaignStore, limits: dict[str, tuple[float | None, float | None]]) -> list[EvaluatedValue]:
    """Choose the evaluated values: those with a limit, or else the usual quantities of all pantographs and the line."""
    delivered = {name for row in islice(store.rows(), SEARCHED_RUNS) for name in row.quantities}
    limited = [EvaluatedValue(name, *bounds) for name, bounds in limits.items() if name in delivered]
    usual = [
        EvaluatedValue(name)
        for quantity in SHOWN_QUANTITIES
        for name in sorted(delivered)
        if name.partition(".")[2] == quantity and name not in limits
    ]
    return [*limited, *usual][:MOST_EVALUATED]


SEARCHED_RUNS = 1000
"""Number of runs whose quantities are looked at: all runs of a case deliver the same quantities."""


SMALLEST_SPREAD = 1e-4
"""Smallest spread of a drawn value relative to its size: a tuned mean force differs by less between the runs."""


def leave_out_constant(values: Sequence[EvaluatedValue], columns: CampaignColumns) -> list[EvaluatedValue]:
    """Values that have a limit or differ between the runs: a constant value needs no chart."""
    differing = {
        name
        for name, numbers in columns.values.items()
        if numbers.size and np.nanmax(numbers) - np.nanmin(numbers) > SMALLEST_SPREAD * np.nanmax(np.abs(numbers))
    }
    return [value for value in values if value.limit is not None or value.column in differing]


def read_columns(store: CampaignStore, values: Sequence[EvaluatedValue], keys: Sequence[str]) -> CampaignColumns:
    """Read the values and the varied inputs of the runs that have a result, in some 20 bytes per number."""
    cases, systems, designs = list[str](), list[str](), array("q")
    inputs: dict[str, list[Any]] = {key: [] for key in keys}
    numbers, widths = ({value.column: array("d") for value in values} for _ in range(2))
    for row in store.rows():
        if row.quantities:
            cases.append(intern(row.run.case_id))
            systems.append(intern(row.run.system))
            designs.append(row.run.design)
            for key, column in inputs.items():
                column.append(row.run.inputs.get(key))
            for name in numbers:
                numbers[name].append(row.quantities.get(name, np.nan))
                widths[name].append(row.uncertainties.get(name, np.nan))
    return CampaignColumns(
        tuple(cases),
        tuple(systems),
        {key: tuple(column) for key, column in inputs.items()},
        {name: np.array(column) for name, column in numbers.items()},
        np.array(designs, np.int64),
        {name: np.array(column) for name, column in widths.items()},
    )


def count_reasons(store: CampaignStore) -> tuple[dict[str, int], dict[str, int]]:
    """Number of runs by verdict, and the most frequent reasons of runs without a result."""
    verdicts, reasons = Counter[str](), Counter[str]()
    for verdict, reason in store.outcomes():
        verdicts[verdict] += 1
        if reason and (reason in reasons or len(reasons) < MOST_REASONS):
            reasons[reason] += 1
    return dict(verdicts.most_common()), dict(reasons.most_common(SHOWN_REASONS))


MOST_REASONS, SHOWN_REASONS = 1000, 10
"""Largest number of different reasons that are counted, and number of those in the report."""


def _make_hashable(value: Any) -> Any:
    return tuple(map(_make_hashable, value)) if isinstance(value, list) else value
