"""Descriptions of the columns of a mass-drop record, from its sidecar, or from the file if it has no sidecar."""

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.input_files.units import convert_unit
from pantocheck.conformance.mass_drops.drop_sidecar import DropChannelTable, DropSidecar


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
