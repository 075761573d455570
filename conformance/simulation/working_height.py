"""Working height of the pantographs of a case: the static height of a head under its uplift force."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.simulation.pantograph_model import build_pantograph
from pantocheck.conformance.simulation.static_quantities import sample_span
from pantocheck.model import DiscretisedLine, Pantograph
from pantocheck.model.kept_results import keep_with_line
from pantocheck.model.statics.elasticity import static_uplift


def build_pantographs(case: Case, line: DiscretisedLine, uplift_forces: Sequence[float]) -> tuple[Pantograph, ...]:
    """Pantographs of a case, each with its working height under its uplift force [N]."""
    nominal = nominal_wire_height(case)
    return tuple(
        build_pantograph(file, force, compute_working_height(case, line, file, force), nominal, lift.aerodynamic_force)
        for file, lift, force in zip(case.pantographs, case.lift_forces, uplift_forces, strict=True)
    )


def working_height_positions(case: Case) -> RealArray:
    """Positions of the mean uplift for the working height: those of the first span of the analysis section [m]."""
    return sample_span(*case.line.geometry.span(case.analysed_spans[0]))


def nominal_wire_height(case: Case) -> float:
    """Nominal height of the contact wire at the same positions [m].

    It is the mean of the straight lines between the supports, in an overlap of those of the lowest wire.
    """
    positions = working_height_positions(case)
    rises = [case.line.lowest_rise(float(x)) for x in positions]
    return float(case.line.layout.chord_height(positions).mean() + np.mean(rises))


def compute_working_height(case: Case, line: DiscretisedLine, file: PantographFile, uplift_force: float) -> float:
    """Static height of a head under its uplift force: nominal height of the wire, mean uplift, and contact spring [m].

    The pre-sag of the line at rest is left out.

    Args:
        case: Case with a speed.
        line: Line of the case.
        file: Pantograph.
        uplift_force: Its uplift force [N].
    """
    uplift = mean_static_uplift(line, tuple(working_height_positions(case).tolist()), uplift_force)
    return nominal_wire_height(case) + (uplift + uplift_force / file.contact.stiffness_N_m)


@keep_with_line
def mean_static_uplift(line: DiscretisedLine, positions: tuple[float, ...], force: float) -> float:
    """Mean uplift under a static force [N] at each of some positions in turn [m]."""
    return float(static_uplift(line, np.array(positions), force).mean())
