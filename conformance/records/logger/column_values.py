"""Values of columns in SI units, and the contact force from sensors above which the head moves.

Free body of the head above the sensors, forces and accelerations positive upward::

        |  F  contact force of the wire on the head, downward
        v
    ---------  head: parts of mass m_i with accelerations a_i
     ^     ^
     S_1   S_2  forces of the sensors on the head (compression is positive)

    sum(m_i a_i) = sum(S_j) + L - F    ->    F = sum(S_j) - sum(m_i a_i) + L

L is the aerodynamic lift of these parts. The weight is balanced in the zero of the sensors. Measuring systems after EN
50317 correct their force sensors in this way; the equation is Newton's second law.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.units import SPELLINGS, find_key_units, is_unit, key_suffix
from pantocheck.conformance.records.logger.column_tables import ColumnTable, SensorSum

TIME_COLUMN = "time"
"""Name of the time that a file holds beside its channels."""

_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]\s*$")


@dataclass(frozen=True)
class FileColumns:
    """Columns of a table by name."""

    table: MeasuredTable
    """Table in the units of the file."""
    where: str
    """Name of the sidecar in messages."""

    @property
    def labels(self) -> list[str]:
        """Names of the columns, with the row of a data set of several rows."""
        return [column.label for column in self.table.columns]

    def find(self, name: str, key: str) -> int:
        """Index of a column by its name.

        Raises:
            InputError: There is no such column, or there are several.
        """
        indices = [i for i, label in enumerate(self.labels) if label.strip() == name.strip()]
        place = f"{self.where}, key {key}"
        if not indices:
            raise InputError(
                place, f"there is no column {name[:80]!r} in {self.table.source}", suggest_names(name, self.labels)
            )
        if len(indices) > 1:
            raise InputError(place, f"{len(indices)} columns have the name {name[:80]!r}", "Rename them in the file.")
        return indices[0]

    def read(self, source: ColumnTable, unit: str, key: str) -> RealArray:
        """Values of a column in an SI unit.

        Args:
            source: Column with its unit and scale.
            unit: SI unit as at the end of a key, such as `m_s2`.
            key: Key of the sidecar in messages.

        Returns:
            Values, (n,) [SI].

        Raises:
            InputError: The column is missing or has no numbers; its unit is missing, of another quantity, or not that
                of the file.
        """
        index = self.find(source.column, f"{key}.column")
        values = self.table.values[:, index]
        if not np.isfinite(values).any():
            raise InputError(
                f"{self.where}, key {key}.column",
                f"the column {source.column[:80]!r} holds no numbers",
                "Name a column of numbers.",
            )
        factor = self._find_factor(source, self.table.columns[index], unit, key)
        with np.errstate(invalid="ignore", over="ignore"):  # numbers too large are reported with their place
            return np.asarray(factor * (source.scale * values + source.offset))

    def _find_factor(self, source: ColumnTable, column: TableColumn, unit: str, key: str) -> float:
        """Factor from the unit of a column to the SI unit."""
        place, known = f"{self.where}, key {key}.unit", find_key_units(unit)
        stated = find_stated_unit(column)
        if source.unit is None:
            if stated is None:
                raise InputError(
                    place, f"missing; the file states no unit of {column.label[:80]!r}", f"Give one of {_list(known)}."
                )
            return _convert(stated, known, f"{self.where}, key {key}.column")
        factor = _convert(source.unit, known, place)
        scaled = source.scale != 1 or source.offset != 0
        if stated is not None and not scaled and find_factor(stated, known) not in (None, factor):
            raise InputError(
                place,
                f"found {source.unit!r}, but the file states {stated!r} for {column.label[:80]!r}",
                "Correct the unit, or give scale beside it.",
            )
        return factor

    def sum_sensors(self, source: SensorSum, key: str) -> RealArray:
        """Contact force [N] from the sum of sensors and the inertia of the head; errors as in `read`."""
        force = np.full(self.table.values.shape[0], source.aerodynamic_N)
        for i, sensor in enumerate(source.sum, 1):
            force = force + self.read(sensor, "N", f"{key}.sum[{i}]")
        for i, part in enumerate(source.head, 1):
            force = force - part.mass_kg * self.read(part.acceleration, "m_s2", f"{key}.head[{i}].acceleration")
        return force


def add_time_column(table: MeasuredTable) -> MeasuredTable:
    """Same table with the time that a file holds beside its channels as column `TIME_COLUMN` [s]."""
    if table.time is None or any(column.name == TIME_COLUMN for column in table.columns):
        return table
    columns = (*table.columns, TableColumn(TIME_COLUMN, unit="s"))
    return replace(table, values=np.column_stack([table.values, table.time]), columns=columns)


def find_stated_unit(column: TableColumn) -> str | None:
    """Unit that a file states for a column: its own, or one in brackets at the end of the name; None without."""
    if column.unit:
        return column.unit
    match = _BRACKETS.search(column.name or "")
    return match[1].strip() if match and match[1].strip() and is_unit(match[1]) else None


def find_factor(text: str, known: Mapping[str, float]) -> float | None:
    """Factor of a unit to the SI unit; None if it is no unit of this quantity. `known` as from `find_key_units`."""
    name = text.strip()
    return known.get(key_suffix(SPELLINGS.get(name.lower(), name)))


def _convert(text: str, known: Mapping[str, float], place: str) -> float:
    factor = find_factor(text, known)
    if factor is None:
        raise InputError(
            place,
            f"{text[:40]!r} is not a unit of this channel",
            f"Known are {_list(known)}. For volts or another signal, give scale and the unit of the result.",
        )
    return factor


def _list(known: Mapping[str, float]) -> str:
    return ", ".join(name.replace("_", "/") for name in known)
