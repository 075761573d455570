"""Recording of steps: the time of a step that fails is named."""

import numpy as np
import pytest

from helpers.lines import PANTOGRAPH_2002, simple_line
from pantocheck.model import Passage
from pantocheck.model.description.failures import DidNotConverge
from pantocheck.model.discretisation.discretised_line import discretise
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.recording import allocate_recording, simulate_steps
from pantocheck.model.dynamics.simulation import start_motion

PASSAGE = Passage((PANTOGRAPH_2002,), (20.0,), 50.0, 0.05, 1e-3)


def test_time_of_the_step_that_fails_is_named() -> None:
    line = discretise(simple_line(), 1.0)
    kernel = build_kernel_arrays(line, 1e-3)
    load, recording = np.array([0.0, 0.0, np.nan, 0.0]), allocate_recording(line, (), 4, 1)
    with pytest.raises(DidNotConverge, match=r"time step at 0\.003 s after the start"):
        simulate_steps(kernel, *start_motion(line, kernel, PASSAGE), load, recording)
