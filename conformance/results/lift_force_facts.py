"""Forces that the force laws of pantographs give at the speed of a case, in results.json and in words."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import AppliedForces, LiftForce
from pantocheck.conformance.results.results_part import FiniteNumber, Owner, ResultsPart


class AppliedForceFacts(ResultsPart):
    """Applied forces of a pantograph; its mean contact force is a result."""

    kind: Literal["applied_forces"] = "applied_forces"
    static_force_N: Annotated[FiniteNumber, Field(description="static force [N]")]
    aerodynamic_force_N: Annotated[FiniteNumber, Field(description="aerodynamic force at the speed of the case [N]")]

    @property
    def text(self) -> str:
        """Both forces and their sum, in words."""
        total = self.static_force_N + self.aerodynamic_force_N
        return (
            f"applied forces of {total:.2f} N: static force {self.static_force_N:.2f} N, aerodynamic force "
            f"{self.aerodynamic_force_N:.2f} N; not tuned, the mean contact force is a result"
        )


class MeanForceFacts(ResultsPart):
    """Mean contact force to which the uplift force of a pantograph is tuned."""

    kind: Literal["mean_force"] = "mean_force"
    mean_force_N: Annotated[FiniteNumber, Field(description="mean contact force at the speed of the case [N]")]

    @property
    def text(self) -> str:
        """Mean contact force in words."""
        return f"mean contact force of {self.mean_force_N:.2f} N; the uplift force is tuned to it"


LiftForceFacts = Annotated[AppliedForceFacts | MeanForceFacts, Field(discriminator="kind")]

LawForces = Annotated[
    dict[Owner, LiftForceFacts],
    Field(
        exclude_if=lambda forces: not forces,
        description="forces of the pantographs whose force law applies, at the speed of the case",
    ),
]
"""Forces by the number of the pantograph as text."""


def list_law_forces(case: Case) -> dict[Owner, AppliedForceFacts | MeanForceFacts]:
    """Forces of the pantographs of a case whose force law applies, by the number of the pantograph as text."""
    return {str(number): _describe_lift_force(lift) for number, lift in case.law_forces.items()}


def _describe_lift_force(lift: LiftForce) -> AppliedForceFacts | MeanForceFacts:
    if isinstance(lift, AppliedForces):
        return AppliedForceFacts(static_force_N=lift.static_force, aerodynamic_force_N=lift.aerodynamic_force)
    return MeanForceFacts(mean_force_N=lift.target_mean_force)
