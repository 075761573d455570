"""Exudyn: contact forces of two pantographs, integrated by a general multibody engine."""

import numpy as np

from pantocheck.model import Passage, build_chain, discretise, simulate_passage
from verification.guide.comparisons import compare_absolute
from verification.guide.guide_format import CheckedValue
from verification.guide.topics.bare_wires import build_short_line

RUNNING_PANTOGRAPH = build_chain(
    np.array([15.0, 7.2]), np.array([50.0, 4200.0]), np.array([90.0, 10.0]), 120.0, 0, 50e3
)
"""Pantograph of the EN 50318:2002 reference model."""

FORCE_TOLERANCE_N = 1e-6
"""Largest difference of a contact force [N]: the default tolerances of Exudyn's Newton method leave 1e-7 N."""


def compare_contact_forces() -> list[CheckedValue]:
    """Largest difference of the contact force of each pantograph over 0.4 s."""
    from verification.guide.peers.exudyn_engine import run_exudyn

    line = discretise(build_short_line(4), 1.0)
    passage = Passage((RUNNING_PANTOGRAPH,) * 2, (80.0, 50.0), 60.0, 0.4, 1e-3)
    ours = simulate_passage(line, passage).force
    theirs, _, _ = run_exudyn(line, passage)
    reason = "Newton's method of Exudyn with its default tolerances."
    return [
        compare_absolute(
            f"pantograph-{p}",
            f"largest difference of the contact force of pantograph {p}",
            "N",
            (float(np.abs(ours[p - 1] - theirs[p - 1]).max()), 0.0),
            FORCE_TOLERANCE_N,
            reason,
        )
        for p in (1, 2)
    ]
