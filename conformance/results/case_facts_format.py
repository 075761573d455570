"""Facts on a case in results.json: contact losses, events, derived values, inputs and forces of force laws."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.results_part import FiniteNumber, Owner, ResultsPart


class ContactLossFacts(ResultsPart):
    """Contact loss of a pantograph in its unfiltered force."""

    position_m: float
    """Position of the pantograph at the start of the loss [m]."""
    time_s: float
    """Time from the start of the analysis section [s]."""
    duration_s: float
    lowest_force_N: float


class DerivedFact(ResultsPart):
    """Value that follows from the inputs of a case or, for a tuned force, from its run."""

    name: str
    """Name of the value."""
    value: FiniteNumber
    unit: str
    """Unit; empty for a ratio."""
    basis: str
    """Inputs or formula from which the value follows."""


class StoredRange(ResultsPart):
    """Number of the values of a long list, and their range."""

    count: int
    lowest: FiniteNumber
    highest: FiniteNumber


StoredValue = bool | FiniteNumber | str | list[FiniteNumber | str] | StoredRange


StoredValues = Annotated[
    dict[str, StoredValue],
    Field(
        description="values by dotted key, with the unit at its end; of a list of tables, the values of a key in order"
    ),
]


class AppliedForceFacts(ResultsPart):
    """Applied forces of a pantograph; its mean contact force is a result."""

    kind: Literal["applied_forces"] = "applied_forces"
    static_force_N: FiniteNumber
    """Static force [N]."""
    aerodynamic_force_N: FiniteNumber
    """Aerodynamic force at the speed of the case [N]."""

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
    mean_force_N: FiniteNumber
    """Mean contact force at the speed of the case [N]."""

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


class EventFacts(ResultsPart):
    """Stretch of the line inside the analysis section; positions [m] in running direction."""

    kind: str
    name: str
    start_m: float
    end_m: float
    excluded: bool
    """Whether the statistics of the contact force leave it out."""
    remark: str = ""
    """Stated reason of the exclusion, or why it is not applied."""
