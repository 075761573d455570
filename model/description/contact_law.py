"""Contact laws of head and wire: penetration under a contact force.

 law          penetration under F >= 0          parameters
 spring       F / k                             stiffness k; a damper beside it may act as well
 Hertz        (F / K)^(2/3)                     coefficient K
 constraint   0                                 none

The laws are one: a stiffness or a coefficient that a law does not have is infinite. Without penetration, F is
complementary to the gap of head and wire. In a time step the residual flexibility of the wire acts in series with all.
"""

import math
from typing import TypeVar

import numpy as np

from pantocheck.model.description.arrays import Array

Force = TypeVar("Force", float, Array)


def penetration(stiffness: float, hertz_coefficient: float, force: Force) -> Force:
    """Penetration under a constant contact force [m].

    Args:
        stiffness: Stiffness of the spring, or infinite [N/m].
        hertz_coefficient: Coefficient of Hertz's law, or infinite [N/m^1.5].
        force: Contact force, or (n,) forces [N].
    """
    hertz: Force = np.maximum(force / hertz_coefficient, 0.0) ** (2 / 3)
    return force / stiffness + hertz


def contact_compliance(stiffness: float, hertz_coefficient: float, force: float) -> float:
    """Change of the penetration with the contact force, at a force [m/N]; for parameters see `penetration`."""
    return 1 / stiffness + (2 / 3 * penetration(math.inf, hertz_coefficient, force) / force if force > 0 else 0.0)


def hertz_law_coefficient(modulus: float, radius: float) -> float:
    """Coefficient K of Hertz's law F = K penetration^1.5 for two bodies that touch in a small circle [N/m^1.5].

    K = 4/3 E sqrt(R) (Johnson, Contact Mechanics, 1985, section 4.2). It holds for smooth, elastic bodies that do not
    conform: a new, round wire on a curved strip, not a worn wire. The circle is much smaller than R, and the force
    changes slowly against elastic waves in the bodies.

    Args:
        modulus: Effective modulus E, 1/E = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 [N/m2].
        radius: Effective radius R; of crossed cylinders R1 and R2 about sqrt(R1 R2) [m].
    """
    return 4 / 3 * modulus * math.sqrt(radius)
