"""Alternative force laws of slack droppers."""

from dataclasses import replace

import numpy as np

from pantocheck.model.discretised_line import DiscretisedLine


def with_viscous_part_kept(line: DiscretisedLine) -> DiscretisedLine:
    """Let the dashpots of the droppers act in both directions, whether slack or not; only the elastic force unilateral.

    By default a slack dropper carries no force. In a code that keeps the damping matrix constant and compensates only
    the elastic force, the dashpot of a slack dropper still acts.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.

    Returns
    -------
    DiscretisedLine
        Line with a separate dashpot beside each dropper.
    """
    connectors = line.connectors
    unilateral = connectors.unilateral
    count = int(unilateral.sum())
    zeros = np.zeros(count)
    separated = connectors._replace(
        station=np.append(connectors.station, connectors.station[unilateral]),
        coefficient=np.concatenate([connectors.coefficient, connectors.coefficient[unilateral]]),
        stiffness=np.append(connectors.stiffness, zeros),
        damping=np.append(np.where(unilateral, 0.0, connectors.damping), connectors.damping[unilateral]),
        preload=np.append(connectors.preload, zeros),
        unilateral=np.append(unilateral, np.zeros(count, dtype=np.bool_)),
    )
    return replace(line, connectors=separated)
