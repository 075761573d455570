"""Shapes of matched modes along the line: computed shapes of the wires, and measured values at the sensors."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.mode_matching import KIND_OF_WIRE, MatchedModes, Positions, find_sensor_positions
from pantocheck.conformance.results.damping_format import (
    MeasuredDeflection,
    PairedShape,
    PairedShapes,
    WireShape,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary, Kind
from pantocheck.model.description.catenary import Wire

LISTED_GROUPS = (1, 2)
"""Groups of span modes whose shapes are listed."""

LISTED_MODES = 12
"""Largest number of listed modes of a group."""

SHAPE_POINTS = 181
"""Points of a computed shape along its wire: thirty per span of a line of six spans."""

SHAPE_WIRES = ("CW", "MW")
"""Wires whose shapes are listed, by their names in mass-drop records."""


def list_paired_shapes(matched: MatchedModes, line: Catenary) -> PairedShapes:
    """Shapes of the matched modes of the first groups that have at least two sensors, in the order of frequency.

    A computed shape is scaled to its largest deflection. The measured values are multiplied by the complex factor that
    fits them best to it; their real part is listed.
    """
    positions = find_sensor_positions(matched.paired, line, "the modes")
    wires = _select_wires(line)
    shapes: list[PairedShape] = []
    for pair, mode in zip(matched.pairs, matched.paired, strict=True):
        listed = sum(shape.group == mode.group for shape in shapes)
        if mode.group in LISTED_GROUPS and listed < LISTED_MODES and len(_list_sensors(mode, positions)) > 1:
            deflection = matched.shapes.shape[pair.computed, :, :, 0]
            curves = [_compute_curve(matched, deflection, name, wire) for name, wire in wires]
            scale = max(max(map(abs, curve.value)) for curve in curves)
            shapes.append(
                PairedShape(
                    measured_Hz=mode.frequency_Hz,
                    group=mode.group,
                    mac=pair.mac,
                    sensors=_scale_measured(matched, mode, positions, deflection / scale),
                    curves=tuple(_scale_curve(curve, scale) for curve in curves),
                )
            )
    ends = {x for wire in line.wires if wire.kind is Kind.CONTACT_WIRE for x in (wire.start, wire.end)}
    supports = ends | {support.position for support in line.messenger_supports}
    return PairedShapes(supports_m=tuple(sorted(supports)), modes=tuple(shapes))


def _list_sensors(mode: Mode, positions: Positions) -> list[tuple[str, float, complex]]:
    """Wire, position [m] and component of each sensor of a mode on the line."""
    return [
        (sensor.wire, sensor.position_m, complex(sensor.re, sensor.im))
        for sensor in mode.sensor_shape
        if sensor.position_m is not None and (sensor.wire, sensor.position_m) in positions
    ]


def _select_wires(line: Catenary) -> list[tuple[str, Wire]]:
    """Contact and messenger wires with their names in records; one of parallel wires."""
    wires: dict[tuple[str, float, float], Wire] = {}
    for name in SHAPE_WIRES:
        for wire in (wire for wire in line.wires if wire.kind is KIND_OF_WIRE[name]):
            wires.setdefault((name, wire.start, wire.end), wire)
    return [(name, wire) for (name, _, _), wire in wires.items()]


def _compute_curve(matched: MatchedModes, deflection: RealArray, name: str, wire: Wire) -> WireShape:
    mesh = matched.mesh.mesh
    grid = np.linspace(wire.start, wire.end, SHAPE_POINTS)
    values = np.interp(grid, mesh.position, deflection[mesh.row_of[wire.name, "z"]])
    return WireShape(wire=name, position_m=_round(grid), value=tuple(values))


def _scale_curve(curve: WireShape, scale: float) -> WireShape:
    return curve.model_copy(update={"value": _round(np.array(curve.value) / scale)})


def _scale_measured(
    matched: MatchedModes, mode: Mode, positions: Positions, deflection: RealArray
) -> tuple[MeasuredDeflection, ...]:
    """Real part of the measured shape times the complex factor that fits it to the computed deflection."""
    mesh, sensors = matched.mesh.mesh, _list_sensors(mode, positions)
    measured = np.array([component for _, _, component in sensors])
    computed = np.array([deflection[mesh.row_of[positions[name, x], "z"], mesh.station(x)] for name, x, _ in sensors])
    values = (np.vdot(measured, computed) / np.vdot(measured, measured) * measured).real
    return tuple(
        MeasuredDeflection(wire=name, position_m=x, value=float(value))
        for (name, x, _), value in zip(sensors, values, strict=True)
    )


def _round(values: RealArray) -> tuple[float, ...]:
    """Values with five significant digits, for a figure."""
    return tuple(float(f"{value:.5g}") for value in values)
