"""Contact in a time step: compiled shape functions against `beam.shape`."""

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, simple_line
from pantocheck.model import Passage, discretise
from pantocheck.model.dynamics.contact_step import predict_train
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
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
