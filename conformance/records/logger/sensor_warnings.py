"""Warnings on a contact force from several sensors: no correction for the head, and sensors that are left out."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.measured_table import TableColumn
from pantocheck.conformance.input_files.units import find_key_units
from pantocheck.conformance.records.logger.column_tables import ColumnSource, SensorSum
from pantocheck.conformance.records.logger.column_values import find_factor, find_stated_unit


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
