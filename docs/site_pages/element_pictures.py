"""Drawings of the elements of a line for the page on the theory."""

from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.figure_style import CURVES, FULL, GREY, HALF, INK, render_svg
from pantocheck.conformance.core.look import read_look
from site_pages.sketches import start_sketch

WIRE = {"color": INK, "linewidth": 1.6}
THIN = {"color": INK, "linewidth": 0.9}
ARROW = {"arrowstyle": "-|>", "color": CURVES[1], "linewidth": 1.1}


def write_element_pictures(folder: Path) -> None:
    """Write one picture for each element."""
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (
        *(draw_wire, draw_dropper, draw_stitch_wire, draw_steady_arm, draw_messenger_support),
        *(draw_point_mass, draw_wire_spring, draw_overlap, draw_curve, draw_cant),
    ):
        (folder / f"{draw.__name__.removeprefix('draw_').replace('_', '-')}.svg").write_text(draw(), "utf-8")


def _start(title: str) -> tuple[Any, Any]:
    figure, axes = start_sketch(HALF, 1.7, 10, 5)
    axes.text(0.2, 4.7, title, fontsize=9, weight="bold", va="center")
    return figure, axes


def _draw_symbol(axes: Any, name: str, x: float, below: float, half_width: float, length: float) -> None:
    """Symbol of the look: mass, spring or damper."""
    for line in read_look()["symbol"][name]:
        across, along = np.transpose(line)
        axes.plot(x + half_width * across, below + length * along, **THIN)


def _messenger(axes: Any, sag: float = 0.5) -> Any:
    x = np.linspace(0.3, 9.7, 60)
    axes.plot(x, 3.9 - sag + sag * ((x - 5) / 4.7) ** 2, **WIRE)
    axes.text(9.7, 4.1, "messenger wire", ha="right", fontsize=7)


def _contact(axes: Any, height: float = 1.0) -> None:
    axes.plot([0.3, 9.7], [height, height], **WIRE)
    axes.text(9.7, height - 0.55, "contact wire", ha="right", fontsize=7)


def _point(axes: Any, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """Arrow with the text at its end."""
    axes.annotate("", end, start, arrowprops=ARROW)
    axes.text(end[0] + 0.15, end[1], text, fontsize=8, va="center", color=CURVES[1])


def _link(axes: Any, x: float, below: float, above: float, text: str) -> None:
    """Spring and damper side by side between two heights."""
    middle, length = (below + above) / 2, 0.9
    for shift, name, letter in ((-0.35, "spring", "k"), (0.35, "damper", "c")):
        _draw_symbol(axes, name, x + shift, middle - length / 2, 0.16, length)
        axes.text(x + shift + (-0.3 if shift < 0 else 0.3), middle, letter, fontsize=8, ha="center", va="center")
    for height, end in ((middle - length / 2, below), (middle + length / 2, above)):
        axes.plot([x - 0.35, x + 0.35], [height, height], **THIN)
        axes.plot([x, x], [height, end], **THIN)
    axes.text(x + 1.0, middle + 0.05, text, fontsize=7.5, va="center")


@render_svg
def draw_wire() -> Any:
    """Element of a wire with its unknowns."""
    figure, axes = _start("Wire: beam element with tension")
    s = np.linspace(0, 1, 40)
    w1, w2, slope = 0.6, 1.3, 1.6
    shape = w1 + (w2 - w1) * (3 * s**2 - 2 * s**3) + slope * s * (1 - s) ** 2
    axes.plot(2 + 6 * s, 1.2 + shape, **WIRE)
    axes.plot([1, 9], [1.2, 1.2], color=GREY, linewidth=0.7, linestyle=":")
    for x, w, name in ((2, w1, "1"), (8, w2, "2")):
        axes.annotate("", (x, 1.2 + w), (x, 1.2), arrowprops=ARROW)
        text = f"w{name}, r{name}".translate(str.maketrans("12", "₁₂"))
        axes.text(x + 0.2, 1.5, text, fontsize=8, color=CURVES[1])
    _point(axes, (2, 1.2 + w1), (0.6, 1.2 + w1 - 0.35), "")
    _point(axes, (8, 1.2 + w2), (9.4, 1.2 + w2), "")
    axes.text(0.4, 2.1, "T", fontsize=9, color=CURVES[1])
    axes.text(9.2, 2.9, "T", fontsize=9, color=CURVES[1])
    axes.text(5, 3.6, "EI, m", fontsize=8, ha="center")
    axes.annotate("", (8, 0.6), (2, 0.6), arrowprops={"arrowstyle": "<->", "color": GREY})
    axes.text(5, 0.15, "h", fontsize=8, ha="center")
    return figure


@render_svg
def draw_dropper() -> Any:
    """Taut and slack dropper."""
    figure, axes = _start("Dropper: pulls, cannot push")
    _messenger(axes)
    _contact(axes)
    _link(axes, 2.3, 1.0, 3.6, "N = N₀ + k d + c ḋ > 0")
    y = np.linspace(1.0, 3.5, 40)
    axes.plot(7.6 + 0.35 * np.sin(np.pi * (y - 1) / 2.5), y, color=CURVES[1], linewidth=1.2)
    axes.text(8.15, 2.2, "slack:\nN = 0", fontsize=7.5, va="center", color=CURVES[1])
    return figure


@render_svg
def draw_stitch_wire() -> Any:
    """Stitch wire at a support of the stitched line of the library, as computed at rest."""
    from pantocheck.conformance import open_case

    figure, axes = _plot_line("Stitch wire: carries the droppers at a support", HALF)
    line = open_case("en50318-2018/ac-stitched/static").line
    line.plot(5, 6, axes=axes)
    middle = float(line.span_limits[5])
    axes.set(title="", xlabel="", ylabel="", xlim=(middle - 25, middle + 25))
    return figure


def _plot_line(title: str, width: float) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, 1.7))
    figure.set_layout_engine("none")
    figure.text(0.02, 0.94, title, fontsize=9, weight="bold", va="center")
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.84))
    axes.set_axis_off()
    return figure, axes


