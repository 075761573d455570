"""Moving picture of a passage from the shapes of the wires that a program delivered beside its record."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import DrawnCurve, LineShape
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_shape import build_line_shape
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.wire_shapes import WireShapes, read_wire_shapes
from pantocheck.conformance.results.motion_format import MovingPantograph, MovingWire, PassageMotion, code_field
from pantocheck.conformance.runs.passage_motion import CodedForm, Samples, code_pantograph, code_wire, take_small_form

PlacedWires = list[tuple[int, DrawnCurve, RealArray, RealArray]]
"""Index and curve of wires in the drawn line, with positions and rises."""


@dataclass(frozen=True)
class DeliveredMotion:
    """Line at rest, and the picture of the passage over it; None: no form of the picture is small enough."""

    line_shape: LineShape
    motion: PassageMotion | None


def build_delivered_motion(case: Case, record: Record, path: Path) -> DeliveredMotion:
    """Moving picture of a delivered passage over the line of its case at rest.

    Args:
        case: Case with a speed.
        record: Delivered record.
        path: Delivered file of shapes.

    Raises:
        InputError: The file is damaged, or does not fit the record or the line.
    """
    shapes = read_wire_shapes(path)
    shape = build_line_shape(
        case.line, case.analysed_spans, discretise_line(case.line, case.file.discretisation.element_m)
    )
    where, span = f"shapes '{path.name}'", record.time[[0, -1]]
    if shapes.time[0] < span[0] - 0.5 / record.rate or shapes.time[-1] > span[1] + 0.5 / record.rate:
        raise InputError(
            f"{where}, data set time_s",
            f"found frames from {shapes.time[0]:g} s to {shapes.time[-1]:g} s",
            f"Give frames from {span[0]:g} s to {span[1]:g} s, the time of the record.",
        )
    samples = np.rint((shapes.time - record.time[0]) * record.rate).astype(np.intp).clip(0, record.time.size - 1)
    place = record.position[:, samples]
    passing = np.flatnonzero(((place >= shape.supports_m[0]) & (place <= shape.supports_m[-1])).any(0))
    if passing.size < 2:
        raise InputError(where, "no pantograph is on the drawn line in two frames", "Give frames of the passage.")
    shown = slice(int(passing[0]), int(passing[-1]) + 1)
    shapes, at = shapes.select(shown), samples[shown]
    wires = _place_wires(shape, shapes, where)
    motion = take_small_form(lambda form: _code_motion(case, record, shapes, wires, at, form))
    return DeliveredMotion(shape, motion)


def _place_wires(shape: LineShape, shapes: WireShapes, where: str) -> PlacedWires:
    """Index and curve of each delivered wire in the drawn line, with its positions and rises there."""
    placed = []
    for (kind, number), (place, rise) in shapes.wires.items():
        curves = [(index, curve) for index, curve in enumerate(shape.side.curves) if curve.kind == kind]
        curves.sort(key=lambda found: found[1].x_m[0])
        if number > len(curves):
            name = kind.replace("_", " ")
            raise InputError(where, f"has the {name} {number}, the drawn line has {len(curves)}", "Leave it out.")
        index, curve = curves[number - 1]
        inside = (place >= curve.x_m[0] - 1e-6) & (place <= curve.x_m[-1] + 1e-6)
        if inside.sum() < 2:
            raise InputError(
                f"{where}, {kind.replace('_', ' ')} {number}",
                f"has no points from {curve.x_m[0]:g} m to {curve.x_m[-1]:g} m",
                "Give its shape near the analysis section.",
            )
        placed.append((index, curve, place[inside], rise[:, inside]))
    return placed


def _code_motion(
    case: Case,
    record: Record,
    shapes: WireShapes,
    wires: PlacedWires,
    at: Samples,
    form: CodedForm,
) -> PassageMotion:
    """Code a picture in one form; `at` are the samples of the record at the frames."""
    coded: list[MovingWire] = []
    errors = []
    for index, _, place, rise in wires:
        wire, error = code_wire(index, place, rise, form)
        coded.append(wire)
        errors.append(error)
    nth, samples = form.nth_frame, at[:: form.nth_frame]
    return PassageMotion(
        start_s=round(float(shapes.time[0]), 6),
        step_s=round(float(nth * np.diff(shapes.time).mean()), 9),
        speed_m_s=case.speed,
        wires=coded,
        dropper_m=[] if shapes.slack is None else [round(float(place), 2) for place in shapes.slack[0]],
        slack=None if shapes.slack is None else code_field(shapes.slack[1][::nth], 1.0),
        pantographs=_code_pantographs(case, record, wires, samples, nth),
        error_mm=float(f"{max(errors):.2g}"),
    )


def _code_pantographs(
    case: Case,
    record: Record,
    wires: PlacedWires,
    samples: Samples,
    nth: int,
) -> list[MovingPantograph]:
    """Heads and forces of the pantographs; a head without a recorded height is at the contact wire."""
    parts = []
    for number, signals in RecordSignals(record, case.file.filter).pantographs.items():
        heights = None if record.contact_height is None else record.contact_height[number - 1, samples][:, None]
        if heights is None:
            place = record.position[number - 1, samples]
            heights = _find_wire(wires, place, nth)[:, None]
        parts.append(code_pantograph(number, signals, record, samples, (), heights))
    return parts


def _find_wire(wires: PlacedWires, place: RealArray, nth: int) -> RealArray:
    """Height of the first contact wire at a place in each frame [m]."""
    _, curve, x, rise = next((wire for wire in wires if wire[1].kind == "contact_wire"), wires[0])
    lifts = [np.interp(p, x, row) for p, row in zip(place, rise[::nth], strict=True)]
    return np.asarray(np.interp(place, curve.x_m, curve.y_m) + np.array(lifts))
