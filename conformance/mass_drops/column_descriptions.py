"""Descriptions of the columns of a mass-drop record: from the sidecar if there is one, else from the file."""

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.input_files.units import convert_unit
from pantocheck.conformance.mass_drops.drop_sidecar import DropChannelTable, DropSidecar


def describe_columns(table: MeasuredTable, sidecar: DropSidecar | None) -> list[tuple[int, TableColumn]]:
    """Number (from 1) and description of every column that is a channel of the record.

    Raises
    ------
    InputError
        The file describes no channels and has no sidecar, or file and sidecar contradict each other.
    """
    if sidecar is None:
        if any(column.direction is None for column in table.columns):
            raise InputError(
                table.where,
                "does not describe its columns and has no sidecar",
                "Put NAME.toml beside it, with [record] sampling_rate_hz and one [[channel]] per column.",
            )
        return list(enumerate(table.columns, 1))
    _check_numbers(table, sidecar)
    for channel in sidecar.channel:
        _check_agreement(channel, table.columns[channel.column - 1], table.where)
    return [(channel.column, channel.description) for channel in sidecar.channel]


def _check_numbers(table: MeasuredTable, sidecar: DropSidecar) -> None:
    """Refuse a sidecar that repeats or miscounts columns, or describes a column that the table lacks."""
    declared, width = sidecar.record.n_channels, len(table.columns)
    columns = [channel.column for channel in sidecar.channel]
    fault = None
    if declared is not None and declared != len(columns):
        fault = f"n_channels = {declared}, but {len(columns)} channels are described"
    elif repeated := [column for column in columns if columns.count(column) > 1]:
        fault = f"column {repeated[0]} is described twice"
    if fault is not None:
        raise InputError(f"sidecar of {table.where}", fault, "Describe every column once.")
    missing = [channel.name for channel in sidecar.channel if channel.column > width]
    if missing:
        raise InputError(
            table.where,
            f"{width} columns, the sidecar describes columns up to {max(columns)} (missing: {', '.join(missing[:6])})",
            "A channel is missing from the export, or the sidecar belongs to another file.",
        )


def _check_agreement(channel: DropChannelTable, column: TableColumn, where: str) -> None:
    """Refuse a name or unit in the file that differs from the sidecar."""
    if column.name and column.name.strip() != channel.name.strip():
        raise InputError(
            where,
            f"column {channel.column} is headed '{column.name[:60]}', the sidecar calls it '{channel.name}'",
            "Correct the sidecar: a confused channel gives wrong mode shapes.",
        )
    if column.unit and convert_unit(column.unit, where) != convert_unit(channel.unit, f"sidecar of {where}"):
        raise InputError(
            f"{where}, channel '{channel.name}'",
            f"the file says {column.unit}, the sidecar says {channel.unit}",
            "Correct the one that is wrong.",
        )
