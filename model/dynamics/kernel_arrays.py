"""From a line in finite elements to the arrays that the time step works on."""

import math
from typing import NamedTuple

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.active_window import max_wave_speed
from pantocheck.model.dynamics.block_tridiagonal import column_half_width, factorise, inverse_columns, solve_rows
from pantocheck.model.dynamics.state import KernelArrays
from pantocheck.model.fem.beams import Beams, element_stiffness
from pantocheck.model.fem.residual_flexibility import condensed_bubbles
from pantocheck.model.modal.modal_damping import build_modal_terms


class Load(NamedTuple):
    """Where an external vertical load acts.

    Parameters
    ----------
    row, station : int
        Indices.
    """

    row: int
    station: int


def build_kernel_arrays(
    line: DiscretisedLine, time_step: float, reach: float = math.inf, load: Load | None = None
) -> KernelArrays:
    """Arrays of the time step: factors, local columns, connectors.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    time_step : float
        [s].
    reach : float
        What lies farther than this from every pantograph, or no wave has come to yet, is left standing still; all moves
        where it is infinite [m].
    load : Load or None
        Where the external load acts, if there is one.

    Returns
    -------
    KernelArrays
        What `newmark.step` needs of the line.
    """
    beams, connectors, stations = line.beams, line.connectors, line.mesh.position.size
    factor = factorise(beams, time_step)
    modal = build_modal_terms(line)
    response = solve_rows(factor, modal.weight)
    if modal.damping.size:
        reach = math.inf  # a mode moves the whole line
    ends = [np.flatnonzero(coefficient) for coefficient in connectors.coefficient]
    most = max((len(e) for e in ends), default=0)
    end_row, end_column = (np.zeros((len(ends), most), dtype=np.int64) for _ in range(2))
    end_coefficient = np.zeros((len(ends), most))
    loads: list[tuple[int, int]] = []
    for n, rows in enumerate(ends):
        for e, row in enumerate(rows):
            end_row[n, e], end_column[n, e], end_coefficient[n, e] = row, len(loads), connectors.coefficient[n, row]
            loads.append((int(row), int(connectors.station[n])))
    contact_row = np.array(line.contact_rows, dtype=np.int64)
    contact_loads = [(int(row), s) for row in contact_row for s in range(stations)]
    width = column_half_width(factor, loads + contact_loads[:: max(1, stations // 200)])
    rows_, stations_ = (np.array([load[i] for load in loads], dtype=np.int64) for i in range(2))
    columns = inverse_columns(factor, rows_, stations_, np.zeros_like(rows_), width)
    lumped = np.nonzero((beams.lumped_stiffness != 0) | (beams.lumped_damping != 0))
    gain = time_step**2 / 4 * connectors.stiffness + time_step / 2 * connectors.damping
    contact = np.repeat(np.array(contact_loads, dtype=np.int64).reshape(-1, 2), 2, axis=0)
    slopes = np.tile(np.arange(2), len(contact_loads))
    contact_columns = inverse_columns(factor, contact[:, 0].copy(), contact[:, 1].copy(), slopes, width)
    return KernelArrays(
        time_step=time_step,
        reach=reach,
        front=max_wave_speed(line) if math.isfinite(reach) else math.inf,
        position=line.mesh.position,
        length=beams.length,
        stiffness_entries=_stiffness_entries(beams),
        damping_mass=beams.mass_coefficient[:, None] * beams.mass_per_length * beams.length / 420,
        mass_coefficient=beams.mass_coefficient,
        stiffness_coefficient=beams.stiffness_coefficient,
        lumped_row=lumped[0],
        lumped_station=lumped[1],
        lumped_stiffness=beams.lumped_stiffness[lumped],
        lumped_damping=beams.lumped_damping[lumped],
        factor=factor,
        columns=columns,
        station=connectors.station,
        end_row=end_row,
        end_column=end_column,
        end_coefficient=end_coefficient,
        stiffness=connectors.stiffness,
        damping=connectors.damping,
        preload=connectors.preload,
        gain=gain,
        yielding=gain * (end_coefficient**2 * columns[end_column, 0, width]).sum(axis=1),
        unilateral=connectors.unilateral,
        contact_row=contact_row,
        bubble=_bubbles(beams, line.contact_rows),
        contact_columns=contact_columns.reshape(contact_row.size, stations, 2, 2, 2 * width),
        modal_damping=modal.damping,
        modal_weight=_fields_first(modal.weight),
        modal_response=_fields_first(response),
        modal_compliance=np.einsum("jbsi,jbsi->j", modal.weight, response),
        load_row=0 if load is None else load.row,
        load_station=0 if load is None else load.station,
        rest=np.ascontiguousarray(line.state.deflection[line.contact_rows]),
    )


def _fields_first(shapes: Array) -> Array:
    """(n, rows, stations, 2) as (n, 2, rows, stations), along which the time step runs."""
    return np.ascontiguousarray(np.moveaxis(shapes, -1, 1))


def _stiffness_entries(beams: Beams) -> Array:
    """What every element's stiffness is made of: entries 11, 12, half the sum and half the difference of 22 and 24."""
    matrices = np.array([element_stiffness(beams, row) for row in range(len(beams.mass_per_length))])
    k11, k12, k22, k24 = (matrices[:, :, i, j] for i, j in ((0, 0), (0, 1), (1, 1), (1, 3)))
    return np.stack([k11, k12, (k22 + k24) / 2, (k22 - k24) / 2], axis=1)


def _bubbles(beams: Beams, rows: list[int]) -> Array:
    """Flexibility of the elements of the contact wires between their stations; alike elements are worked out once."""
    known: dict[tuple[float, float, float], Array] = {}
    bubbles = np.zeros((len(rows), beams.length.size, 6))
    for k, row in enumerate(rows):
        for e in np.flatnonzero(beams.mass_per_length[row]):
            data = (float(beams.length[e]), float(beams.tension[row, e]), float(beams.bending_stiffness[row, e]))
            key = (round(data[0], 9), *data[1:])
            if key not in known:
                known[key] = condensed_bubbles(*data)
            bubbles[k, e] = known[key]
    return bubbles
