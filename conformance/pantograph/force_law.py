"""Force laws of pantographs: mean contact force, or applied forces, as a function of speed.

The two kinds differ in their unknown. With a law of the mean contact force, the uplift force is tuned until the mean
contact force meets it. With a law of the applied forces, static and aerodynamic force are given, and the mean contact
force is a result.
"""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NumberList,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)

FASTEST_KM_H = 600.0
"""Largest speed of a case [km/h]."""

LARGEST_FORCE_N = 2000.0
"""Largest uplift force or mean contact force of a case [N]."""

PointOfForce = Annotated[
    int | str | NumberList,
    Field(
        description="point of the aerodynamic force; chain: mass, as number from the base, from 1, or name; matrices "
        "and modes: displacement of the point per unit of each degree of freedom or mode"
    ),
]


class SpeedPolynomial(SourcedTable):
    """Force as a polynomial of the speed v: constant + linear v + quadratic v^2."""

    constant_N: Annotated[float, Field(ge=-LARGEST_FORCE_N, le=LARGEST_FORCE_N)] = 0.0
    """Force at speed 0 [N]."""
    linear_N_h_km: Annotated[float, Field(ge=-100, le=100)] = 0.0
    """Factor of the speed [N per km/h]."""
    quadratic_N_h2_km2: Annotated[float, Field(ge=-1, le=1)] = 0.0
    """Factor of the squared speed [N per (km/h)^2]."""
    above_km_h: Annotated[float, Field(ge=0, lt=FASTEST_KM_H)] = 0.0
    """Speed above which the law is valid [km/h]."""
    up_to_km_h: Annotated[float, Field(gt=0, le=FASTEST_KM_H)] = FASTEST_KM_H
    """Largest speed for which the law is valid [km/h]."""

    @cross_check
    def _has_a_range(self) -> Problems:
        if self.up_to_km_h <= self.above_km_h:
            yield validation_problem(
                "up_to_km_h",
                f"{self.up_to_km_h:g} km/h is not greater than above_km_h = {self.above_km_h:g} km/h",
                "Give the speeds between which the law is valid.",
            )

    def evaluate(self, speed_km_h: float) -> float:
        """Force [N] at a speed [km/h].

        Raises:
            LawInvalid: The law is not valid at this speed.
        """
        if not self.above_km_h < speed_km_h <= self.up_to_km_h:
            raise LawInvalid(
                f"the force law is valid above {self.above_km_h:g} km/h up to {self.up_to_km_h:g} km/h, "
                f"not at {speed_km_h:g} km/h"
            )
        return self.constant_N + self.linear_N_h_km * speed_km_h + self.quadratic_N_h2_km2 * speed_km_h**2


class LawInvalid(ValueError):
    """A force law gives no force at a speed; an extrapolated force would be an input without a source."""


class MeanForceLaw(SpeedPolynomial):
    """Law of the mean contact force; the uplift force is tuned to it."""

    kind: Literal["mean_force"]


class MeanForceRule(InputTable):
    """Law of the mean contact force: the largest mean force that a profile of the library accepts."""

    kind: Literal["mean_force_rule"]
    profile: Annotated[str, Field(min_length=1, max_length=100)]
    """Name of a profile with a formula for mean_force_N."""


class AerodynamicForce(SpeedPolynomial):
    """Mean aerodynamic force and its point of application."""

    on: PointOfForce


class AppliedForceLaw(SourcedTable):
    """Law of the applied forces: static force at `uplift_force_on` of the model, and aerodynamic force."""

    kind: Literal["applied_forces"]
    static_force_N: Annotated[float, Field(ge=0, le=LARGEST_FORCE_N)]
    """Static uplift force at every speed [N]."""
    aerodynamic_force: AerodynamicForce


ForceLaw = Annotated[MeanForceLaw | MeanForceRule | AppliedForceLaw, Field(discriminator="kind")]
"""Force law of a pantograph."""
