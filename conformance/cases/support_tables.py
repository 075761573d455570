"""Tables of a support: steady arm and messenger support, and the supports of a line that differ from the others."""

from typing import Annotated, Literal, TypeVar

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import Feature
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    SourcedTable,
    validation_problem,
)

SINGLE_SUPPORTS = Feature("single_supports")
"""Feature of values of single supports, in place of those of the line."""

MOST_SPANS = 1000
"""Largest number of spans of a line."""

Table = TypeVar("Table", bound=InputTable)

ARMS = Feature("steady_arms")
ARM_MASS = Feature("steady_arm_mass")
ARM_DAMPER = Feature("steady_arm_dampers")
PUSHING = Feature("pushing_steady_arms")
HELD = Feature("messenger_wire_held_along_track")

ArmStiffness = Annotated[
    float | None,
    Field(ge=0, le=1e7, description="vertical stiffness at the wire [N/m]; default: force of the arm / length"),
    ARMS,
]
StaticShare = Annotated[
    Literal["level", "none"],
    Field(
        description="weight of the contact wire on the arm at rest; level: as much as keeps the wire level at the "
        "support; none: no weight"
    ),
]
ArmLength = Annotated[float | None, Field(gt=0, le=5, description="length of the arm [m]"), ARMS]
ArmMass = Annotated[float, Field(ge=0, le=20, description="mass per length of the arm [kg/m]"), ARM_MASS]
ClampMass = Annotated[float, Field(ge=0, le=20, description="mass of a clamp [kg]")]
ArmDamper = Annotated[
    NonNegative, Field(le=1e6, description="vertical damper between wire and ground [N s/m]"), ARM_DAMPER
]
ArmAction = Annotated[
    Literal["pull", "push"],
    Field(description="kind of lateral force of the arm on the contact wire"),
    PUSHING,
]
SupportStiffness = Annotated[Positive, Field(le=1e10, description="vertical stiffness [N/m]")]
SupportDamper = Annotated[NonNegative, Field(description="vertical damper [N s/m]"), Feature("support_dampers")]
AlongTrack = Annotated[
    Literal["free", "fixed"],
    Field(
        description="motion of the messenger wire along the track at the supports; free: its tension is constant; "
        "fixed: its tension changes with its elongation between two supports"
    ),
    HELD,
]
Encumbrance = Annotated[
    float,
    Field(gt=0, le=5, description="vertical distance between messenger wire and contact wire at a support [m]"),
]
SignedStagger = Annotated[float, Field(ge=-1, le=1, description="lateral position, as built [m]")]
Height = Annotated[
    float, Field(ge=-20, le=20, description="height of the contact wire above a datum, for example the rail [m]")
]


class SteadyArmTable(SourcedTable):
    """Steady arm, which holds the contact wire at a support."""

    vertical_stiffness_N_m: ArmStiffness = None
    static_share: StaticShare
    length_m: ArmLength = None
    mass_kg_m: ArmMass = 0.0
    clamp_kg: Annotated[ClampMass, ARM_MASS] = 0.0
    vertical_damper_N_s_m: ArmDamper = 0.0
    acts: ArmAction = "pull"

    @cross_check
    def _check_stiffness(self) -> Problems:
        if self.vertical_stiffness_N_m is None and self.length_m is None:
            yield validation_problem(
                "vertical_stiffness_N_m",
                "the steady arm has neither a stiffness nor a length",
                "Give vertical_stiffness_N_m, or length_m for a stiffness of force / length.",
            )


class MessengerSupportTable(SourcedTable):
    """Support of the messenger wire: a vertical spring and damper."""

    stiffness_N_m: SupportStiffness
    damping_N_s_m: SupportDamper = 0.0
    along_track: AlongTrack = "free"


class SteadyArmChanges(InputTable):
    """Values of the steady arm at one support that differ from the table steady_arm of the line."""

    vertical_stiffness_N_m: ArmStiffness = None
    static_share: Annotated[StaticShare | None, SINGLE_SUPPORTS] = None
    length_m: ArmLength = None
    mass_kg_m: Annotated[ArmMass | None, ARM_MASS] = None
    clamp_kg: Annotated[ClampMass | None, ARM_MASS] = None
    vertical_damper_N_s_m: Annotated[ArmDamper | None, ARM_DAMPER] = None
    acts: Annotated[ArmAction | None, PUSHING] = None


class MessengerSupportChanges(InputTable):
    """Values of the messenger support at one support that differ from the table messenger_support of the line."""

    stiffness_N_m: Annotated[SupportStiffness | None, SINGLE_SUPPORTS] = None
    damping_N_s_m: Annotated[SupportDamper | None, Feature("support_dampers")] = None
    along_track: Annotated[AlongTrack | None, HELD] = None


class SupportTable(InputTable):
    """Support, or end of the line, with its own values; the other values are those of the line."""

    number: Annotated[
        int,
        Field(
            ge=0,
            le=MOST_SPANS,
            description="number of the support in running order, from 1; 0 and the number of spans: ends of the line",
        ),
    ]
    stagger_contact_wire_m: Annotated[SignedStagger | None, Feature("stagger", bool)] = None
    stagger_messenger_m: Annotated[SignedStagger | None, Feature("stagger", bool)] = None
    contact_wire_height_m: Annotated[Height | None, SINGLE_SUPPORTS] = None
    encumbrance_m: Annotated[Encumbrance | None, SINGLE_SUPPORTS] = None
    steady_arm: Annotated[SteadyArmChanges | None, SINGLE_SUPPORTS] = None
    messenger_support: Annotated[MessengerSupportChanges | None, SINGLE_SUPPORTS] = None


def overlay_changes(table: Table, changes: InputTable | None) -> Table:
    """Table of the line with the values that differ at one support."""
    if changes is None:
        return table
    return type(table).model_validate(table.model_dump() | changes.model_dump(exclude_none=True))
