"""Rows of channels from the columns that a sidecar names."""

from collections.abc import Mapping

from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.records.logger.column_tables import ColumnSource, ColumnTable
from pantocheck.conformance.records.logger.column_values import FileColumns
from pantocheck.conformance.records.record_channels import ChannelRows, find_column


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
