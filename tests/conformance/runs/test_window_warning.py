"""Warning of an active window from whose edges waves return: it comes where the contact force changes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.resolution import smallest_reach

SMALLEST_M = 180
"""Half-width for 300 km/h over 360 m (4.32 s), with waves of 1.1 times 122 m/s on the messenger wire [m]."""


def limit_window(reach: float | None) -> Case:
    """Case of EN 50318:2002 at 300 km/h with a limited window, on a coarse mesh."""
    case = load_case(library_folder() / "en50318-2002" / "300.toml")
    changes = {"element_m": 1.5, "time_step_s": 0.002, "reach_m": reach}
    discretisation = case.file.discretisation.model_copy(update=changes)
    return replace(case, file=case.file.model_copy(update={"discretisation": discretisation}))


def run(reach: float | None) -> tuple[np.ndarray, list[str]]:
    """Contact force [N] and warnings on the window."""
    delivered = ReferenceSimulator().run_unrefined(limit_window(reach))
    assert delivered.record is not None
    return delivered.record.force[0], [text for text in delivered.warnings if text.startswith("active window")]


@pytest.mark.parametrize(("speed", "expected"), [(0.0, 500.0), (60.0, 320.0), (100.0, math.inf), (120.0, math.inf)])
def test_half_width_by_hand(speed: float, expected: float) -> None:
    """A wave of 100 m/s in 10 s: 500 m to and fro at rest; at 60 m/s 320 m, 8 s ahead and 2 s back."""
    assert smallest_reach(100.0, speed, 10.0) == pytest.approx(expected, rel=1e-12)
    if speed == 60.0:
        assert expected / (100 - speed) + expected / (100 + speed) == pytest.approx(10.0, rel=1e-12)


def test_narrow_window_changes_the_force_and_is_named() -> None:
    """Without a limit, and with the suitable one, the forces agree to rounding (1e-6 N) and nothing is said."""
    free, silence = run(None)
    narrow, (warning,) = run(60.0)
    assert np.abs(narrow - free).max() > 1.0
    assert "60 m from the train" in warning
    assert warning.endswith(f"Leave out reach_m, or set it to at least {SMALLEST_M}")
    suitable, none = run(float(SMALLEST_M))
    assert np.abs(suitable - free).max() < 1e-6
    assert (silence, none) == ([], [])


def test_window_that_holds_the_whole_line_is_not_named() -> None:
    """The line is 600 m long."""
    assert run(600.0)[1] == []
