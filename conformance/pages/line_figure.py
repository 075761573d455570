"""Drawings of the inputs of a case: its line at rest, in side and plan view, and the schemes of its pantographs."""

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.figure_data import DrawnSymbol, DrawnView, LineShape
from pantocheck.conformance.core.figure_style import FULL, GREY, HALF, INK, PALE
from pantocheck.conformance.core.panel_figure import Panel, PanelFigure, draw_symbol, write_svg
from pantocheck.conformance.core.panel_marks import LineStyle
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.condition_sections import SPRINGLESS
from pantocheck.conformance.pages.fixed_panels import PanelGrid, lay_panels
from pantocheck.conformance.pages.words import format_plain
from pantocheck.conformance.results.case_facts_format import StoredValue, StoredValues
from pantocheck.conformance.results.results_format import CaseResult

WIRE_WIDTHS = {"contact_wire": 1.4, "messenger_wire": 0.9, "stitch_wire": 0.6}

MOST_LABELLED = 14
"""Largest number of supports whose positions have room below the axis; of more, every second one is written."""


@write_svg
def draw_line_shape(shape: LineShape, section: tuple[float, float] | None) -> PanelFigure:
    """Draw a line at rest, with the analysis section [m] on a grey ground."""
    views = [("height [m]", shape.side)] + ([] if shape.plan is None else [("y [m]", shape.plan)])
    figure, panels = lay_panels(PanelGrid(FULL, 1.0, rows=len(views), right=0.2, between_rows=0.12))
    symbols = {symbol.name: _choose_marker(symbol) for symbol in shape.symbols}
    supports = shape.supports_m
    for (axes,), (name, view) in zip(panels, views, strict=True):
        if section is not None:
            axes.axvspan(*section, PALE)
        _draw_view(axes, view, symbols)
        axes.x_scale.limits = (supports[0], supports[-1])
        axes.x_scale.ticks = supports[:: 1 if len(supports) <= MOST_LABELLED else 2]
        axes.x_scale.write = "{:g}".format
        axes.x_scale.has_labels = axes is panels[-1][0]
        axes.y_scale.margin, axes.y_name_left = 0.12, 0.065
        axes.name_axes("position along the line [m]" if axes.x_scale.has_labels else "", name)
    panels[0][0].add_legend(len(symbols) or 1, "right", list(symbols.items()))
    return figure


def _choose_marker(symbol: DrawnSymbol) -> LineStyle:
    face = INK if symbol.filled else "white"
    return LineStyle(INK, linestyle="", marker=symbol.marker, markersize=3, markerfacecolor=face)


def _draw_view(axes: Panel, view: DrawnView, symbols: Mapping[str, LineStyle]) -> None:
    droppers = view.droppers
    axes.vlines(droppers.x_m, droppers.lower_m, droppers.upper_m, LineStyle(GREY, 0.6))
    for curve in view.curves:
        axes.plot(curve.x_m, curve.y_m, LineStyle(INK, WIRE_WIDTHS[curve.kind]))
    for point in view.points:
        axes.plot([point.x_m], [point.y_m], symbols[point.symbol], is_clipped=False)
        if point.text:
            axes.text(point.x_m, point.y_m, point.text, 6.0, ha="center", va="top", shift=(0, -5))


# Scheme of a pantograph that is a chain: base, masses, springs, dampers and contact, with their values.
BOTTOM, GAP, BOX = 0.16, 0.38, 0.24
"""Height of the base, length of a spring, height of a mass [in]."""

LEFT, RIGHT = 1.05, 2.35
"""Edges of a mass [in]."""

SPRING_X, DAMPER_X = 1.45, 1.95
"""Positions of springs and dampers [in]."""

STRIP_EDGES = ((0.6, 1.12), (2.3, 2.82))
"""Edges of the strips on springs, from front to rear [in]."""

LONGEST_MASS_NAME = 14
"""Largest number of characters of the name of a mass, which its box holds."""


@dataclass(frozen=True)
class DrawnChain:
    """Chain of masses from base to head."""

    masses: tuple[float, ...]
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]
    """Masses [kg], and spring [N/m] and damper [N s/m] below each of them."""
    names: tuple[str, ...]
    """Name of each mass."""
    lifted: int
    """Index of the mass on which the uplift force acts."""
    contact: str
    """Stiffness of the contact with its unit; `hertz` or `constraint` for these laws."""
    strips: tuple[tuple[float, float, float], ...] = ()
    """Mass [kg], spring [N/m] and damper [N s/m] of each strip on a spring, from front to rear."""


