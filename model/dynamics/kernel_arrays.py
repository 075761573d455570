"""Kernel arrays of a line, and the effective matrix A = M + dt/2 C + dt^2/4 K of a step, M from `mass_correction`."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import block_array, csr_array

from pantocheck.model.description.arrays import Array
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.dynamics.active_window import WindowArrays, build_whole_window
from pantocheck.model.dynamics.block_tridiagonal import Factor, factorise_blocks
from pantocheck.model.dynamics.connector_step import (
    ConnectorArrays,
    build_connector_arrays,
    coefficients_at_nodes,
    column_half_width,
    connector_ends,
    node_compliance,
)
from pantocheck.model.dynamics.contact_arrays import (
    ContactArrays,
    ContactWorkspace,
    allocate_contact_workspace,
    build_contact_arrays,
)
from pantocheck.model.dynamics.distributed_step import (
    DistributedArrays,
    build_distributed_arrays,
    build_distributed_laws,
    stack_vectors,
)
from pantocheck.model.dynamics.extents import find_extents, merge_extents
from pantocheck.model.dynamics.motion import Layout
from pantocheck.model.dynamics.panels import PanelFactor, PanelWorkspace, allocate_panel_workspace, build_panels
from pantocheck.model.dynamics.scalar_forces import (
    ScalarForces,
    ScalarLaw,
    ScalarWorkspace,
    allocate_scalar_workspace,
    build_scalar_forces,
)
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.vectors import LANES
from pantocheck.model.dynamics.wire_step import WireArrays, build_wire_arrays
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams, element_stiffness
from pantocheck.model.fem.mass_correction import mass_correction
from pantocheck.model.modal.modal_damping import build_modal_terms
from pantocheck.model.statics.contact_wires import locate_contact_wires


def factorise(beams: Beams, time_step: float) -> Factor:
    """Block factors of A for all rows of beams and a time step [s]."""
    return factorise_blocks(*_effective_blocks(beams, time_step), beams.free)


def _effective_blocks(beams: Beams, time_step: float) -> tuple[Array, Array]:
    """Diagonal and sub-diagonal blocks of A, (B, S, 2, 2) each; fixed unknowns have the identity on the diagonal.

    Entry s of the sub-diagonal blocks couples station s to station s - 1.
    """
    rows, stations = beams.lumped_mass.shape
    diagonal, below = np.zeros((rows, stations, 2, 2)), np.zeros((rows, stations, 2, 2))
    half, quarter = time_step / 2, time_step**2 / 4
    for row in range(rows):
        mass_factor = 1 + half * beams.mass_coefficient[row]
        stiffness_factor = quarter + half * beams.stiffness_coefficient[row]
        element = mass_factor * beam.mass(beams.length, beams.mass_per_length[row])
        element += stiffness_factor * element_stiffness(beams, row) - mass_correction(beams, row, time_step)
        diagonal[row, :-1] += element[:, :2, :2]
        diagonal[row, 1:] += element[:, 2:, 2:]
        below[row, 1:] = element[:, 2:, :2]
    diagonal[:, :, 0, 0] += beams.lumped_mass + half * beams.lumped_damping + quarter * beams.lumped_stiffness
    fixed = ~beams.free
    for i in range(2):
        diagonal[fixed[:, :, i], i, :] = 0.0
        diagonal[fixed[:, :, i], :, i] = 0.0
        diagonal[fixed[:, :, i], i, i] = 1.0
        below[fixed[:, :, i], i, :] = 0.0
        below[:, 1:][fixed[:, :-1, i], :, i] = 0.0
    return diagonal, below


# Kernel arrays: everything of a line that the time step needs and that does not change during a simulation.
class Load(NamedTuple):
    """Point of an external vertical load: row of wires, and station (node of the mesh) along the track."""

    row: int
    station: int


class KernelArrays(NamedTuple):
    """Arrays of the time step."""

    time_step: float
    """Time step [s]."""
    layout: Layout
    """Layout of the rows of a motion."""
    window: WindowArrays
    """Limits of the active window."""
    panels: PanelFactor
    """Block factors of the effective matrix."""
    wires: WireArrays
    """Wires and lumped parts."""
    connectors: ConnectorArrays
    """Droppers and other connectors."""
    distributed: DistributedArrays
    """Held stretches and modes with modal damping."""
    forces: ScalarForces
    """Scalar forces: tensions of the connectors, then distributed forces."""
    contact: ContactArrays
    """Contact wires under the pantographs."""
    load: Load
    """Position of the external load."""


class Workspace(NamedTuple):
    """Scratch arrays that every step fills anew, so that a step allocates no memory."""

    panels: PanelWorkspace
    """Active panels."""
    scalar: ScalarWorkspace
    """Scalar forces."""
    node: Array
    """Accelerations of the nodes of the connectors, (J,) [m/s2]."""
    contact: ContactWorkspace
    """Predictors of the contacts."""


def build_kernel_arrays(
    line: DiscretisedLine, time_step: float, window: WindowArrays | None = None, load: Load | None = None
) -> KernelArrays:
    """Build the arrays of the time step.

    Args:
        line: Discretised line.
        time_step: Time step [s].
        window: Limits of the active window; None: the whole line is active.
        load: Position of an external load.

    Returns:
        Arrays of the line, shared by all simulations with this time step.
    """
    kernel = _build_line_arrays(line, time_step)
    if window is not None:
        kernel = kernel._replace(window=window)
    return kernel if load is None else kernel._replace(load=load)


@keep_with_line
def _build_line_arrays(line: DiscretisedLine, time_step: float) -> KernelArrays:
    """Build the arrays with the whole line active and without a load."""
    factor = factorise(line.beams, time_step)
    terms = build_modal_terms(line)
    stations = line.mesh.position.size
    contact_loads = [
        (row, s) for row, first, last in np.transpose(locate_contact_wires(line)) for s in range(first, last + 1)
    ]
    sample = contact_loads[:: max(1, stations // 200)]
    half_width = column_half_width(factor, connector_ends(line.connectors) + sample)
    # A vector or a local column that begins on the line ends before the end of its row.
    panels = build_panels(factor, line.mesh.position, 2 * half_width + 2 * LANES)
    panel = panels.piece * LANES
    layout = Layout(stations, panels.panels * panel)
    connectors = build_connector_arrays(line.connectors, factor, layout, half_width)
    distributed = build_distributed_arrays(line.stretches, terms, factor, layout, half_width)
    tensions = ScalarLaw(
        line.connectors.preload, line.connectors.stiffness, line.connectors.damping, line.connectors.unilateral
    )
    laws = (tensions, build_distributed_laws(line.stretches, terms))
    law = ScalarLaw(*(np.concatenate(parts) for parts in zip(*laws, strict=True)))
    compliance = _compliance(connectors, distributed, layout, line.mesh.rows)
    beyond = Factor(*(np.pad(part, ((0, 0), (0, layout.width - stations), (0, 0))) for part in factor))
    return KernelArrays(
        time_step=time_step,
        layout=layout,
        window=build_whole_window(line),
        panels=panels,
        wires=build_wire_arrays(line.beams, merge_extents(find_extents(line.beams), panel), layout),
        connectors=connectors,
        distributed=distributed,
        forces=build_scalar_forces(law, compliance, time_step),
        contact=build_contact_arrays(line, beyond, time_step, half_width),
        load=Load(0, 0),
    )


def _compliance(connectors: ConnectorArrays, distributed: DistributedArrays, layout: Layout, rows: int) -> csr_array:
    """Acceleration of the elongation of each scalar force per any other one, (F, F) [1/kg]."""
    nodes, ends = connectors.nodes, coefficients_at_nodes(connectors)
    coefficient, response = (
        stack_vectors(distributed, values, layout, rows) for values in (distributed.coefficient, distributed.response)
    )
    mutual = ends @ response[:, nodes.row * layout.width + nodes.station].T
    return csr_array(
        block_array([[ends @ node_compliance(nodes) @ ends.T, mutual], [mutual.T, coefficient @ response.T]])
    )


def build_workspace(kernel: KernelArrays, train: Train) -> Workspace:
    """Allocate the scratch arrays for one simulation."""
    return Workspace(
        panels=allocate_panel_workspace(kernel.panels),
        scalar=allocate_scalar_workspace(kernel.forces.settling.size),
        node=np.zeros(kernel.connectors.nodes.station.size),
        contact=allocate_contact_workspace(kernel.contact, kernel.connectors, kernel.distributed, train),
    )
