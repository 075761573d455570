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

from pantocheck.model.catenary import Catenary, Kind, Wire

Rise = Callable[[float], float]
"""Rise of the wires of a section above their heights without overlap, by position along the line [m]."""


def place_section(catenary: Catenary, name: str, start: float, rise: Rise) -> Catenary:
    """Place a section along a line: shift it, raise its wires, and put its name before the names of the wires.

    Every prescribed height rises alike: anchors, arms, supports and the contact wire at the droppers.

    Parameters
    ----------
    catenary : Catenary
        Section that begins at 0.
    name : str
        Name of the section, unique within the line.
    start : float
        Position of its start along the line [m].
    rise : callable
        Rise at a position along the line [m].

    Returns
    -------
    Catenary
        Section in its place.
    """

    def rename(wire: str) -> str:
        return f"{name} {wire}"

    return replace(
        catenary,
        wires=tuple(_place_wire(catenary, wire, rename(wire.name), start, rise) for wire in catenary.wires),
        droppers=tuple(
            replace(
                dropper,
                position=start + dropper.position,
                upper=rename(dropper.upper),
                lower=rename(dropper.lower),
                contact_wire_height=None
                if dropper.contact_wire_height is None
                else dropper.contact_wire_height + rise(start + dropper.position),
            )
            for dropper in catenary.droppers
        ),
        steady_arms=tuple(
            replace(
                arm,
                position=start + arm.position,
                wire=rename(arm.wire),
                height=arm.height + rise(start + arm.position),
            )
            for arm in catenary.steady_arms
        ),
        messenger_supports=tuple(
            replace(
                support,
                position=start + support.position,
                wire=rename(support.wire),
                height=support.height + rise(start + support.position),
            )
            for support in catenary.messenger_supports
        ),
        curves=tuple(replace(c, start=start + c.start, end=start + c.end) for c in catenary.curves),
        point_masses=tuple(
            replace(mass, position=start + mass.position, wire=rename(mass.wire)) for mass in catenary.point_masses
        ),
        clamps=tuple(
            replace(clamp, position=start + clamp.position, upper=rename(clamp.upper), lower=rename(clamp.lower))
            for clamp in catenary.clamps
        ),
        springs=tuple(
            replace(spring, position=start + spring.position, upper=rename(spring.upper), lower=rename(spring.lower))
            for spring in catenary.springs
        ),
    )


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

    Parameters
    ----------
    sections : sequence of Catenary
        Sections in running order, with the same damping and with different names of wires.

    Returns
    -------
    Catenary
        Line of all sections.

    Raises
    ------
    ValueError
        The sections differ in their damping, or a name of a wire occurs twice.
    """
    first = sections[0]
    if any((s.damping, s.modal_damping) != (first.damping, first.modal_damping) for s in sections):
        raise ValueError("the sections of a line differ in their damping; give them the same")
    wires = tuple(wire for section in sections for wire in section.wires)
    names = [wire.name for wire in wires]
    if len(set(names)) < len(names):
        raise ValueError("two wires of the line have the same name; give each section another name")
    return replace(
        first,
        wires=wires,
        droppers=tuple(dropper for section in sections for dropper in section.droppers),
        steady_arms=tuple(arm for section in sections for arm in section.steady_arms),
        messenger_supports=tuple(support for section in sections for support in section.messenger_supports),
        clamps=tuple(clamp for section in sections for clamp in section.clamps),
        springs=tuple(spring for section in sections for spring in section.springs),
        point_masses=tuple(mass for section in sections for mass in section.point_masses),
        curves=tuple(dict.fromkeys(curve for section in sections for curve in section.curves)),
    )
