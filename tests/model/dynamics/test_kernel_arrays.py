"""Kernel arrays: nested arrays of the time step of a line."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, Array, bare_wire, fix_along_track, simple_line
from pantocheck.model import Catenary, Kind, ModalBand, Passage, discretise, simulate_passage
from pantocheck.model.discretisation.discretised_line import max_wave_speed
from pantocheck.model.dynamics.active_window import build_window_arrays
from pantocheck.model.dynamics.connector_step import column_half_width
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.train import build_empty_train
from pantocheck.model.dynamics.vectors import ALIGNMENT, LANES

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
    for array in leaves(build_kernel_arrays(line, 1e-3, window)):
        assert array.flags.c_contiguous
        assert array.dtype == np.bool_ or np.isfinite(array).all()


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
        factor, width = kernel.contact.factor, kernel.contact.half_width
        assert width == column_half_width(factor, loads)
        assert width > column_half_width(factor, [(line.mesh.row_of["a", "z"], s) for _, s in loads])


def test_modal_damping_makes_the_whole_line_active() -> None:
    """A mode moves every station, so the active window must not be limited; without modes it is."""
    line = discretise(simple_line(damping=dict.fromkeys(Kind, DAMPED[Kind.DROPPER])), 2.0)
    modal = replace(line, catenary=replace(line.catenary, modal_damping=(ModalBand(0.8, 1.5, 0.02),)))
    limited, whole = (build_window_arrays(variant, PASSAGE) for variant in (line, modal))
    assert (limited.reach, limited.wave_speed, limited.whole_line) == (50.0, max_wave_speed(line), False)
    assert (whole.whole_line, whole.guard) == (True, 0.0)


def test_workspace_fits_the_kernel_arrays() -> None:
    """One predicted tension per connector, one acceleration per node, no contact without a pantograph."""
    kernel: KernelArrays = build_kernel_arrays(discretise(simple_line(), 1.0), 1e-3)
    work = build_workspace(kernel, build_empty_train(1))
    assert work.scalar.predicted.size == kernel.connectors.station.size == 18
    assert work.node.size == kernel.connectors.nodes.station.size == 36
    assert work.contact.shape.shape == (0, 1, 4)


def test_rows_of_a_motion_are_whole_panels_longer_than_a_column() -> None:
    """A column or a vector that begins on the line must end within its row; vectors are aligned with the cache."""
    kernel = build_kernel_arrays(discretise(simple_line(), 1.0), 1e-3)
    layout, panel = kernel.layout, kernel.panels.piece * LANES
    assert layout.width % panel == 0
    assert layout.width >= layout.stations + kernel.connectors.nodes.column.shape[2]
    for array in (kernel.wires.elements, kernel.panels.link, kernel.panels.inverse, kernel.connectors.nodes.column):
        assert array.ctypes.data % ALIGNMENT == 0


def test_simulations_share_the_arrays_of_a_line_without_changing_them() -> None:
    """Passages at two speeds, with two pantographs and one: the same forces as on lines of their own, bit by bit."""
    line = discretise(simple_line(3, damping=DAMPED), 2.0)
    twin = Passage((PANTOGRAPH_2002,) * 2, (70.0, 50.0), 40.0, 0.5, 2e-3, kept_behind=60.0, reach=50.0)
    passages = (twin, replace(twin, speed=60.0), replace(twin, pantographs=(PANTOGRAPH_2002,), start=(60.0,)))
    shared = build_kernel_arrays(line, twin.time_step)
    before = [array.copy() for array in leaves(shared)]
    for passage in passages:
        alone = simulate_passage(replace(line), passage)
        np.testing.assert_array_equal(simulate_passage(line, passage).force, alone.force)
    assert all(np.array_equal(array, copy) for array, copy in zip(leaves(shared), before, strict=True))
    assert build_kernel_arrays(line, twin.time_step, build_window_arrays(line, twin)).panels is shared.panels
    assert build_kernel_arrays(line, 1e-3).panels is not shared.panels
