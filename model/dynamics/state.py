"""What the time step works on, as plain arrays: the line, its motion, the pantographs, scratch space."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.block_tridiagonal import Factor

PIECE = 256
"""Elements of a row that are worked on together."""


class KernelArrays(NamedTuple):
    """What stays the same during a run; B rows, S stations, N connectors with E ends, W contact wires.

    Parameters
    ----------
    time_step : float
        [s].
    reach : float
        What lies farther than this from every pantograph stands still [m].
    front : float
        Speed that no wave exceeds; what none can have come to yet stands still, too [m/s].
    position : (S,) ndarray
        [m].
    length : (S-1,) ndarray
        Of the elements [m].
    stiffness_entries : (B, 4, S-1) ndarray
        Entries 11, 12, (22 + 24) / 2, (22 - 24) / 2 of each element's stiffness [N/m, N, N m, N m].
    damping_mass : (B, S-1) ndarray
        Mass of each element times its damping coefficient, over 420 [kg/s].
    mass_coefficient, stiffness_coefficient : (B,) ndarray
        Damping of the wires [1/s, s].
    lumped_row, lumped_station : (Q,) int ndarray
        Where a spring or a damper holds a single row.
    lumped_stiffness, lumped_damping : (Q,) ndarray
        [N/m, N s/m].
    factor : Factor
        Of the effective matrix.
    columns : (L, 2, 2H) ndarray
        Its inverse around the ends of the connectors.
    station : (N,) int ndarray
        Of the connectors.
    end_row, end_column : (N, E) int ndarray
        Row of each end, and its column in `columns`.
    end_coefficient : (N, E) ndarray
        In the elongation; zero for an end that is not there.
    stiffness, damping, preload : (N,) ndarray
        [N/m, N s/m, N].
    gain : (N,) ndarray
        Tension per acceleration of the elongation within a step [kg].
    yielding : (N,) ndarray
        Gain times what a newton of tension accelerates the elongation back [-].
    unilateral : (N,) ndarray
        Whether the tension cannot be negative.
    contact_row : (W,) int ndarray
        Rows that a pantograph touches.
    bubble : (W, S-1, 6) ndarray
        What a point force bends an element between its stations, see `local_flexibility` [m/N].
    contact_columns : (W, S, 2, 2, 2H) ndarray
        The inverse around every station, for a force and for a moment.
    modal_damping : (J,) ndarray
        Of the modes whose damping is set one by one [1/s].
    modal_weight : (J, 2, B, S) ndarray
        M phi of these modes, deflections and slopes [kg^1/2].
    modal_response : (J, 2, B, S) ndarray
        The inverse applied to it [kg^-1/2].
    modal_compliance : (J,) ndarray
        Weight times response [-].
    load_row, load_station : int
        Where the external load acts.
    rest : (W, S, 2) ndarray
        Height and slope of the contact wires at rest [m, -].
    """

    time_step: float
    reach: float
    front: float
    position: Array
    length: Array
    stiffness_entries: Array
    damping_mass: Array
    mass_coefficient: Array
    stiffness_coefficient: Array
    lumped_row: Indices
    lumped_station: Indices
    lumped_stiffness: Array
    lumped_damping: Array
    factor: Factor
    columns: Array
    station: Indices
    end_row: Indices
    end_column: Indices
    end_coefficient: Array
    stiffness: Array
    damping: Array
    preload: Array
    gain: Array
    yielding: Array
    unilateral: NDArray[np.bool_]
    contact_row: Indices
    bubble: Array
    contact_columns: Array
    modal_damping: Array
    modal_weight: Array
    modal_response: Array
    modal_compliance: Array
    load_row: int
    load_station: int
    rest: Array


class Motion(NamedTuple):
    """State of the line about its initial state.

    Parameters
    ----------
    w, r : (3, B, S) ndarray
        Deflection and slope: displacement, velocity, acceleration [m, -; per s; per s2].
    tension : (N,) ndarray
        Of the connectors, in total [N].
    modal : (J,) ndarray
        Damping forces on the modes whose damping is set one by one [N kg^-1/2].
    load : (1,) ndarray
        External load, upwards [N].
    """

    w: Array
    r: Array
    tension: Array
    modal: Array
    load: Array


class Train(NamedTuple):
    """Pantographs and their state; P pantographs of at most n unknowns, each touching W contact wires.

    Parameters
    ----------
    position : (P,) ndarray
        [m].
    speed : (1,) ndarray
        [m/s].
    elapsed : (1,) ndarray
        Since the start [s].
    inverse : (P, n, n) ndarray
        Inverse of each pantograph's effective matrix [1/kg].
    damping, stiffness : (P, n, n) ndarray
        [N s/m, N/m].
    head : (P, n) ndarray
        Picks the head's displacement [-].
    force : (P, n) ndarray
        Constant forces [N].
    contact_stiffness : (P,) ndarray
        [N/m].
    z : (3, P, n) ndarray
        Displacement, velocity, acceleration [m, m/s, m/s2].
    contact : (P, W) ndarray
        Contact forces [N].
    """

    position: Array
    speed: Array
    elapsed: Array
    inverse: Array
    damping: Array
    stiffness: Array
    head: Array
    force: Array
    contact_stiffness: Array
    z: Array
    contact: Array


class Workspace(NamedTuple):
    """Arrays that every step fills anew, so that none is allocated inside it.

    Parameters
    ----------
    seen : (2, PIECE + 1) ndarray
        Deflection and slope that the stiffness of a piece of wire sees.
    forces : (4, PIECE + 1) ndarray
        Shear, drag, tilt and bend of its elements, after those of the last one before it [N, N m].
    tension : (N,) ndarray
        Of the connectors in the predicted state, as if all could push [N].
    shape : (P, W, 4) ndarray
        Hermite functions at the contacts.
    element : (P,) int ndarray
        Element over each pantograph.
    stiffness : (P, W) ndarray
        Of penalty and local flexibility of the wire in series [N/m].
    closing : (P, W) ndarray
        Predicted overlap of head and wire [m].
    compliance : (P, W) ndarray
        Relative acceleration that a newton of contact force causes [1/kg].
    modal_velocity : (J,) ndarray
        Predicted, of the modes whose damping is set one by one [m kg^1/2 / s].
    """

    seen: Array
    forces: Array
    tension: Array
    shape: Array
    element: Indices
    stiffness: Array
    closing: Array
    compliance: Array
    modal_velocity: Array
