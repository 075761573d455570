"""Derived values of the details of a line: stretches of its wires, point masses, irregularity and curves."""

from itertools import groupby

import numpy as np

from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.simulation.derived_format import (
    DerivedCurve,
    DerivedIrregularity,
    DerivedPointMass,
    DerivedStretch,
)
from pantocheck.conformance.simulation.derived_rounding import round_number, round_numbers, round_positions
from pantocheck.model import Catenary, DiscretisedLine, Kind, Wire


def derive_stretches(file: LineFile, line: DiscretisedLine, wire: Wire) -> tuple[DerivedStretch, ...]:
    """Properties of a contact or messenger wire from end to end, if they are not those of the tables of the line.

    Parameters
    ----------
    file : LineFile
        Content of the line file.
    line : DiscretisedLine
        Its finite elements.
    wire : Wire
        Wire of the line.
    """
    table = file.contact_wire if wire.kind is Kind.CONTACT_WIRE else file.messenger_wire
    if not table.change and wire.tension == table.tension_N:
        return ()
    row, limits, beams = line.mesh.row_of[wire.name, "z"], line.mesh.position, line.beams
    inside = [e for e in range(limits.size - 1) if wire.start <= limits[e] < wire.end and beams.mass_per_length[row, e]]
    arrays = (beams.tension, beams.mass_per_length, beams.bending_stiffness)
    stretches = []
    for properties, group in groupby(inside, lambda e: tuple(float(array[row, e]) for array in arrays)):
        elements = list(group)
        start, end = round_positions(limits[[elements[0], elements[-1] + 1]])
        tension, mass, stiffness = round_numbers(properties)
        stretches.append(
            DerivedStretch(from_m=start, to_m=end, tension_N=tension, mass_kg_m=mass, bending_stiffness_N_m2=stiffness)
        )
    return tuple(stretches)


def derive_point_masses(catenary: Catenary) -> tuple[DerivedPointMass, ...]:
    """Point masses of a line."""
    masses = []
    for mass in catenary.point_masses:
        wire = catenary.wire(mass.wire)
        parallel = [other.name for other in catenary.wires if other.kind is wire.kind]
        masses.append(
            DerivedPointMass(
                position_m=round_positions([mass.position])[0],
                wire="contact_wire" if wire.kind is Kind.CONTACT_WIRE else "messenger_wire",
                number=1 + parallel.index(wire.name),
                mass_kg=round_number(mass.mass),
                mass_coefficient_1_s=catenary.rayleigh(wire.kind).mass_coefficient,
            )
        )
    return tuple(masses)


def derive_irregularity(catenary: Catenary) -> DerivedIrregularity | None:
    """Irregularity of the contact wires."""
    irregularity = catenary.contact_wires[0].irregularity
    if irregularity is None:
        return None
    return DerivedIrregularity(
        x_m=round_positions(irregularity.position), height_m=round_numbers(np.array(irregularity.height))
    )


def derive_curves(catenary: Catenary) -> tuple[DerivedCurve, ...]:
    """Curves of the track."""
    return tuple(
        DerivedCurve(
            from_m=round_positions([curve.start])[0],
            to_m=round_positions([curve.end])[0],
            curvature_1_m=round_number(1 / curve.radius),
            transition_m=round_positions([curve.transition])[0],
        )
        for curve in catenary.curves
    )
