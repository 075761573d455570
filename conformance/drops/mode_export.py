"""Export of modes for other programs: a table of comma-separated values, or a universal file."""

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import round_significant
from pantocheck.conformance.results.identified_modes import Mode, SensorShape

# Table of comma-separated values: one row per mode, three columns per sensor.
MODE_COLUMNS = (
    *("record", "frequency_Hz", "frequency_std_Hz", "damping_ratio", "damping_ratio_std", "group", "certain"),
    *("outlier", "lateral", "error", "phase_collinearity", "half_power_points", "amplitude_at_release"),
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
        shape = {locate_sensor(component): component for component in mode.sensor_shape}
        cells = [_format_cell(getattr(mode, column)) for column in MODE_COLUMNS]
        for place in places:
            component = shape.get(place)
            cells += [_format_cell(None if component is None else getattr(component, part)) for part in SHAPE_PARTS]
        writer.writerow(cells)
    write_atomically(path, text.getvalue().encode("utf-8"))


def locate_sensor(component: SensorShape) -> SensorPlace:
    """Sensor of one component of a shape."""
    return SensorPlace(component.sensor, component.wire, component.position_m)


def list_sensor_places(modes: tuple[Mode, ...]) -> tuple[SensorPlace, ...]:
    """Sensors of all modes, each once, in the order of their number."""
    places = {locate_sensor(component) for mode in modes for component in mode.sensor_shape}
    return tuple(sorted(places, key=lambda place: (place.sensor, place.wire, place.position_m or 0.0)))


def _format_cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(round_significant(value)) if isinstance(value, float) else value


# Universal file in ASCII: units (data set 164), sensors as nodes (15) and shapes (55).
SI_SYSTEM = {
    "type": 164,
    "units_code": 1,
    "units_description": "SI: metre (newton)",
    "temp_mode": 2,
    "length": 1.0,
    "force": 1.0,
    "temp": 1.0,
    "temp_offset": 273.15,
}
"""Data set 164 of SI units; a file needs the values of the temperature, although no data set uses them."""


def write_modes_uff(modes: tuple[Mode, ...], path: Path) -> None:
    """Write every mode as complex mode of first order.

    The nodes lie on a straight line at height 0, because modes.json holds no heights; they are left out if a position
    is unknown. Shapes are vertical displacements, scaled to 1 at their largest component, so that modal A and B are 0.

    Raises:
        InputError: The file cannot be written.
    """
    from pantocheck.conformance.core.uff_table import write_data_sets  # an optional package

    nodes = number_nodes(list_sensor_places(modes))
    shapes = [_build_shape_set(mode, number, nodes) for number, mode in enumerate(modes, 1)]
    write_data_sets(path, [SI_SYSTEM, *_build_node_sets(nodes), *shapes])


def number_nodes(places: tuple[SensorPlace, ...]) -> dict[SensorPlace, int]:
    """Number of the node of each sensor: that of the sensor, or 1, 2, 3 ... if places share the number of a sensor."""
    unique = len({place.sensor for place in places}) == len(places)
    return {place: place.sensor if unique else number for number, place in enumerate(places, 1)}


def _build_node_sets(nodes: dict[SensorPlace, int]) -> list[dict[str, Any]]:
    """Data set 15 of the nodes; none if a position is unknown."""
    positions = [place.position_m for place in nodes if place.position_m is not None]
    if not nodes or len(positions) < len(nodes):
        return []
    zeros = np.zeros(len(nodes))
    return [{"type": 15, "node_nums": np.array([*nodes.values()]), "x": np.array(positions), "y": zeros, "z": zeros}]


def _build_shape_set(mode: Mode, number: int, nodes: dict[SensorPlace, int]) -> dict[str, Any]:
    """Data set 55 of a mode; its identification lines name the record and the properties of the mode."""
    from pantocheck.conformance.core.uff_table import encode_identification_line

    omega, ratio = 2 * np.pi * mode.frequency_Hz, mode.damping_ratio
    values = np.array([complex(component.re, component.im) for component in mode.sensor_shape])
    group = "no group of span modes" if mode.group is None else f"group {mode.group} of span modes"
    lines = (
        mode.record,
        f"{mode.frequency_Hz:.8g} Hz, damping ratio {mode.damping_ratio:.8g} +- {mode.damping_ratio_std:.2g}",
        f"{group}, {'certain' if mode.certain else 'uncertain'}{', lateral' if mode.lateral else ''}",
        "largest component of the shape 1, modal A and B not determined",
        "pantocheck drop identify",
    )
    return {
        "type": 55,
        **{f"id{n}": encode_identification_line(line) for n, line in enumerate(lines, 1)},
        "model_type": 1,
        "analysis_type": 3,
        "data_ch": 2,
        "spec_data_type": 8,
        "load_case": 1,
        "mode_n": number,
        "eig": complex(-ratio * omega, omega * np.sqrt(1 - ratio**2)),
        "modal_a": 0j,
        "modal_b": 0j,
        "node_nums": np.array([nodes[locate_sensor(component)] for component in mode.sensor_shape]),
        "r1": np.zeros_like(values),
        "r2": np.zeros_like(values),
        "r3": values,
    }


# Formats by the suffix of the file.
ModeWriter = Callable[[tuple[Mode, ...], Path], None]

MODE_FORMATS: dict[str, ModeWriter] = {
    ".csv": write_modes_csv,
    ".uff": write_modes_uff,
    ".unv": write_modes_uff,
}
"""Writer of modes by the suffix of the file."""


def select_mode_writer(path: Path) -> ModeWriter:
    """Writer of the format that the suffix of a file names.

    Raises:
        InputError: No writer has this suffix, or its package is not installed.
    """
    if (writer := MODE_FORMATS.get(path.suffix.lower())) is None:
        raise InputError(
            str(path), f"format '{path.suffix}' cannot be written", f"Write one of {', '.join(MODE_FORMATS)}."
        )
    if writer is write_modes_uff:
        require_package("pyuff", str(path))
    return writer
