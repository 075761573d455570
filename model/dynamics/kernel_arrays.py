"""Kernel arrays: everything of a line that the time step needs and that does not change during a simulation."""

from typing import NamedTuple

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import WindowArrays, whole_line
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.connector_step import ConnectorArrays, build_connector_arrays, connector_ends
from pantocheck.model.dynamics.contact_step import (
    ContactArrays,
    ContactWorkspace,
    allocate_contact_workspace,
    build_contact_arrays,
)
from pantocheck.model.dynamics.effective_matrix import factorise
from pantocheck.model.dynamics.inverse_columns import column_half_width
from pantocheck.model.dynamics.modal_step import ModalArrays, build_modal_arrays
from pantocheck.model.dynamics.stretch_step import StretchArrays, build_stretch_arrays
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.wire_step import WireArrays, WireWorkspace, allocate_wire_workspace, build_wire_arrays
from pantocheck.model.fem.contact_wires import locate_contact_wires
from pantocheck.model.modal.modal_damping import build_modal_terms


class Load(NamedTuple):
    """Point of an external vertical load: row of wires, and station (node of the mesh) along the track."""

    row: int
    station: int


class KernelArrays(NamedTuple):
    """Arrays of the time step.

    Parameters
    ----------
    time_step : float
        Time step [s].
    window : WindowArrays
        Limits of the active window.
    factor : Factor
        Block factors of the effective matrix.
    wires : WireArrays
        Wires and lumped parts.
    connectors : ConnectorArrays
        Droppers and other connectors.
    contact : ContactArrays
        Contact wires under the pantographs.
    stretches : StretchArrays
        Held stretches.
    modal : ModalArrays
        Modes with modal damping.
    load : Load
        Position of the external load.
    """

    time_step: float
    window: WindowArrays
    factor: Factor
    wires: WireArrays
    connectors: ConnectorArrays
    contact: ContactArrays
    stretches: StretchArrays
    modal: ModalArrays
    load: Load


class Workspace(NamedTuple):
    """Scratch arrays that every step fills anew, so that a step allocates no memory.

    Parameters
    ----------
    wires : WireWorkspace
        Forces of a piece of wire.
    tension : (N,) ndarray
        Predicted tensions of the connectors, without the condition that a dropper cannot push [N].
    contact : ContactWorkspace
        Predictors of the contacts.
    elongation : (K,) ndarray
        Predicted elongations of the held stretches [m].
    modal_velocity : (J,) ndarray
        Predicted velocities of the modes with modal damping [m kg^1/2 / s].
    """

    wires: WireWorkspace
    tension: Array
    contact: ContactWorkspace
    elongation: Array
    modal_velocity: Array


def build_kernel_arrays(
    line: DiscretisedLine, time_step: float, window: WindowArrays | None = None, load: Load | None = None
) -> KernelArrays:
    """Build the arrays of the time step.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    time_step : float
        Time step [s].
    window : WindowArrays or None
        Limits of the active window; None: the whole line is active. With modal damping or held stretches the whole line
        is active, too: a mode moves all of it, and a stretch moves its neighbours at once.
    load : Load or None
        Position of an external load.

    Returns
    -------
    KernelArrays
        Arrays of the line.
    """
    factor = factorise(line.beams, time_step)
    terms = build_modal_terms(line)
    moves_as_a_whole = terms.damping.size > 0 or line.stretches.stiffness.size > 0
    stations = line.mesh.position.size
    contact_loads = [
        (row, s) for row, first, last in np.transpose(locate_contact_wires(line)) for s in range(first, last + 1)
    ]
    sample = contact_loads[:: max(1, stations // 200)]
    half_width = column_half_width(factor, connector_ends(line.connectors) + sample)
    return KernelArrays(
        time_step=time_step,
        window=whole_line(line) if window is None or moves_as_a_whole else window,
        factor=factor,
        wires=build_wire_arrays(line.beams),
        connectors=build_connector_arrays(line.connectors, factor, time_step, half_width),
        contact=build_contact_arrays(line, factor, time_step, half_width),
        stretches=build_stretch_arrays(line.stretches, factor, time_step, half_width),
        modal=build_modal_arrays(terms, factor, time_step),
        load=load or Load(0, 0),
    )


def build_workspace(kernel: KernelArrays, train: Train) -> Workspace:
    """Allocate the scratch arrays for one simulation."""
    return Workspace(
        wires=allocate_wire_workspace(),
        tension=np.zeros(kernel.connectors.station.size),
        contact=allocate_contact_workspace(train),
        elongation=np.zeros(kernel.stretches.stiffness.size),
        modal_velocity=np.zeros(kernel.modal.damping.size),
    )
