"""Other laws of a slackening dropper than the one it has by itself."""

from dataclasses import replace

import numpy as np

from pantocheck.model.discretised_line import DiscretisedLine


def with_viscous_part_kept(line: DiscretisedLine) -> DiscretisedLine:
    """The line with its droppers' dashpots acting both ways, slack or not; only the elastic force slackens.

    By itself a slack dropper carries nothing at all. Where a code keeps the damping matrix constant and compensates the
    elastic force alone, the dashpot of a slack dropper goes on pulling and pushing.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.

    Returns
    -------
    DiscretisedLine
        The line, each dropper joined by a dashpot of its own.
    """
    own = line.connectors
    slackens = own.unilateral
    count = int(slackens.sum())
    nothing = np.zeros(count)
    connectors = own._replace(
        station=np.append(own.station, own.station[slackens]),
        coefficient=np.concatenate([own.coefficient, own.coefficient[slackens]]),
        stiffness=np.append(own.stiffness, nothing),
        damping=np.append(np.where(slackens, 0.0, own.damping), own.damping[slackens]),
        preload=np.append(own.preload, nothing),
        unilateral=np.append(slackens, np.zeros(count, dtype=np.bool_)),
    )
    return replace(line, connectors=connectors)
