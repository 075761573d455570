"""Contact in a time step: compiled shape functions against `beam.shape`, convergence of the contact forces."""

import numpy as np
import pytest

from helpers.effective_inverse import inverse_of_assembled
from helpers.lines import DAMPED, PANTOGRAPH_2002, bare_wire, simple_line
from pantocheck.model import Passage, discretise
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.contact_step import accelerate_contacts, predict_train
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.statics.assembly import bandwidth_order, point_load


@pytest.mark.parametrize("position", [20.0, 20.3, 33.7])
def test_contact_step_uses_the_hermite_functions_of_the_beam(position: float) -> None:
    """The kernel repeats the formulas of `beam.shape`; rounding only."""
    line, passage = discretise(simple_line(), 0.7), Passage((PANTOGRAPH_2002,), (position,), 50.0, 1e-3, 1e-3)
    kernel = build_kernel_arrays(line, passage.time_step)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    predict_train(kernel.contact, motion, train, work.contact)
    element, length, s = find_element(line.mesh.position, position + passage.speed * passage.time_step)
    assert work.contact.element[0] == element
    np.testing.assert_allclose(work.contact.shape[0, 0], beam.shape(s, length), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("position", [20.0, 20.3, 20.5])
def test_contacts_on_one_wire_settle_in_the_first_sweep(position: float) -> None:
    """The compliance is exact, and a step does not carry a force over 40 m: the second sweep changes no force."""
    line, time_step = discretise(bare_wire(100.0), 1.0), 1e-3
    passage = Passage((PANTOGRAPH_2002, PANTOGRAPH_2002), (position + 40.0, position), 60.0, time_step, time_step)
    kernel = build_kernel_arrays(line, time_step)
    motion, train = start_motion(line, kernel, passage)
    work = build_workspace(kernel, train)
    train.z[1, :, 0] = 0.5
    sweeps, forces = [], []
    for _ in range(40):
        sweeps.append(step(kernel, motion, train, work))
        forces.append(train.contact[:, 0].copy())
    assert np.ptp(forces, axis=0).min() > 10
    assert np.min(forces) > 0
    assert max(sweeps) == 2


def test_contacts_influence_each_other_and_the_connectors_by_the_assembled_inverse() -> None:
    """Two heads 3 m apart beside a dropper, elements of 1 m; the local columns are cut at 1e-12 of their peaks."""
    line, dt = discretise(simple_line(damping=DAMPED), 1.0), 2e-3
    passage = Passage((PANTOGRAPH_2002, PANTOGRAPH_2002), (31.3, 28.4), 50.0, dt, dt)
    kernel = build_kernel_arrays(line, dt)
    motion, train = start_motion(line, kernel, passage)
    work, window = build_workspace(kernel, train), Window(0, kernel.layout.width - 1)
    predict_train(kernel.contact, motion, train, work.contact)
    accelerate_contacts(kernel.contact, kernel.connectors, kernel.distributed, motion, work.contact, window)
    shapes = np.array([point_load(line, line.contact_rows[0], x) for x in train.position])
    shapes = shapes[:, np.argsort(bandwidth_order(line))].reshape(2, *line.beams.free.shape)
    response = np.einsum("nrsabcd,pbcd->pnrsa", inverse_of_assembled(line, dt)[None], shapes, optimize=True)[:, 0]
    np.testing.assert_allclose(
        work.contact.wire_compliance[:, :, 0], np.einsum("prsa,qrsa->pq", response, shapes), rtol=1e-10
    )
    connectors, influence = line.connectors, np.zeros((2, line.connectors.station.size))
    for p in range(2):
        number = work.contact.number_near[p, 0]
        np.add.at(influence[p], work.contact.near[p, 0, :number], work.contact.influence[p, 0, :number])
    at_connectors = response[:, :, connectors.station, 0].transpose(0, 2, 1)
    expected = np.einsum("nr,pnr->pn", connectors.coefficient, at_connectors)
    np.testing.assert_allclose(influence, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    assert (np.abs(influence).max(axis=1) > 1e-3).all()
    forces = np.stack([motion.w[2], motion.r[2]], axis=-1)[:, : line.mesh.position.size]
    acceleration = np.einsum("prsa,rsa->p", response, forces)
    np.testing.assert_allclose(work.contact.wire_acceleration[:, 0], acceleration, rtol=1e-10)
