"""Drawing of a line at rest: side view and plan view."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.geometry import Geometry
from pantocheck.conformance.reports.figures.figure_style import FULL, GREY, INK, render_svg
from pantocheck.model import DiscretisedLine, Kind, Wire

EXAGGERATED = 10
"""Scale of heights and lateral positions relative to lengths along the track."""
WIDTHS = {Kind.CONTACT_WIRE: 1.8, Kind.MESSENGER_WIRE: 1.2, Kind.STITCH_WIRE: 0.9}


@render_svg
def draw_line(line: DiscretisedLine, title: str, geometry: Geometry) -> Figure:
    """Side view and plan view of two spans and half a span on either side.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    title : str
        Title of the figure.
    geometry : Geometry
        Spans of the line.
    """
    before = round(geometry.spans / 2)
    first, last = before - 1, before + 2
    shown = (
        geometry.mid_span(first) if first >= 1 else 0.0,
        geometry.mid_span(last) if last <= geometry.spans else geometry.length,
    )
    labelled = geometry.span(min(before + 1, geometry.spans))
    lateral = line.catenary.has_lateral_field
    figure = Figure(figsize=(FULL, 3.6 if lateral else 2.4))
    axes = figure.subplots(2 if lateral else 1, 1, sharex=True, squeeze=False)[:, 0]
    _view(axes[0], line, "z", shown, labelled)
    axes[0].set_ylabel("height [m]")
    axes[0].set_title(f"{title}: side view", fontsize=8, loc="left")
    if lateral:
        _view(axes[1], line, "y", shown, labelled)
        axes[1].set_ylabel("lateral [m]")
        axes[1].set_title("plan view", fontsize=8, loc="left")
    axes[-1].set_xlabel(f"along the track [m]; heights and lateral positions {EXAGGERATED} times enlarged")
    return figure


def _view(
    axes: Axes, line: DiscretisedLine, field: str, shown: tuple[float, float], labelled: tuple[float, float]
) -> None:
    start, end = shown
    for wire in line.catenary.wires:
        if wire.end < start or end < wire.start:
            continue
        x, w = _shape(line, wire, field)
        axes.plot(x, w, color=INK, linewidth=WIDTHS[wire.kind])
    for n, dropper in enumerate(line.catenary.droppers):
        if not start <= dropper.position <= end:
            continue
        ends = [_deflection(line, name, field, dropper.position) for name in (dropper.lower, dropper.upper)]
        axes.plot([dropper.position] * 2, ends, color=GREY, linewidth=0.8)
        if field == "z" and labelled[0] <= dropper.position < labelled[1]:
            length = f"{line.state.dropper_length[n]:.3f}"
            axes.annotate(length, (dropper.position, sum(ends) / 2), fontsize=5, rotation=90, ha="right", va="center")
    for support in line.catenary.messenger_supports:
        if not start <= support.position <= end:
            continue
        axes.plot(support.position, _deflection(line, support.wire, field, support.position), "^", color=INK)
    for arm, force in zip(line.catenary.steady_arms, line.state.arm_force, strict=True):
        if not start <= arm.position <= end:
            continue
        claw = _deflection(line, arm.wire, field, arm.position)
        axes.plot(arm.position, claw, "o", color=INK, markersize=3, markerfacecolor="white")
        if field == "y" and force[0] != 0.0 and arm.length is not None:
            # An arm that pulls has its hinge on the side of its force; an arm that pushes, on the other side.
            towards = np.sign(force[0]) * (1 if arm.acts == "pull" else -1)
            axes.plot([arm.position] * 2, [claw, claw + towards * arm.length], color=INK, linewidth=1.0)
    axes.set_xlim(start, end)
    axes.set_aspect(EXAGGERATED, adjustable="datalim" if field == "y" else "box")


def _shape(line: DiscretisedLine, wire: Wire, field: str) -> tuple[RealArray, RealArray]:
    inside = (line.mesh.position >= wire.start - 1e-6) & (line.mesh.position <= wire.end + 1e-6)
    return line.mesh.position[inside], line.state.deflection[line.mesh.row_of[wire.name, field], inside, 0]


def _deflection(line: DiscretisedLine, wire: str, field: str, position: float) -> float:
    return float(line.state.deflection[line.mesh.row_of[wire, field], line.mesh.station(position), 0])
