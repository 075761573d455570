"""Shapes of identified and computed modes at the sensors."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.model import Catenary, DiscretisedLine, Kind
from pantocheck.model.modal.modes import Modes, deflection_at

KIND_OF_WIRE = {"CW": Kind.CONTACT_WIRE, "MW": Kind.MESSENGER_WIRE, "SW": Kind.STITCH_WIRE}
"""Kinds of wire by their names in mass-drop records."""

Positions = set[tuple[str, float]]
"""Wire and position along the line [m] of sensors."""


def find_sensor_positions(modes: Sequence[Mode], line: Catenary, source: str) -> Positions:
    """Positions of the sensors on wires of the line.

    Parameters
    ----------
    modes : sequence of Mode
        Identified modes.
    line : Catenary
        The line that was measured.
    source : str
        Name of the file of the modes, for messages.

    Raises
    ------
    InputError
        A sensor lies beyond the line.
    """
    sensors = {(sensor.wire, sensor.position_m) for mode in modes for sensor in mode.sensor_shape}
    positions = {(wire, x) for wire, x in sensors if x is not None and wire in KIND_OF_WIRE}
    end = max(wire.end for wire in line.wires)
    outside = sorted(x for _, x in positions if not 0 <= x <= end)
    if outside:
        raise InputError(
            source,
            f"a sensor at {outside[0]:g} m, but the line ends at {end:g} m",
            "Name a case with the line that was measured.",
        )
    return positions


def compute_sensor_shapes(
    modes: Sequence[Mode], mesh: DiscretisedLine, shapes: Modes, positions: Positions
) -> tuple[list[ComplexArray], list[RealArray]]:
    """Identified and computed shapes at the sensors of each identified mode.

    Parameters
    ----------
    modes : sequence of Mode
        Identified modes.
    mesh : DiscretisedLine
        The line, with a station at each sensor.
    shapes : Modes
        Its n computed modes.
    positions : Positions
        Sensors on wires of the line.

    Returns
    -------
    list of (s,) complex ndarray
        Identified shape of each mode at its s sensors.
    list of (n, s) ndarray
        Computed shapes at the same sensors.
    """
    rows = {name: mesh.mesh.row_of[_wire_name(mesh.catenary, KIND_OF_WIRE[name]), "z"] for name, _ in positions}
    deflections = {(wire, x): deflection_at(mesh, shapes, rows[wire], x) for wire, x in positions}
    measured, computed = [], []
    for mode in modes:
        sensors = [s for s in mode.sensor_shape if (s.wire, s.position_m) in deflections]
        measured.append(np.array([complex(s.re, s.im) for s in sensors]))
        columns = [deflections[s.wire, s.position_m] for s in sensors if s.position_m is not None]
        computed.append(np.array(columns).T if columns else np.zeros((shapes.frequency.size, 0)))
    return measured, computed


def _wire_name(line: Catenary, kind: Kind) -> str:
    for wire in line.wires:
        if wire.kind is kind:
            return wire.name
    raise InputError("line", f"has no {kind.replace('_', ' ')}", "Name a case with the line that was measured.")
