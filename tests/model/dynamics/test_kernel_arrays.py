"""Kernel arrays: nested arrays of the time step of a line."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, Array, bare_wire, fix_along_track, simple_line
from pantocheck.model import Catenary, Kind, ModalBand, Passage, discretise
from pantocheck.model.dynamics.active_window import Window, build_window_arrays, max_wave_speed
from pantocheck.model.dynamics.block_tridiagonal import solve_wires
from pantocheck.model.dynamics.inverse_columns import column_half_width
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.train import build_empty_train

PASSAGE = Passage((PANTOGRAPH_2002,), (70.0,), 50.0, 1.0, 1e-3, kept_behind=60.0, reach=50.0)


def leaves(arrays: tuple[object, ...]) -> list[Array]:
    """All arrays of nested named tuples."""
    nested = [leaves(value) if isinstance(value, tuple) else [np.asarray(value)] for value in arrays]
    return [array for part in nested for array in part]


@pytest.mark.parametrize("catenary", [simple_line(damping=DAMPED), fix_along_track(simple_line(damping=DAMPED))])
def test_kernel_arrays_are_contiguous_and_finite(catenary: Catenary) -> None:
    """The compiled step is specialised for contiguous arrays; another layout would compile it a second time."""
    line = discretise(catenary, 1.0)
    window = build_window_arrays(line, PASSAGE)
    # The window of held stretches is infinite on purpose.
    for array in leaves(build_kernel_arrays(line, 1e-3, window)._replace(window=window)):
        assert array.flags.c_contiguous
        assert array.dtype == np.bool_ or np.isfinite(array).all()


def test_self_compliance_is_the_response_of_a_connector_to_its_own_tension() -> None:
    """A unit tension on one dropper, solved on the whole line; the column is cut at 1e-12 of its peak."""
    line = discretise(simple_line(damping=DAMPED), 1.0)
    kernel = build_kernel_arrays(line, 1e-3)
    number = 4
    station, coefficient = line.connectors.station[number], line.connectors.coefficient[number]
    w, r = np.zeros(line.beams.free.shape[:2]), np.zeros(line.beams.free.shape[:2])
    w[:, station] = coefficient
    solve_wires(kernel.factor, kernel.wires.extents, Window(0, w.shape[1] - 1), w, r)
    response = kernel.connectors.tension_per_acceleration[number] * (coefficient @ w[:, station])
    assert kernel.connectors.self_compliance[number] == pytest.approx(response, rel=1e-10)


def test_columns_reach_far_enough_for_every_contact_wire() -> None:
    """Two contact wires without connectors; waves on the second one are 12 times as fast, and its columns wider.

    The first station is an anchor, where a force has no column.
    """
    slow = replace(bare_wire(60.0, 5e3, 10.0).wires[0], name="a")
    fast = replace(bare_wire(60.0, 40e3, 0.5).wires[0], name="b")
    for wires in ((slow, fast), (fast, slow)):
        line = discretise(replace(bare_wire(60.0), wires=wires), 0.25)
        kernel = build_kernel_arrays(line, 2e-3)
        loads = [(row, s) for row in line.contact_rows for s in range(line.mesh.position.size)]
        width = kernel.contact.columns.shape[-1] // 2
        assert width == column_half_width(kernel.factor, loads)
        assert width > column_half_width(kernel.factor, [(line.mesh.row_of["a", "z"], s) for _, s in loads])


def test_modal_damping_makes_the_whole_line_active() -> None:
    """A mode moves every station, so the active window must not be limited; without modes it is."""
    line = discretise(simple_line(damping=dict.fromkeys(Kind, DAMPED[Kind.DROPPER])), 2.0)
    modal = replace(line, catenary=replace(line.catenary, modal_damping=(ModalBand(0.8, 1.5, 0.02),)))
    limits = build_window_arrays(line, PASSAGE)
    limited, whole = (build_kernel_arrays(variant, 1e-3, limits).window for variant in (line, modal))
    assert (limited.reach, limited.wave_speed, limited.whole_line) == (50.0, max_wave_speed(line), False)
    assert whole.whole_line


def test_workspace_fits_the_kernel_arrays() -> None:
    """One predicted tension per connector, one velocity per mode, no contact without a pantograph."""
    kernel: KernelArrays = build_kernel_arrays(discretise(simple_line(), 1.0), 1e-3)
    work = build_workspace(kernel, build_empty_train(1))
    assert work.tension.size == kernel.connectors.station.size == 18
    assert work.modal_velocity.size == 0
    assert work.contact.shape.shape == (0, 1, 4)
