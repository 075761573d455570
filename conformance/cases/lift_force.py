"""Lift force of a pantograph in a case: applied forces, or a mean contact force to which the uplift force is tuned."""

from dataclasses import dataclass

from pantocheck.conformance.cases.case_file import PantographByLaw, PantographUse
from pantocheck.conformance.cases.force_law import LARGEST_FORCE_N, AppliedForceLaw, LawInvalid, MeanForceLaw
from pantocheck.conformance.cases.pantograph_file import PantographFile


@dataclass(frozen=True)
class AppliedForces:
    """Given forces on a pantograph; its mean contact force is a result."""

    static_force: float
    """Force at the point of the uplift force [N]."""
    aerodynamic_force: float = 0.0
    """Mean aerodynamic force at a point of its own [N]; 0 if the static force includes it."""

    @property
    def uplift_force(self) -> float:
        """Sum of both forces [N]."""
        return self.static_force + self.aerodynamic_force

    @property
    def stated_uplift_force(self) -> float:
        """Uplift force of every run [N]."""
        return self.uplift_force

    @property
    def target_mean_force(self) -> None:
        """None: the uplift force is not tuned."""
        return


@dataclass(frozen=True)
class TunedForce:
    """Mean contact force to which the uplift force is tuned."""

    target_mean_force: float
    """Mean contact force over the analysis section [N]."""
    stated_uplift_force: float | None = None
    """Start value of the tuning [N]; None: not stated."""

    @property
    def aerodynamic_force(self) -> float:
        """0: the whole uplift force acts at one point [N]."""
        return 0.0

    @property
    def uplift_force(self) -> float:
        """Stated start value of the tuning; without one, the mean contact force [N]."""
        return self.stated_uplift_force or self.target_mean_force


LiftForce = AppliedForces | TunedForce
"""Lift force of a pantograph in a case."""


def resolve_lift_force(use: PantographUse | PantographByLaw, file: PantographFile, speed_km_h: float) -> LiftForce:
    """Lift force of a pantograph, stated in the case or from the force law of the pantograph.

    Args:
        use: Pantograph of the case.
        file: Content of its file; a rule of a profile is replaced by its formula.
        speed_km_h: Speed of the case [km/h].

    Returns:
        Applied forces, or a mean contact force.

    Raises:
        LawInvalid: The pantograph has no force law, or its law gives no force at this speed.
    """
    if isinstance(use, PantographUse):
        if use.target_mean_force_N is not None:
            return TunedForce(use.target_mean_force_N, use.uplift_force_N)
        return AppliedForces(use.uplift_force_N or 0.0)
    law = file.force_law
    if isinstance(law, AppliedForceLaw):
        forces = AppliedForces(law.static_force_N, law.aerodynamic_force.evaluate(speed_km_h))
        _check_range(forces.uplift_force, speed_km_h)
        return forces
    if isinstance(law, MeanForceLaw):
        mean_force = law.evaluate(speed_km_h)
        _check_range(mean_force, speed_km_h)
        return TunedForce(mean_force)
    raise LawInvalid("the pantograph file has no table [force_law]")


def _check_range(force: float, speed_km_h: float) -> None:
    if not 0 < force <= LARGEST_FORCE_N:
        raise LawInvalid(
            f"the force law gives {force:.4g} N at {speed_km_h:g} km/h, outside 0 to {LARGEST_FORCE_N:g} N"
        )
