"""Modes as a universal file in ASCII: units (data set 164), sensors as nodes (15) and shapes (55)."""

from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.uff_table import encode_identification_line, write_data_sets
from pantocheck.conformance.drops.mode_table import SensorPlace, list_sensor_places, place_sensor
from pantocheck.conformance.results.identified_modes import Mode

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
        "node_nums": np.array([nodes[place_sensor(component)] for component in mode.sensor_shape]),
        "r1": np.zeros_like(values),
        "r2": np.zeros_like(values),
        "r3": values,
    }
