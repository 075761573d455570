"""Tension sections of a line: each has its own wires from anchor to anchor, and neighbours overlap over some spans.

    z ^  anchor of the incoming wires  o._       _.o  anchor of the outgoing wires
      |                                   `-._.-'
      |  outgoing ------------------------_.-'`-._------------------------ incoming
      +---------------------------------|-----------|-----------------------------> x
                                           overlap

In an overlap the outgoing wires rise to their anchor, and the incoming ones descend from theirs. Only a pantograph
connects two sections.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from pantocheck.model.description.catenary import Catenary, Kind, Wire

PARTS = ("droppers", "steady_arms", "messenger_supports", "clamps", "springs", "point_masses")
"""Parts of a catenary at single positions."""
WIRE_KEYS = ("wire", "upper", "lower")
"""Names of the wires that a part is attached to."""
HEIGHT_KEYS = ("height", "contact_wire_height")
"""Heights that a part prescribes."""

Rise = Callable[[float], float]
"""Rise of the wires of a section above their heights without overlap, by position along the line [m]."""


def place_section(catenary: Catenary, name: str, start: float, rise: Rise) -> Catenary:
    """Place a section along a line: shift it, raise its wires, and put its name before the names of the wires.

    Every prescribed height rises alike: anchors, arms, supports and the contact wire at the droppers.

    Args:
        catenary: Section that begins at 0.
        name: Name of the section, unique within the line.
        start: Position of its start along the line [m].
        rise: Rise at a position along the line [m].
    """

    def rename(wire: str) -> str:
        return f"{name} {wire}"

    moved: dict[str, Any] = {
        parts: tuple(_place_part(part, rename, start, rise) for part in getattr(catenary, parts)) for parts in PARTS
    }
    return replace(
        catenary,
        wires=tuple(_place_wire(catenary, wire, rename(wire.name), start, rise) for wire in catenary.wires),
        curves=tuple(replace(c, start=start + c.start, end=start + c.end) for c in catenary.curves),
        **moved,
    )


def _place_part(part: Any, rename: Callable[[str], str], start: float, rise: Rise) -> Any:
    """Part at one position in its place; a height that it prescribes rises."""
    position = start + part.position
    changes: dict[str, Any] = {key: rename(getattr(part, key)) for key in WIRE_KEYS if hasattr(part, key)}
    for key in HEIGHT_KEYS:
        if getattr(part, key, None) is not None:
            changes[key] = getattr(part, key) + rise(position)
    return replace(part, position=position, **changes)


def _place_wire(catenary: Catenary, wire: Wire, name: str, start: float, rise: Rise) -> Wire:
    """Wire of a section in its place; the anchors of contact and messenger wires rise."""
    ends = None
    if wire.kind is not Kind.STITCH_WIRE:
        heights = wire.end_heights or _default_end_heights(catenary, wire)
        ends = heights[0] + rise(start + wire.start), heights[1] + rise(start + wire.end)
    return replace(
        wire,
        name=name,
        start=start + wire.start,
        end=start + wire.end,
        tension_changes=tuple(replace(c, start=start + c.start, end=start + c.end) for c in wire.tension_changes),
        section_changes=tuple(replace(c, start=start + c.start, end=start + c.end) for c in wire.section_changes),
        irregularity=None
        if wire.irregularity is None
        else replace(wire.irregularity, position=tuple(start + x for x in wire.irregularity.position)),
        stagger=None if wire.stagger is None else tuple((start + x, y) for x, y in wire.stagger),
        end_heights=ends,
    )


def _default_end_heights(catenary: Catenary, wire: Wire) -> tuple[float, float]:
    """Heights of the anchors of a wire that gives none, as in `Wire.end_heights` [m]."""
    supports = sorted((s.position, s.height) for s in catenary.messenger_supports if s.wire == wire.name)
    return (supports[0][1], supports[-1][1]) if supports else (0.0, 0.0)


def join_sections(sections: Sequence[Catenary]) -> Catenary:
    """Join sections in their places to one line.

    Args:
        sections: Sections in running order, with the same damping and with different names of wires.

    Raises:
        ValueError: The sections differ in their damping, or a name of a wire occurs twice.
    """
    first = sections[0]
    if any((s.damping, s.modal_damping) != (first.damping, first.modal_damping) for s in sections):
        raise ValueError("the sections of a line differ in their damping; give them the same")
    wires = tuple(wire for section in sections for wire in section.wires)
    names = [wire.name for wire in wires]
    if len(set(names)) < len(names):
        raise ValueError("two wires of the line have the same name; give each section another name")
    joined: dict[str, Any] = {
        parts: tuple(part for section in sections for part in getattr(section, parts)) for parts in PARTS
    }
    curves = tuple(dict.fromkeys(curve for section in sections for curve in section.curves))
    return replace(first, wires=wires, curves=curves, **joined)


def select_parts(catenary: Catenary, name: str) -> dict[str, list[int]]:
    """Indices of the parts of a section by its name, which begins the names of its wires."""
    return {
        parts: [
            index
            for index, part in enumerate(getattr(catenary, parts))
            if next(getattr(part, key) for key in WIRE_KEYS if hasattr(part, key)).startswith(f"{name} ")
        ]
        for parts in PARTS
    }
