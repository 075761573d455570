"""Tension of a wire between fixed anchors after a change of temperature.

A wire that grows warmer becomes longer: its tension falls and its sag grows, which takes up a part of the length. The
excess length e = 1/2 mean(z'2) of the shape z over its chord is proportional to 1 / T2 for given loads. The amount of
wire between the anchors stays the same:

    (T - T0) / EA + alpha dtheta = e0 ((T0 / T)^2 - 1)

For a flat wire this is T = T0 - EA alpha dtheta; for a slack wire the sag takes up nearly everything.
"""

import numpy as np
import scipy

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Catenary, Wire
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.initial_state import compute_initial_state
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import build_beams
from pantocheck.model.fem.mesh import build_mesh


def fixed_tension(tension: float, excess_length: float, axial_stiffness: float, thermal_strain: float) -> float:
    """Tension of a wire between fixed anchors after a thermal strain.

    Args:
        tension: Tension before [N].
        excess_length: Excess of the length of the wire over its chord before, as a share of the chord [-].
        axial_stiffness: Axial stiffness EA [N].
        thermal_strain: Expansion coefficient times change of temperature [-].

    Returns:
        Tension after [N].

    Raises:
        NoInitialState: A flat wire would have to push.
    """
    flat = tension - axial_stiffness * thermal_strain
    if excess_length == 0.0:
        if flat <= 0.0:
            raise NoInitialState(f"the warmer wire would have no tension left: {tension:.4g} N fall to {flat:.4g} N")
        return flat

    def missing_length(trial: float) -> float:
        """Length that the wire lacks at a trial tension, as a share of the chord."""
        return (trial - flat) / axial_stiffness - excess_length * ((tension / trial) ** 2 - 1)

    highest = max(tension, flat)
    lowest = tension / (1 + (highest - flat) / (axial_stiffness * excess_length)) ** 0.5
    return float(scipy.optimize.brentq(missing_length, lowest, highest, xtol=1e-9 * tension))


def excess_lengths(catenary: Catenary, element_length: float) -> dict[str, float]:
    """Excess of the vertical shape at rest over the chord between the anchors, by wire, on elements of a length [m]."""
    mesh = build_mesh(catenary, element_length)
    beams = build_beams(catenary, mesh)
    deflection = compute_initial_state(catenary, mesh, beams).deflection
    unit_tension = beam.stiffness(beams.length, 1.0, 0.0)

    def excess(wire: Wire) -> float:
        """Half of the mean squared slope of a wire against its chord."""
        first, last = mesh.station(wire.start), mesh.station(wire.end)
        shape: Array = deflection[mesh.row_of[wire.name, "z"]]
        ends = np.concatenate([shape[first:last], shape[first + 1 : last + 1]], axis=1)
        squared = float(np.einsum("ei,eij,ej->", ends, unit_tension[first:last], ends))
        chord = wire.end - wire.start
        return squared / (2 * chord) - (float(shape[last, 0] - shape[first, 0]) / chord) ** 2 / 2

    return {wire.name: max(excess(wire), 0.0) for wire in catenary.wires}