@write_svg
def draw_chain(chain: DrawnChain) -> PanelFigure:
    """Scheme of a chain; a spring or damper of 0 is left out."""
    levels = len(chain.masses) + bool(chain.strips)
    wire = BOTTOM + levels * (GAP + BOX) + GAP
    figure = PanelFigure(HALF, wire + 0.1)
    axes = figure.add_axes(0.0, 0.0, figure.width, figure.height)
    axes.x_scale.limits, axes.y_scale.limits, axes.has_axes = (0, HALF), (0, figure.height), False
    _draw_base(axes)
    values = zip(chain.masses, chain.stiffness, chain.damping, chain.names, strict=True)
    for number, (mass, stiffness, damping, name) in enumerate(values):
        below = BOTTOM + number * (GAP + BOX)
        text = f"{_shorten(name)} {format_plain(mass)} kg"
        _draw_mass(axes, (LEFT, RIGHT), below, text, (SPRING_X, stiffness), (DAMPER_X, damping))
        if number == chain.lifted:
            _draw_uplift_force(axes, below + GAP + BOX / 2)
    carrier = wire - 2 * GAP - BOX
    for edges, (mass, stiffness, damping) in zip(STRIP_EDGES, chain.strips, strict=False):
        axes.plot([edges[0], (LEFT + RIGHT) / 2, edges[1]], 3 * [carrier], LineStyle(INK, 0.9))
        places = (edges[0] + 0.12, stiffness), (edges[1] - 0.12, damping)
        _draw_mass(axes, edges, carrier, f"{format_plain(mass)} kg", *places)
    for left, right in STRIP_EDGES[: len(chain.strips)] or ((LEFT, RIGHT),):
        _draw_spring(axes, (left + right) / 2, wire - GAP, chain.contact)
    axes.plot([0.7, 2.7], [wire, wire], LineStyle(INK, 1.8))
    _write(axes, 2.75, wire, "contact wire", "left")
    return figure


def _draw_mass(
    axes: Panel,
    edges: tuple[float, float],
    below: float,
    text: str,
    spring: tuple[float, float],
    damper: tuple[float, float],
) -> None:
    """Mass with its text, on a spring and a damper at their places, from `below` upwards."""
    if spring[1]:
        _draw_spring(axes, spring[0], below, f"{format_plain(spring[1])} N/m")
    _draw_damper(axes, *damper, below)
    bottom = below + GAP
    axes.fill([edges[0], edges[1], edges[1], edges[0]], [bottom, bottom, bottom + BOX, bottom + BOX], PALE)
    draw_symbol(axes, "mass", (sum(edges) / 2, bottom), (edges[1] - edges[0]) / 2, BOX)
    _write(axes, sum(edges) / 2, bottom + BOX / 2, text, "center")


def _draw_base(axes: Panel) -> None:
    axes.plot([LEFT, RIGHT], [BOTTOM, BOTTOM], LineStyle(INK, 1.2))
    for x in np.linspace(LEFT + 0.1, RIGHT, 10):
        axes.plot([x - 0.08, x], [BOTTOM - 0.08, BOTTOM], LineStyle(GREY, 0.7))


def _draw_spring(axes: Panel, x: float, below: float, text: str) -> None:
    """Spring from `below` upwards, with its stiffness on the left; a contact without a spring is a line."""
    if text == "constraint":
        axes.plot([x, x], [below, below + GAP], LineStyle(INK, 0.9))
    else:
        draw_symbol(axes, "spring", (x, below), 0.06, GAP)
    _write(axes, x - 0.12, below + GAP / 2, text, "right")


def _draw_damper(axes: Panel, x: float, damping: float, below: float) -> None:
    """Damper from `below` upwards, a piston in a cylinder, with its value on the right."""
    if damping == 0:
        return
    draw_symbol(axes, "damper", (x, below), 0.07, GAP)
    _write(axes, x + 0.12, below + GAP / 2, f"{format_plain(damping)} N s/m", "left")


