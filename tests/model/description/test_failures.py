"""Failures of the simulator: every impossible input raises a named failure, none passes silently."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, simple_line
from pantocheck.model import Dropper, MessengerSupport, Passage, SteadyArm, build_chain, simulate_passage
from pantocheck.model.description.failures import DidNotConverge
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.newmark import step
from pantocheck.model.dynamics.simulation import start_motion

PASSAGE = Passage((PANTOGRAPH_2002,), (20.0,), 50.0, 0.05, 1e-3)


@pytest.mark.parametrize(
    "part",
    [
        {"droppers": (Dropper(10.0, "messenger", "nowhere", stiffness=1e5),)},
        {"steady_arms": (SteadyArm(60.0, "nowhere", 300.0),)},
        {"messenger_supports": (MessengerSupport(60.0, "nowhere", 1.2, 5e4),)},
    ],
    ids=["dropper", "steady arm", "messenger support"],
)
def test_discretise_names_an_unknown_wire(part: dict[str, tuple[object, ...]]) -> None:
    """A connector on a wire that does not exist is an error."""
    line = simple_line()
    more = {name: getattr(line, name) + added for name, added in part.items()}
    with pytest.raises(KeyError, match="nowhere"):
        discretise(replace(line, **more), 1.0)


@pytest.mark.parametrize("where", ["uplift", "mass", "contact"])
def test_simulate_passage_fails_for_nan_in_a_pantograph(where: str) -> None:
    """The simulation raises DidNotConverge or rejects a matrix before; it never returns a history of NaN."""
    values = {"uplift": 120.0, "mass": 7.2, "contact": 50e3} | {where: np.nan}
    masses, stiffness, damping = np.array([15.0, values["mass"]]), np.array([50.0, 4200.0]), np.array([90.0, 10.0])
    pantograph = build_chain(masses, stiffness, damping, values["uplift"], 0, values["contact"])
    with pytest.raises((DidNotConverge, ValueError, np.linalg.LinAlgError)):
        simulate_passage(discretise(simple_line(), 1.0), replace(PASSAGE, pantographs=(pantograph,)))


@pytest.mark.parametrize("where", ["w", "r", "tension", "z", "contact", "far away"])
def test_step_reports_nan_in_the_state(where: str) -> None:
    """The kernel returns zero sweeps for NaN at any place of the state."""
    line = discretise(simple_line(), 1.0)
    kernel = build_kernel_arrays(line, 1e-3)
    motion, train = start_motion(line, kernel, PASSAGE)
    spot = {
        "w": motion.w[0, 0, 20:21],
        "r": motion.r[1, 1, 20:21],
        "tension": motion.force[3:4],
        "z": train.z[0, 0, :1],
        "contact": train.contact[0, :1],
        "far away": motion.w[0, 0, kernel.layout.stations - 3 : kernel.layout.stations - 2],
    }
    spot[where][:] = np.nan
    work = build_workspace(kernel, train)
    assert step(kernel, motion, train, work) == 0
