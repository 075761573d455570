"""Bending stiffness of a worn contact wire.

   .---.
 /       \\      The wire is a solid round bar, worn flat from below: a circular segment with the half-angle a is
|    +    |     missing. The grooves for the clamps are left out, as is the different wear along a zigzag.
 \\ a/|\\a /
   '----'
"""

import math

import scipy


def worn_stiffness_share(wear_share: float) -> float:
    """Bending stiffness of a worn wire as a share of that of the new wire, about the horizontal axis.

    With the missing segment A = r2 (a - sin a cos a), its second moment about the centre of the circle
    I = r4/4 (a - sin a cos a + 2 sin3 a cos a) and its first moment Q = 2/3 r3 sin3 a, the worn section has the second
    moment pi r4/4 - I - Q2 / (pi r2 - A) about its own centroid.

    Args:
        wear_share: Missing share of the cross-section, from 0 to below 1 [-].

    Returns:
        Share of the bending stiffness [-].
    """
    segment = math.pi * wear_share
    angle = float(scipy.optimize.brentq(lambda a: a - math.sin(a) * math.cos(a) - segment, 0.0, math.pi, xtol=1e-14))
    missing = angle - math.sin(angle) * math.cos(angle)
    second_moment = (missing + 2 * math.sin(angle) ** 3 * math.cos(angle)) / 4
    first_moment = 2 / 3 * math.sin(angle) ** 3
    return (math.pi / 4 - second_moment - first_moment**2 / (math.pi - missing)) / (math.pi / 4)