def _draw_uplift_force(axes: Panel, middle: float) -> None:
    x = RIGHT + 0.12
    axes.plot([RIGHT, x], [middle, middle], LineStyle(INK, 0.7))
    top = middle + 0.2
    axes.plot([x, x], [middle - 0.08, top - 0.03], LineStyle(INK, 1.0))
    axes.fill([x - 0.02, x, x + 0.02], [top - 0.055, top, top - 0.055], INK, INK)
    _write(axes, x + 0.08, middle, "uplift force", "left")


def _write(axes: Panel, x: float, y: float, text: str, side: str) -> None:
    axes.text(x, y, text, ha=side, va="center")


def _shorten(name: str) -> str:
    return name if len(name) <= LONGEST_MASS_NAME else f"{name[: LONGEST_MASS_NAME - 1]}…"


# Drawing of the line of a case; a drawing that an earlier case has is named only.
def line_figures(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[doc.Figure, ...]:
    """Drawing of the line at rest; none without its shape, or if an earlier case of the report has the same drawing."""
    shape = case.line_shape
    if shape is None or _find_equal(case, earlier) is not None:
        return ()
    views = "side view" if shape.plan is None else "side view and plan view"
    labelled = Counter(point.symbol for point in shape.side.points if point.text)
    numbers = ", ".join(f"{symbol} ({number})" for symbol, number in labelled.items())
    parts = f" With texts: {numbers}." if labelled else ""
    section = case.run.evaluated_m
    caption = f"Line at rest, spans {shape.first_span} to {shape.last_span}: {views}, heights enlarged.{parts}"
    caption += _name_ground(section)
    return (doc.Figure(draw_line_shape(shape, section), caption, caption),)


def _name_ground(section: tuple[float, float] | None) -> str:
    return "" if section is None else " Grey ground: analysis section."


SKETCHED = 60.0
"""Length of the view over the width of a sketched pantograph."""

KNEE = np.array([-0.6, 0.6, 0.0, -0.5, 0.5]), np.array([-0.9, -0.45, 0.0, 0.0, 0.0])
"""Base, knee and head of a sketched pantograph, in its width [-] and below the wire [m]."""


@write_svg
def draw_sketch(shape: LineShape, section: tuple[float, float] | None, pantographs: int) -> PanelFigure:
    """Side view without scales, with the analysis section [m] on a grey ground and a number of pantographs below."""
    figure = PanelFigure(FULL, 0.38)
    axes = figure.add_axes(0.0, 0.0, figure.width, figure.height)
    axes.has_axes = False
    start, end = shape.supports_m[0], shape.supports_m[-1]
    low, high = section or (start, end)
    if section is not None:
        axes.axvspan(low, high, PALE)
    _draw_view(axes, shape.side.model_copy(update={"points": []}), {})
    wire = [curve for curve in shape.side.curves if curve.kind == "contact_wire"]
    x, y = [place for curve in wire for place in curve.x_m], [height for curve in wire for height in curve.y_m]
    size = (end - start) / SKETCHED
    for number in range(pantographs if wire else 0):
        place = (low + high) / 2 - 3 * size * number
        head = float(np.interp(place, x, y))
        axes.plot(place + size * KNEE[0], head + KNEE[1], LineStyle(INK, 1.0))
    axes.x_scale.limits, axes.y_scale.margin = (start, end), 0.08
    return figure


def draw_line_sketch(case: CaseResult) -> tuple[doc.Figure, ...]:
    """Sketch of the line of a case for page 1; none without its shape."""
    shape = case.line_shape
    if shape is None:
        return ()
    number = sum(key != "0" for key in case.quantities) if case.run.speed_km_h else 0
    caption = f"Line at rest, spans {shape.first_span} to {shape.last_span}, without scale."
    alternative = f"{caption} Analysis section on a grey ground, {count_noun(number, 'pantograph')}."
    section = case.run.evaluated_m
    return (doc.Figure(draw_sketch(shape, section, number), alternative, caption + _name_ground(section)),)


def name_pantographs(case: CaseResult) -> str:
    """Number, masses and distances of the pantographs of a case; masses of chains only."""
    texts = []
    for chain, names in _read_chains(case).items():
        texts.append(f"{len(names)} × masses {', '.join(map(format_plain, chain.masses))} kg")
        if chain.strips:
            texts[-1] += f" and strips {', '.join(format_plain(mass) for mass, *_ in chain.strips)} kg"
    number = sum(key != "0" for key in case.quantities)
    spacing = next((group.values["spacing_m"] for group in case.inputs if "spacing_m" in group.values), None)
    shown = ", ".join(map(format_plain, _list_numbers(spacing)))
    return ", ".join(
        [*(texts or ([count_noun(number, "pantograph")] if number else [])), *([f"{shown} m apart"] if shown else [])]
    )


def find_earlier_drawing(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[doc.SmallPrint, ...]:
    """Name of the earlier case that has the drawing of this one; parameters as in `line_figures`."""
    other = _find_equal(case, earlier)
    return () if other is None else (doc.SmallPrint(f"Line: as drawn in {other}."),)


def _find_equal(case: CaseResult, earlier: tuple[CaseResult, ...]) -> str | None:
    """Id of the first earlier case with the same line and analysis section."""
    if case.line_shape is None:
        return None
    drawn = (case.line_shape, case.run.evaluated_m)
    return next((other.id for other in earlier if (other.line_shape, other.run.evaluated_m) == drawn), None)


# Schemes of the pantographs of a case that are chains; equal chains are drawn once in a document.
DRAWN_KEYS = ("masses_kg", "stiffness_N_m", "damping_N_s_m")
"""Keys of the values of a chain, base to head."""


def scheme_figures(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[doc.Figure, ...]:
    """Scheme of every chain of a case that no earlier case has; parameters as in `line_figures`."""
    known = {chain for other in earlier for chain in _read_chains(other)}
    return tuple(_describe_chain(chain, names) for chain, names in _read_chains(case).items() if chain not in known)


def _read_chains(case: CaseResult) -> dict[DrawnChain, list[str]]:
    """Chains of a case with the names of their pantographs."""
    values = {group.group: group.values for group in case.inputs}
    chains: dict[DrawnChain, list[str]] = defaultdict(list)
    for group, content in values.items():
        name = group.removesuffix(".chain")
        parts = (values.get(f"{name}.{part}", {}) for part in ("contact", "head"))
        chain = _read_chain(content, *parts) if name != group else None
        if chain is not None:
            chains[chain].append(name)
    return chains


def _read_chain(values: StoredValues, contact: StoredValues, head: StoredValues) -> DrawnChain | None:
    """Chain of a group of inputs; None where values are missing, or are stored as a range."""
    masses, stiffness, damping = (_list_numbers(values.get(key)) for key in DRAWN_KEYS)
    spring, law = _list_numbers(contact.get("stiffness_N_m")), str(contact.get("law", ""))
    if (
        not masses
        or len({len(masses), len(stiffness), len(damping)}) > 1
        or not (len(spring) == 1 or law in SPRINGLESS)
    ):
        return None
    names = _list_names(values.get("names"), len(masses))
    # The uplift force acts on the lowest mass unless the file names another one (key uplift_force_on).
    point = values.get("uplift_force_on", 1.0)
    lifted = names.index(point) if point in names else int(point) - 1 if isinstance(point, float) else 0
    strips = (_list_numbers(head.get(f"strip.{key}")) for key in ("mass_kg", "stiffness_N_m", "damping_N_s_m"))
    text = f"{format_plain(spring[0])} N/m" if spring else law
    return DrawnChain(masses, stiffness, damping, names, lifted, text, tuple(zip(*strips, strict=False)))


def _list_numbers(value: StoredValue | None) -> tuple[float, ...]:
    """Numbers of a stored value, which is a number or a list; none for a text."""
    listed = value if isinstance(value, list) else [value]
    numbers = tuple(number for number in listed if isinstance(number, float))
    return numbers if len(numbers) == len(listed) else ()


def _list_names(value: StoredValue | None, size: int) -> tuple[str, ...]:
    names = tuple(map(str, value if isinstance(value, list) else [value]))
    return names if value is not None and len(names) == size else tuple(f"mass {n}" for n in range(1, size + 1))


def _describe_chain(chain: DrawnChain, pantographs: list[str]) -> doc.Figure:
    numbers = [name.removeprefix("pantograph").strip() for name in pantographs]
    owner = f"Pantograph {numbers[0]}".rstrip() if len(numbers) == 1 else f"Pantographs {' and '.join(numbers)}"
    caption = f"{owner}: masses, springs and dampers, from base to head."
    parts = ", ".join(f"{name} {format_plain(mass)} kg" for name, mass in zip(chain.names, chain.masses, strict=True))
    return doc.Figure(draw_chain(chain), f"{caption} {parts}.", caption, wide=False)
