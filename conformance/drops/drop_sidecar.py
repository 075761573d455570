"""Sidecar of a mass-drop record: TOML file with the descriptions of its columns, its mass drop and its line."""

from typing import Annotated, Any

from pydantic import Field

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.sourced_table import InputTable, Positive, Problems, cross_check, validation_problem
from pantocheck.conformance.core.table_sidecar import TableName, TableSidecar, find_table_name_problems
from pantocheck.conformance.core.units import MotionQuantity, convert_unit


class DropTestTable(InputTable):
    """Name of the test, and its line."""

    name: Annotated[str, Field(max_length=200)] = ""
    """Name of the test."""
    synthetic: bool = False
    """true: the record is simulated."""
    spans_m: Annotated[tuple[Positive, ...], Field(strict=False, max_length=1000)] = ()
    """Lengths of the spans [m]."""
    cw_tension_n: Positive | None = None
    """Tension of one contact wire [N]."""
    mw_tension_n: Positive | None = None
    """Tension of one messenger wire [N]."""


class DropTable(InputTable):
    """Dropped mass."""

    mass_kg: Annotated[float | None, Field(gt=0, le=1000)] = None
    """Dropped mass [kg]."""
    wire: Annotated[str, Field(max_length=20)] = ""
    """Wire with the mass: CW (contact wire) or MW (messenger wire)."""
    position_m: float | None = None
    """Distance of the mass from the first support [m]."""


class DropRecordTable(InputTable):
    """Sampling of the record."""

    sampling_rate_hz: Annotated[float, Field(gt=0, le=1e6)]
    """Sampling rate [Hz]."""
    trigger_nominal_s: Annotated[float | None, Field(ge=0)] = None
    """Planned time of the release [s]."""
    n_channels: Annotated[int | None, Field(ge=1)] = None
    """Number of channels."""
    quantity: MotionQuantity | None = None
    """Measured quantity."""
    shared_clock: bool | None = None
    """true: one clock samples all sensors; default: the clocks are compared, and corrected."""


class DropChannelTable(InputTable):
    """Column of the record."""

    column: Annotated[int, Field(ge=1, le=10000)]
    """Number of the column from 1, without the time column."""
    name: Annotated[str, Field(max_length=100)]
    """Name of the channel."""
    sensor: Annotated[int, Field(ge=0)]
    """Number of the sensor."""
    wire: Annotated[str, Field(max_length=20)] = ""
    """Wire with the sensor: CW (contact wire) or MW (messenger wire)."""
    position_m: float | None = None
    """Distance of the sensor from the first support [m]."""
    direction: Annotated[str, Field(max_length=10)]
    """Direction of measurement: +x, -x, +y, -y, +z or -z."""
    unit: Annotated[str, Field(max_length=40)]
    """Unit of the samples, such as m/s2 or g."""

    @property
    def description(self) -> TableColumn:
        """The column as a `TableColumn`."""
        return TableColumn(
            self.name,
            unit=self.unit,
            sensor=self.sensor,
            wire=self.wire,
            position=self.position_m,
            direction=self.direction,
        )


class DropSidecar(TableSidecar):
    """Sidecar of a mass-drop record."""

    test: DropTestTable = DropTestTable()
    drop: DropTable = DropTable()
    record: DropRecordTable
    channel: Annotated[tuple[DropChannelTable, ...], Field(strict=False)] = ()
    """Channels, one per column."""
    channel_file: TableName | None = None
    """Name of a table beside the sidecar with the same keys as columns, in place of [[channel]]: CSV, XLSX or ODS."""

    @cross_check
    def _check_channels(self) -> Problems:
        if bool(self.channel) == (self.channel_file is not None):
            found = "missing" if not self.channel else "given beside channel_file"
            yield validation_problem("channel", found, "Give one [[channel]] per column, or channel_file.")
        if self.channel_file is not None:
            yield from find_table_name_problems(self.channel_file)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels in the order of their columns."""
        return tuple(channel.name for channel in sorted(self.channel, key=lambda channel: channel.column))

    @property
    def attributes(self) -> dict[str, Any]:
        """Stated data of the test, by the names of `MeasuredTable.attributes`."""
        attributes = {
            "test": self.test.name,
            "drop_mass_kg": self.drop.mass_kg,
            "drop_wire": self.drop.wire,
            "drop_position_m": self.drop.position_m,
            "trigger_nominal_s": self.record.trigger_nominal_s,
            "shared_clock": self.record.shared_clock,
            "spans_m": self.test.spans_m,
            "cw_tension_n": self.test.cw_tension_n,
            "mw_tension_n": self.test.mw_tension_n,
        }
        return {name: value for name, value in attributes.items() if value not in (None, "", ())}


# Descriptions of the columns of a mass-drop record, from its sidecar, or from the file if it has no sidecar.
def describe_columns(table: MeasuredTable, sidecar: DropSidecar | None) -> list[tuple[int, TableColumn]]:
    """Number (from 1) and description of each column that is a channel of the record.

    Raises:
        InputError: The file has neither descriptions of its channels nor a sidecar, or file and sidecar contradict each
            other.
    """
    if sidecar is None:
        if any(column.direction is None for column in table.columns):
            raise InputError(
                table.where,
                "has neither descriptions of its columns nor a sidecar",
                "Write a TOML file with the same stem, with [record] sampling_rate_hz and one [[channel]] per column.",
            )
        return list(enumerate(table.columns, 1))
    _check_numbers(table, sidecar)
    for channel in sidecar.channel:
        _check_agreement(channel, table.columns[channel.column - 1], table.where)
    return [(channel.column, channel.description) for channel in sidecar.channel]


def _check_numbers(table: MeasuredTable, sidecar: DropSidecar) -> None:
    """Refuse a sidecar that describes a column twice, or not at all, or a column that is not in the table."""
    declared, width = sidecar.record.n_channels, len(table.columns)
    columns = [channel.column for channel in sidecar.channel]
    fault = None
    if declared is not None and declared != len(columns):
        fault = f"states n_channels = {declared}, but describes {len(columns)} channels"
    elif repeated := [column for column in columns if columns.count(column) > 1]:
        fault = f"describes column {repeated[0]} twice"
    if fault is not None:
        raise InputError(f"sidecar of {table.where}", fault, "Write one [[channel]] per column.")
    missing = [channel.name for channel in sidecar.channel if channel.column > width]
    if missing:
        raise InputError(
            table.where,
            f"has {width} columns, but the sidecar describes column {max(columns)} ({', '.join(missing[:6])} missing)",
            "It may be truncated: copy or export it again with all channels, or give the sidecar of this file.",
        )


def _check_agreement(channel: DropChannelTable, column: TableColumn, where: str) -> None:
    """Refuse a file whose name or unit of a column differs from the sidecar."""
    if column.name and column.name.strip() != channel.name.strip():
        raise InputError(
            f"{where}, column {channel.column}",
            f"is named '{column.name[:60]}', but the sidecar names it '{channel.name}'",
            "Correct name or column number in the sidecar; exchanged channels give wrong mode shapes.",
        )
    if column.unit and convert_unit(column.unit, where) != convert_unit(channel.unit, f"sidecar of {where}"):
        raise InputError(
            f"{where}, channel '{channel.name}'",
            f"has the unit {column.unit} in the file, but {channel.unit} in the sidecar",
            "Correct the wrong unit.",
        )
