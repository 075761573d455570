"""Lift force of a pantograph in a case: applied forces, or a mean contact force to which the uplift force is tuned."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.sourced_table import NO_TRUST
from pantocheck.conformance.pantograph.force_law import (
    LARGEST_FORCE_N,
    AppliedForceLaw,
    LawInvalid,
    MeanForceLaw,
    MeanForceRule,
)
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

if TYPE_CHECKING:
    from pantocheck.conformance.cases.case_file import PantographByLaw, PantographUse


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


def resolve_lift_force(use: "PantographUse | PantographByLaw", file: PantographFile, speed_km_h: float) -> LiftForce:
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
    from pantocheck.conformance.cases.case_file import PantographUse

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


# Named rules of the mean contact force: the formulas of the profiles of the library.
def resolve_rule(file: PantographFile, where: str) -> PantographFile:
    """Replace the name of a rule by its formula, with the trust and the source of the profile.

    Args:
        file: Content of a pantograph file.
        where: Name of the file in messages.

    Returns:
        The same content; a force law of the kind `mean_force_rule` becomes one of the kind `mean_force`.

    Raises:
        InputError: The library has no profile of this name, or the profile has no formula for the mean force.
    """
    if not isinstance(file.force_law, MeanForceRule):
        return file
    rules, name = list_mean_force_rules(), file.force_law.profile
    if name not in rules:
        raise InputError(
            f"{where}, key force_law.profile",
            f"no profile {name!r} of the library has a formula for mean_force_N",
            suggest_names(name, list(rules)),
        )
    return file.model_copy(update={"force_law": rules[name]})


def list_mean_force_rules() -> dict[str, MeanForceLaw]:
    """Largest mean contact force as a function of speed that each profile of the library accepts, by profile."""
    # Imported here: a list of cases whose pantographs name no rule is shown without profiles.
    from pantocheck.conformance.cases.profile_file import SpeedFormula, list_profiles, load_profile

    return {
        name: MeanForceLaw(
            kind="mean_force",
            constant_N=rule.upper.constant,
            quadratic_N_h2_km2=rule.upper.per_speed_squared,
            above_km_h=rule.upper.above_km_h or 0.0,
            trust=NO_TRUST if rule.trust == "own" else rule.trust,
            source=rule.source,
            note=f"rule of the profile {name}",
        )
        for name in list_profiles()
        for rule in load_profile(name).rule
        if rule.quantity == "mean_force_N" and isinstance(rule.upper, SpeedFormula)
    }
