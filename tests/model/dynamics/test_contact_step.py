"""Contact in a time step: compiled shape functions against `beam.shape`, convergence of the contact forces."""

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, bare_wire, simple_line
from pantocheck.model import Passage, discretise
from pantocheck.model.dynamics.contact_step import predict_train
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import find_element


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
