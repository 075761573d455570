"""Moving picture of a passage: the static figure that stands for it on paper and without scripts."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from pantocheck.conformance.core.figure_data import LineShape
from pantocheck.conformance.core.figure_style import CURVES, FULL, GREY, INK, PALE, SHADES
from pantocheck.conformance.core.panel_figure import PanelFigure, write_svg
from pantocheck.conformance.core.panel_marks import LineStyle
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.fixed_panels import PanelGrid, lay_panels
from pantocheck.conformance.pages.line_figure import WIRE_WIDTHS
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.motion_format import PassageMotion
from pantocheck.conformance.results.results_format import CaseResult

ENLARGED = 5
"""Enlargement of the motion over the heights in the static figure."""

ILLUSTRATION = "Illustration: no value and no verdict follows from it."


def draw_passage(case: CaseResult, number: int, anchor: str) -> Iterator[doc.Figure]:
    """Picture of the passage at its smallest force, which a script replaces; none without a moving picture.

    `number` is the index of the case in the results, `anchor` that of the section of the case.
    """
    motion, shape, section = case.motion, case.line_shape, case.run.evaluated_m
    if motion is None or shape is None or section is None:
        return
    owner, frame, force = _find_smallest(motion, section)
    time = motion.start_s + frame * motion.step_s
    caption = (
        f"Passage at {time:.3f} s, with the smallest force up to 20 Hz: {format_value(force)} N, pantograph {owner}."
        f" Motion {ENLARGED} times enlarged over the heights. {ILLUSTRATION}"
    )
    place = motion.pantographs[owner - 1].start_m + motion.speed_m_s * (time - motion.start_s)
    alternative = f"{caption} Pantograph {owner} is at {format_plain(round(place, 1))} m."
    curves = doc.Curves("passage", number)
    yield doc.Figure(
        draw_instant(motion, shape, section, frame), alternative, caption, anchor=f"{anchor}-passage", curves=curves
    )


def _find_smallest(motion: PassageMotion, section: tuple[float, float]) -> tuple[int, int, float]:
    """Pantograph, frame and value [N] of the smallest force in the analysis section [m]."""
    found = (1, 0, math.inf)
    for owner, part in enumerate(motion.pantographs, 1):
        force = part.force_N.decode()[:, 0]
        place = part.start_m + motion.speed_m_s * motion.step_s * np.arange(force.size)
        inside = np.flatnonzero((place >= section[0]) & (place < section[1]))
        if inside.size and force[inside].min() < found[2]:
            frame = int(inside[force[inside].argmin()])
            found = (owner, frame, float(force[frame]))
    return found


@write_svg
def draw_instant(
    motion: PassageMotion,
    shape: LineShape,
    section: tuple[float, float],
    frame: int,
    others: Sequence[PassageMotion] = (),
) -> PanelFigure:
    """Wires in one frame over their shape at rest, the places of the pantographs, and dashed wires of other passages.

    The first pantograph of another passage is where that of the first one is.
    """
    figure, [[axes]] = lay_panels(PanelGrid(FULL, 1.1, right=0.2))
    axes.axvspan(*section, PALE)
    droppers = shape.side.droppers
    axes.vlines(droppers.x_m, droppers.lower_m, droppers.upper_m, LineStyle(GREY, 0.5))
    for wire in motion.wires:
        curve, x = shape.side.curves[wire.curve], np.array(wire.x_m)
        rise = wire.rise_mm.decode()[frame] / 1000
        axes.plot(curve.x_m, curve.y_m, LineStyle(SHADES[2], 0.6))
        height = np.interp(x, curve.x_m, curve.y_m) + ENLARGED * rise
        axes.plot(x, height, LineStyle(INK, WIRE_WIDTHS[curve.kind]))
    for other, colour in zip(others, CURVES[1:], strict=False):
        for wire in other.wires:
            curve, x, field = shape.side.curves[wire.curve], np.array(wire.x_m), wire.rise_mm.decode()
            rise = field[_align_frame(motion, frame, other)] / 1000
            height = np.interp(x, curve.x_m, curve.y_m) + ENLARGED * rise
            axes.plot(x, height, LineStyle(colour, WIRE_WIDTHS[curve.kind], "--"))
    low = axes.y_scale.find_ends()[0]
    for owner, part in enumerate(motion.pantographs, 1):
        place = part.start_m + motion.speed_m_s * motion.step_s * frame
        if shape.supports_m[0] <= place <= shape.supports_m[-1]:
            axes.plot([place], [low], LineStyle(INK, linestyle="", marker="^", markersize=6), is_clipped=False)
            axes.text(place, low, str(owner), shift=(6, 2))
    axes.x_scale.limits = (shape.supports_m[0], shape.supports_m[-1])
    axes.name_axes("position along the line [m]", "height [m]")
    return figure


def _align_frame(motion: PassageMotion, frame: int, other: PassageMotion) -> int:
    """Frame of another passage in which its first pantograph is where that of the first passage is."""
    place = motion.pantographs[0].start_m + motion.speed_m_s * motion.step_s * frame
    frame = round((place - other.pantographs[0].start_m) / (other.speed_m_s * other.step_s))
    return min(max(frame, 0), other.wires[0].rise_mm.frames - 1)
