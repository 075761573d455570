"""Moving pictures of identified mode shapes at the sensors, each with its own frequency and decay."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.core.figure_data import (
    DrawnCurve,
    DrawnDroppers,
    DrawnPoint,
    DrawnSymbol,
    DrawnView,
    LineShape,
)
from pantocheck.conformance.pages.shape_figure import list_supports
from pantocheck.conformance.pages.words import format_percent, format_value
from pantocheck.conformance.results.identification_format import IdentifiedLine
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.motion_format import LineScene, MovingWire, PassageMotion, code_field

PERIODS, FRAMES_PER_PERIOD = 10, 24
"""Length of a picture, and its frames in a period."""

MOST_SHAPES = 60
"""Largest number of mode shapes of a line, by frequency."""

LARGEST_MM = 100.0
"""Drawn rise of the largest component of a shape at the start: the sensors read it in percent."""

HEIGHTS = {"MW": ("messenger_wire", 1.2), "CW": ("contact_wire", 0.0)}
"""Kind and drawn height of a wire [m]; the heights are schematic."""

LONE_M = 2.0
"""Half the drawn length of a wire with a single sensor."""


def build_mode_scene(line: IdentifiedLine) -> LineScene | None:
    """Moving pictures of the certain vertical modes of a line at the sensors with a position; None: there are none.

    The wires are straight between the sensors: a record knows no more of them.
    """
    modes = [mode for mode in line.modes if mode.certain and not mode.lateral and _list_wires(mode)][:MOST_SHAPES]
    places = sorted({(wire, x) for mode in modes for wire, rows in _list_wires(mode).items() for x, _ in rows})
    supports = list_supports(line.spans_m)
    if not modes or len(supports) < 2:
        return None
    ends = (supports[0], supports[-1])
    wires = [wire for wire in HEIGHTS if any(wire == known for known, _ in places)]
    curves = [DrawnCurve(kind=HEIGHTS[wire][0], x_m=[*ends], y_m=[HEIGHTS[wire][1]] * 2) for wire in wires]
    points = [DrawnPoint(symbol="sensor", x_m=x, y_m=HEIGHTS[wire][1], text=f"{wire} {x:g} m") for wire, x in places]
    none = DrawnDroppers(x_m=[], lower_m=[], upper_m=[])
    shape = LineShape(
        title="",
        first_span=1,
        last_span=len(supports) - 1,
        supports_m=supports,
        side=DrawnView(curves=curves, droppers=none, points=points),
        plan=None,
        symbols=[DrawnSymbol(name="sensor", marker="s")],
    )
    return LineScene(
        id=line.records[0].name,
        label="shape [%]",
        line_shape=shape,
        names=[_name_mode(mode) for mode in modes],
        motions=[_move_mode(mode, wires) for mode in modes],
        speed=1,
        gain=5,
    )


def _name_mode(mode: Mode) -> str:
    group = "" if mode.group is None else f", group {mode.group}"
    return f"{format_value(mode.frequency_Hz, 4)} Hz, ζ {format_percent(mode.damping_ratio)} %{group}"


def _list_wires(mode: Mode) -> dict[str, list[tuple[float, complex]]]:
    """Positions [m] and components of a shape on each wire with a known position, along the line."""
    found: dict[str, dict[float, complex]] = {}
    for part in mode.sensor_shape:
        if part.position_m is not None and part.wire in HEIGHTS:
            found.setdefault(part.wire, {}).setdefault(part.position_m, complex(part.re, part.im))
    return {wire: sorted(rows.items()) for wire, rows in found.items()}


def _move_mode(mode: Mode, wires: Sequence[str]) -> PassageMotion:
    """Free decay of a mode from its largest component, at its sensors."""
    step = 1 / (FRAMES_PER_PERIOD * mode.frequency_Hz)
    phase = 2 * np.pi * np.arange(PERIODS * FRAMES_PER_PERIOD + 1) / FRAMES_PER_PERIOD
    decay = np.exp((1j * np.sqrt(1 - mode.damping_ratio**2) - mode.damping_ratio) * phase)
    moving = []
    for wire, rows in _list_wires(mode).items():
        x, value = [place for place, _ in rows], np.array([part for _, part in rows])
        if len(x) == 1:
            x, value = [x[0] - LONE_M, x[0] + LONE_M], np.repeat(value, 2)
        rise = LARGEST_MM * np.real(decay[:, None] * value)
        moving.append(MovingWire(curve=wires.index(wire), x_m=x, rise_mm=code_field(rise, 0.1)))
    return PassageMotion(
        start_s=0,
        step_s=float(f"{step:.6g}"),
        speed_m_s=0,
        wires=moving,
        dropper_m=[],
        slack=None,
        pantographs=[],
        error_mm=None,
    )