@render_svg
def draw_overlap() -> Any:
    """Overlap of two tension sections, as computed at rest."""
    from pantocheck.conformance import open_case

    sections = [{"spans": 6}, {"spans": 6}]
    changes = {"line.geometry.spans": 9, "line.section": sections}
    case = open_case("en50318-2002/300").with_(
        changes | {"line.overlap": {"spans": 3, "anchor_rise_m": 0.5}}, evaluated_spans=[4, 5]
    )
    figure, axes = _plot_line("Tension sections: overlap of three spans between the anchors (◇)", FULL)
    case.line.plot(3, 7, axes=axes)
    axes.set(title="", xlabel="", ylabel="")
    return figure


@render_svg
def draw_steady_arm() -> Any:
    """Steady arm across the track."""
    figure, axes = _start("Steady arm: hinged, holds the stagger")
    axes.plot([1.6, 1.6], [0.4, 4.2], color=GREY, linewidth=3)
    axes.plot([1.6, 3.2], [3.4, 3.4], **THIN)
    axes.plot([3.2, 6.2], [3.2, 1.6], color=CURVES[0], linewidth=2)
    axes.plot([3.2], [3.2], "o", color=INK, markersize=4, markerfacecolor="white")
    axes.plot([6.2], [1.6], "o", color=INK, markersize=7)
    _point(axes, (6.2, 1.6), (8.2, 1.6), "force")
    axes.annotate("", (5.6, 2.95), (3.6, 3.95), arrowprops={"arrowstyle": "<->", "color": GREY})
    axes.text(4.9, 3.65, "ℓ, mass per length", fontsize=7.5)
    axes.text(6.2, 0.85, "contact wire with clamp; k = force / ℓ vertically", ha="center", fontsize=7)
    return figure


@render_svg
def draw_messenger_support() -> Any:
    """Support of the messenger wire."""
    figure, axes = _start("Messenger support: spring and damper")
    x = np.linspace(0.3, 9.7, 60)
    axes.plot(x, 3.6 - 0.9 * np.abs((x - 5) / 4.7) ** 1.3, **WIRE)
    axes.text(9.6, 3.2, "messenger wire", ha="right", fontsize=7)
    _link(axes, 5, 0.9, 3.55, "")
    axes.plot([4.2, 5.8], [0.9, 0.9], **WIRE)
    axes.text(5, 0.35, "mast", ha="center", fontsize=7.5)
    return figure


@render_svg
def draw_point_mass() -> Any:
    """Point mass on the contact wire."""
    figure, axes = _start("Point mass: clamp, insulator")
    _messenger(axes)
    _contact(axes, 1.6)
    _draw_symbol(axes, "mass", 5, 1.05, 0.6, 1.1)
    axes.text(5, 2.4, "m", ha="center", fontsize=8)
    _point(axes, (5, 1.05), (5, 0.2), "m g")
    return figure


@render_svg
def draw_wire_spring() -> Any:
    """Spring between the wires."""
    figure, axes = _start("Spring between wires: both directions")
    _messenger(axes)
    _contact(axes)
    _link(axes, 4.2, 1.0, 3.45, "force 0 at rest")
    return figure


@render_svg
def draw_curve() -> Any:
    """Plan of a curve: the wires are chords of the track."""
    figure, axes = _start("Curve in plan: chords with stagger")
    angles = np.linspace(-0.62, 0.62, 80)
    axes.plot(5 + 7.5 * np.sin(angles), -4.4 + 7.5 * np.cos(angles), color=GREY, linestyle="--", linewidth=1)
    supports = np.linspace(-0.6, 0.6, 5)
    x, y = 5 + 7.85 * np.sin(supports), -4.4 + 7.85 * np.cos(supports)
    axes.plot(x, y, **WIRE)
    axes.plot(x, y, "o", color=INK, markersize=4)
    axes.text(5, 2.35, "track, radius R", ha="center", fontsize=7.5, color=GREY)
    axes.text(5, 3.85, "wire: load T / R", ha="center", fontsize=7.5)
    return figure


@render_svg
def draw_cant() -> Any:
    """Section across a canted track."""
    figure, axes = _start("Cant: the pantograph leans inwards")
    angle = 0.16
    axis, across = np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
    foot = np.array([5.0, 0.6])
    for start, end, style in (
        (foot - 1.5 * across, foot + 1.5 * across, WIRE),
        (foot, foot + 3.1 * axis, {"color": CURVES[0], "linewidth": 1.3}),
        (foot + 3.1 * axis - 1.2 * across, foot + 3.1 * axis + 1.2 * across, {"color": CURVES[0], "linewidth": 2.2}),
    ):
        axes.plot(*np.transpose([start, end]), **style)
    axes.plot([5, 5], [0.6, 4.2], color=GREY, linestyle=":", linewidth=1)
    axes.plot([4.7], [3.78], "o", color=INK, markersize=6)
    axes.text(5.0, 4.05, "contact wire", fontsize=7.5)
    axes.text(6.8, 0.95, "rails", fontsize=7.5)
    axes.text(2.2, 3.1, "height × cant / gauge", fontsize=7.5, ha="center")
    return figure
