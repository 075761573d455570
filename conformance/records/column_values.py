"""Table `columns` of a sidecar: the columns of the file that hold the channels of a record."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_factor, split_unit
from pantocheck.conformance.core.input_error import InputError, join_errors, suggest_names
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.sourced_table import InputTable, Positive, Problems, cross_check, validation_problem
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.units import find_key_units
from pantocheck.conformance.records.record import ChannelRows, find_column

FileColumnName = Annotated[
    str, Field(min_length=1, max_length=300, description="name of a column or channel as in the file")
]


class ColumnTable(InputTable):
    """Column of the file: the value is scale times the number of the file plus offset, in the stated unit."""

    column: FileColumnName
    unit: Annotated[str | None, Field(max_length=40)] = None
    """Unit of the value, such as kN; default: the unit that the file states."""
    scale: float = 1.0
    """Factor on the numbers of the file [unit per number]."""
    offset: float = 0.0
    """Number added after the factor, in the unit of the value."""

    @cross_check
    def _check_scale(self) -> Problems:
        if self.scale == 0:
            yield validation_problem("scale", "found 0", "Give the factor from the numbers of the file to the unit.")
        if self.unit is None and (self.scale != 1 or self.offset != 0):
            yield validation_problem("unit", "missing, but the value is scaled", "Give the unit of the scaled value.")


class HeadPart(InputTable):
    """Part of the pantograph head above the force sensors, with its accelerometer."""

    mass_kg: Annotated[Positive, Field(le=200)]
    """Mass of this part of the head [kg]."""
    acceleration: ColumnTable
    """Vertical acceleration of this part, positive upward."""


class SensorSum(InputTable):
    """Contact force from several force sensors: their sum, less the inertia of the head above them."""

    sum: Annotated[tuple[ColumnTable, ...], Field(strict=False, min_length=1, max_length=32)]
    """Force sensors between head and frame, positive under pressure."""
    head: Annotated[tuple[HeadPart, ...], Field(strict=False, max_length=32)] = ()
    """Parts of the head above the sensors, for the inertia force."""
    aerodynamic_N: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    """Constant lift of the parts above the sensors [N], upward positive."""


ColumnSource = ColumnTable | SensorSum


# Values of columns in SI units, and the contact force from sensors above which the head moves.
#
# Free body of the head above the sensors, forces and accelerations positive upward::
#
#     |  F  contact force of the wire on the head, downward
#     v
# ---------  head: parts of mass m_i with accelerations a_i
#  ^     ^
#  S_1   S_2  forces of the sensors on the head (compression is positive)
#
# sum(m_i a_i) = sum(S_j) + L - F    ->    F = sum(S_j) - sum(m_i a_i) + L
#
# L is the aerodynamic lift of these parts. The weight is balanced in the zero of the sensors. Measuring systems after
# EN 50317 correct their force sensors in this way; the equation is Newton's second law.
TIME_COLUMN = "time"
"""Name of the time that a file holds beside its channels."""


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
    """Unit that a file states for a column: its own, or one at the end of the name; None without."""
    return column.unit or split_unit(column.name or "")[1]


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


# Warnings on a contact force from several sensors: no correction for the head, and sensors that are left out.
def list_left_out_sensors(columns: Mapping[str, ColumnSource], unused: Iterable[TableColumn]) -> tuple[str, ...]:
    """Names of unused columns that may be further sensors of a sum.

    Args:
        columns: Source of each channel, as in the sidecar.
        unused: Columns of the file that the sidecar does not use.

    Returns:
        Names with a unit of force, or without a unit and with the name of a summed sensor apart from its number; empty
        if the sidecar sums no sensors.
    """
    sums = [source for source in columns.values() if isinstance(source, SensorSum)]
    if not sums:
        return ()
    stems = {_stem(sensor.column) for source in sums for sensor in source.sum}
    forces = find_key_units("N")
    return tuple(
        column.label
        for column in unused
        if ((unit := find_stated_unit(column)) is not None and find_factor(unit, forces) is not None)
        or (unit is None and _stem(column.label) in stems)
    )


def list_sensor_warnings(columns: Mapping[str, ColumnSource] | None, left_out: Sequence[str] = ()) -> Iterator[str]:
    """Warn of a sum of sensors without a correction for the head, and of sensors that are left out.

    Args:
        columns: Source of each channel, as in the sidecar.
        left_out: Names of unused columns, as from `list_left_out_sensors`.

    Yields:
        Warning with the remedy.
    """
    for name, source in (columns or {}).items():
        if isinstance(source, SensorSum) and not source.head:
            yield (
                f"{name} is a sum of sensors without head: the inertia of the parts above the sensors is not corrected "
                "and the standard deviation may be far too small. Give head, with masses and accelerations: see "
                f"{DocumentationPage.LOGGER_FILES}"
            )
    if left_out:
        names = ", ".join(left_out)
        yield f"sensors are summed, but further columns of force are not used: {names}. Add those of the sum"


def _stem(name: str) -> str:
    """Name of a column without its numbers."""
    return re.sub(r"\d+", "", name).strip()


# Rows of channels from the columns that a sidecar names.
def read_mapped_rows(table: MeasuredTable, columns: Mapping[str, ColumnSource], where: str) -> ChannelRows:
    """Rows of the channels that a sidecar takes from columns of a file.

    Args:
        table: Table in the units of the file.
        columns: Source of each channel, by its name with number and SI unit.
        where: Name of the sidecar in messages.

    Returns:
        Rows of each channel by number from 1.

    Raises:
        InputError: A column is missing, or its unit is missing or wrong. The error lists all such columns.
    """
    file, rows, errors = FileColumns(table, where), ChannelRows(), list[InputError]()
    for name, source in columns.items():
        meaning = find_column(name, 1)
        assert meaning is not None  # checked by the sidecar
        key = f"columns.{name}"
        try:
            if isinstance(source, ColumnTable):
                values = file.read(source, meaning.channel.unit, key)
            else:
                values = file.sum_sensors(source, key)
        except InputError as error:
            errors.append(error)
            continue
        rows.setdefault(meaning.channel.name, {})[meaning.number] = values
    if errors:
        raise join_errors(errors)
    return rows


def list_used_columns(columns: Mapping[str, ColumnSource]) -> tuple[str, ...]:
    """Names of the columns of a file that a table of columns uses, each once."""
    names: dict[str, None] = {}
    for source in columns.values():
        if isinstance(source, ColumnTable):
            names[source.column] = None
        else:
            names |= dict.fromkeys(sensor.column for sensor in source.sum)
            names |= dict.fromkeys(part.acceleration.column for part in source.head)
    return tuple(names)
