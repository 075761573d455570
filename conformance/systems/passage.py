"""From a case to the reference simulator's terms: its pantographs, and where they run."""

import numpy as np
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.pantograph import Pantograph as PantographFile
from pantocheck.model import Discretised, Pantograph, chain


def pantograph(file: PantographFile, uplift_force: float, working_height: float) -> Pantograph:
    """A pantograph pressing with an uplift force.

    Parameters
    ----------
    file : as read
    uplift_force : [N]
    working_height : of the head over the contact wire at the supports, at rest and pressing with that force [m]

    Returns
    -------
    the pantograph in the simulator's terms
    """
    parts = file.chain
    return chain(
        np.array(parts.masses_kg),
        np.array(parts.stiffness_N_m),
        np.array(parts.damping_N_s_m),
        uplift_force,
        parts.uplift_mass,
        file.contact.stiffness_N_m,
        working_height if parts.base_spring_unstretched == "working_height" else 0.0,
    )


def starts(case: Case) -> tuple[float, ...]:
    """Where each pantograph starts, the leading one first [m]."""
    return tuple(case.start + case.offsets[-1] - offset for offset in case.offsets)


def watched_supports(case: Case, line: Discretised) -> tuple[tuple[str, float], ...]:
    """The first contact wire at the supports within and at the ends of the evaluated stretch."""
    first, last = case.evaluated
    wire = line.catenary.contact_wires[0].name
    return tuple(
        (wire, arm.position)
        for arm in line.catenary.steady_arms
        if arm.wire == wire and first - 1e-6 <= arm.position <= last + 1e-6
    )
