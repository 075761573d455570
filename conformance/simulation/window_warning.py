"""Active window of a passage: warning where waves that its edges reflect return to a pantograph."""

import math

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.model import DiscretisedLine
from pantocheck.model.discretised_line import max_wave_speed


def smallest_reach(wave_speed: float, speed: float, duration: float) -> float:
    """Smallest half-width of an active window from whose edges no wave returns before the end of a run.

    A wave of speed c needs the time R / (c - v) to get R ahead of a pantograph of speed v, and R / (c + v) to return
    from there; behind the pantograph the two are exchanged.

    Args:
        wave_speed: Speed of the fastest wave [m/s].
        speed: Speed of the pantographs [m/s].
        duration: Simulated time [s].

    Returns:
        Half-width [m]; infinite for a train faster than the waves.
    """
    c, v = wave_speed, speed
    return duration * (c * c - v * v) / (2 * c) if v < c else math.inf


def window_warnings(case: Case, line: DiscretisedLine, discretisation: Discretisation) -> tuple[str, ...]:
    """Warn of an active window (`reach_m`) from whose edges waves return; none without a limited window.

    Args:
        case: Case with a speed.
        line: Line of the case.
        discretisation: Discretisation with the half-width of the window.
    """
    reach, length = discretisation.reach_m, float(line.mesh.position[-1] - line.mesh.position[0])
    smallest = smallest_reach(max_wave_speed(line), case.speed, (case.end - case.start) / case.speed)
    if reach is None or reach >= min(smallest, length):
        return ()
    return (
        f"active window: its edges, {reach:g} m from the train, reflect waves that return before the end of the run "
        f"and change the contact force. Leave out reach_m, or set it to at least {math.ceil(min(smallest, length))}",
    )
