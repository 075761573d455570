"""Variation of a catenary after it was built: other tensions and staggers, and droppers of other lengths.

The line is built with its nominal data. Then its tensions and staggers change. Its droppers keep their unloaded lengths
or change them by a tolerance, and the contact wire hangs at other heights.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.variation import ListedLengthChanges, Variation, WireVariation
from pantocheck.model import Catenary, Kind, Wire
from pantocheck.model.statics.dropper_lengths import compute_unloaded_lengths, hang_on_droppers
from pantocheck.model.statics.wire_climate import excess_lengths, fixed_tension

VARIATION_ELEMENT_M = 0.5
"""Element length for the heights of a varied line [m].

With elements of 0.125 m the heights of the lines of the library change by less than 0.02 mm, the dropper forces by less
than 0.1 N, for 5 % less tension of the messenger wire.
"""


def vary_catenary(catenary: Catenary, line: LineFile) -> Catenary:
    """Apply the variation of a line file to the catenary as built.

    Parameters
    ----------
    catenary : Catenary
        Catenary with the nominal data.
    line : LineFile
        Content of the line file.

    Returns
    -------
    Catenary
        Catenary with varied tensions, staggers and heights; the same one without a variation.

    Raises
    ------
    NoInitialState
        A wire would have no tension left, or a dropper would be slack at rest.
    """
    variation = line.variation
    if variation is None:
        return catenary
    length = compute_unloaded_lengths(catenary, VARIATION_ELEMENT_M) + _length_changes(variation, catenary, line)
    excess = excess_lengths(catenary, VARIATION_ELEMENT_M)
    moved = _stagger_changes(variation, line)
    wires = tuple(_move_wire(_vary_tension(wire, variation, excess[wire.name]), moved) for wire in catenary.wires)
    return hang_on_droppers(replace(catenary, wires=wires), length, VARIATION_ELEMENT_M)


def _vary_tension(wire: Wire, variation: Variation, excess_length: float) -> Wire:
    """Wire with its tension after the change of temperature and with its tolerance; a stitch wire is unchanged."""
    tables = {Kind.CONTACT_WIRE: variation.contact_wire, Kind.MESSENGER_WIRE: variation.messenger_wire}
    table = tables.get(wire.kind, WireVariation())
    tension = wire.tension
    if table.ends == "anchor" and table.axial_stiffness_EA_N and table.expansion_coefficient_1_K:
        strain = table.expansion_coefficient_1_K * variation.temperature_change_K
        tension = fixed_tension(tension, excess_length, table.axial_stiffness_EA_N, strain)
    return replace(wire, tension=tension * (1 + table.tension_change_share))


def _stagger_changes(variation: Variation, line: LineFile) -> dict[float, float]:
    """Change of the stagger of the contact wire at every support by its position [m, m]."""
    table, supports = variation.supports, line.geometry.supports
    changes = (
        np.zeros(len(supports)) if table is None else _draw_changes(table.stagger_tolerance_m, table.seed, supports)
    )
    return dict(zip(supports, changes.tolist(), strict=True))


def _move_wire(wire: Wire, changes: Mapping[float, float]) -> Wire:
    """Contact wire with its stagger after the change at every support; its anchors and other wires are unchanged."""
    if wire.kind is not Kind.CONTACT_WIRE or wire.stagger is None:
        return wire
    first, *inner, last = wire.stagger
    return replace(wire, stagger=(first, *((x, y + changes[x]) for x, y in inner), last))


def _length_changes(variation: Variation, catenary: Catenary, line: LineFile) -> RealArray:
    """Change of the length of every dropper [m]."""
    table = variation.droppers
    if table is None:
        return np.zeros(len(catenary.droppers))
    if isinstance(table, ListedLengthChanges):
        return np.array(_list_changes(table.length_change_m, line))
    return _draw_changes(table.tolerance_m, table.seed, catenary.droppers)


def _draw_changes(tolerance: float, seed: int, parts: Sequence[object]) -> RealArray:
    """Change of every part, uniformly distributed within a tolerance, in the unit of the tolerance."""
    shares = np.random.PCG64(seed).random_raw(len(parts)) / 2.0**64
    return np.asarray(tolerance * (2 * shares - 1))


def _list_changes(spans: Sequence[Sequence[float]], line: LineFile) -> list[float]:
    """Listed changes of all droppers, section by section; the droppers of parallel wires at one place have the same."""
    return [
        change
        for place in line.section_places
        for span in spans[place.first : place.last]
        for change in span
        for _ in range(line.contact_wire.number)
    ]
