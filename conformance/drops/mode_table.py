"""Modes as a table of comma-separated values: one row per mode, three columns per sensor."""

import csv
import io
from pathlib import Path
from typing import NamedTuple

from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.json_file import round_significant
from pantocheck.conformance.results.identified_modes import Mode, SensorShape

# Modes as a table of comma-separated values: one row per mode, three columns per sensor.
MODE_COLUMNS = (
    *(
        "record",
        "frequency_Hz",
        "frequency_std_Hz",
        "damping_ratio",
        "damping_ratio_std",
        "group",
        "certain",
        "outlier",
    ),
    *("lateral", "error", "phase_collinearity", "half_power_points", "amplitude_at_release"),
)
"""Columns of the CSV file that have the names of keys of modes.json."""


SHAPE_PARTS = ("re", "im", "std")
"""Parts of a component of a shape, one column each."""


class SensorPlace(NamedTuple):
    """Sensor with its wire and position [m]; components at one place share columns."""

    sensor: int
    wire: str
    position_m: float | None

    @property
    def name(self) -> str:
        """Name in a column heading, as `sensor_1_CW_195.75_m`."""
        position = "" if self.position_m is None else f"_{self.position_m:g}_m"
        return f"sensor_{self.sensor}{f'_{self.wire}' if self.wire else ''}{position}"


def write_modes_csv(modes: tuple[Mode, ...], path: Path) -> None:
    """Write one row per mode; a cell is empty if its value is unknown or the mode was not measured at this sensor.

    Raises:
        InputError: The file cannot be written.
    """
    places = list_sensor_places(modes)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*MODE_COLUMNS, *(f"{place.name}_{part}" for place in places for part in SHAPE_PARTS)])
    for mode in modes:
        shape = {place_sensor(component): component for component in mode.sensor_shape}
        cells = [_format_cell(getattr(mode, column)) for column in MODE_COLUMNS]
        for place in places:
            component = shape.get(place)
            cells += [_format_cell(None if component is None else getattr(component, part)) for part in SHAPE_PARTS]
        writer.writerow(cells)
    write_atomically(path, text.getvalue().encode("utf-8"))


def place_sensor(component: SensorShape) -> SensorPlace:
    """Sensor of one component of a shape."""
    return SensorPlace(component.sensor, component.wire, component.position_m)


def list_sensor_places(modes: tuple[Mode, ...]) -> tuple[SensorPlace, ...]:
    """Sensors of all modes, each once, in the order of their number."""
    places = {place_sensor(component) for mode in modes for component in mode.sensor_shape}
    return tuple(sorted(places, key=lambda place: (place.sensor, place.wire, place.position_m or 0.0)))


def _format_cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(round_significant(value)) if isinstance(value, float) else value
