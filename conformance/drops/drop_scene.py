"""Moving picture of a mass drop of a case: the mass hangs, its release sends waves along the line, these decay."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.figure_data import DrawnPoint, DrawnSymbol, LineShape
from pantocheck.conformance.drops.drop_simulation import SHORT_NAME, build_drop_setup, require_mass_drop
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_shape import build_line_shape
from pantocheck.conformance.results.motion_format import LineScene, PassageMotion
from pantocheck.conformance.runs.case_run import integrate_mass_drop
from pantocheck.conformance.runs.passage_motion import (
    CodedForm,
    choose_stretch,
    code_line,
    space_frames,
    take_small_form,
)
from pantocheck.model.dynamics.mass_drop import discretise_drop

BEFORE_S, AFTER_S = 0.2, 10.0
"""Shown time before and after the release."""

SYMBOLS = [DrawnSymbol(name="sensor", marker="s"), DrawnSymbol(name="mass", marker="o")]


def build_drop_scene(case: Case, number: int) -> LineScene | None:
    """Moving picture of a drop of a case on its line.

    Args:
        case: Case with a mass drop.
        number: Number of the drop, from 1.

    Returns:
        Picture; None if no form is small enough, or if the demanded kernel takes no frames.

    Raises:
        NoInitialState, NoEquilibrium, DidNotConverge: The simulation has no solution.
    """
    discretisation, catenary = case.file.discretisation, build_catenary(case.line)
    setup = replace(build_drop_setup(case, number, catenary), hanging=BEFORE_S, duration=AFTER_S)
    line = discretise_drop(catenary, discretisation.element_m, setup)
    shape, step = build_line_shape(case.line, case.analysed_spans, line), discretisation.time_step_s
    stretch = choose_stretch(line, shape, space_frames(1, round((BEFORE_S + AFTER_S) / step), step))
    decay = integrate_mass_drop(catenary, discretisation.element_m, replace(setup, frames=stretch.request))
    frames, times = decay.frames, decay.time[np.array(stretch.request.steps) - 1]
    if frames is None:
        return None

    def code_motion(form: CodedForm) -> PassageMotion:
        start, second = times[0], times[form.nth_frame]
        coded = vars(code_line(line, stretch, frames, form))
        step_s = round(float(second - start), 9)
        return PassageMotion(start_s=round(float(start), 6), step_s=step_s, speed_m_s=0, pantographs=[], **coded)

    motion = take_small_form(code_motion)
    if motion is None:
        return None
    drop = require_mass_drop(case).drop[number - 1]
    name = f"{drop.mass_kg:g} kg, {SHORT_NAME[drop.wire]} {drop.x_m:g} m"
    return LineScene(
        id=f"{case.id} drop {number}",
        label="rise [mm]",
        line_shape=_mark_places(shape, case, number),
        names=[name],
        motions=[motion],
        speed=0.1,
        gain=2,
    )


def _mark_places(shape: LineShape, case: Case, number: int) -> LineShape:
    """Shape with the sensors and the mass of a drop in the side view."""
    mass_drop = require_mass_drop(case)
    drop = mass_drop.drop[number - 1]
    places = [("mass", drop.wire, drop.x_m, f"{drop.mass_kg:g} kg")]
    places += [
        ("sensor", sensor.wire, sensor.x_m, f"{SHORT_NAME[sensor.wire]} {sensor.x_m:g} m")
        for sensor in mass_drop.sensor
    ]
    points = [
        DrawnPoint(symbol=symbol, x_m=x, y_m=float(np.interp(x, curve.x_m, curve.y_m)), text=text)
        for symbol, wire, x, text in places
        for curve in shape.side.curves
        if curve.kind == wire and curve.x_m[0] <= x <= curve.x_m[-1]
    ]
    side = shape.side.model_copy(update={"points": [*shape.side.points, *points]})
    return shape.model_copy(update={"side": side, "symbols": [*shape.symbols, *SYMBOLS]})
