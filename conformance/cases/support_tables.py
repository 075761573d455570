"""Tables of a support: steady arm and messenger support, and the supports of a line that differ from the others."""

from typing import Annotated, Literal, TypeVar

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    SourcedTable,
    validation_problem,
)

MOST_SPANS = 1000
"""Largest number of spans of a line."""

Table = TypeVar("Table", bound=InputTable)

ArmStiffness = Annotated[
    float | None,
    Field(ge=0, le=1e7, description="vertical stiffness at the wire [N/m]; default: force of the arm / length"),
]
StaticShare = Annotated[
    Literal["level", "none"],
    Field(
        description="weight of the contact wire on the arm at rest; level: as much as keeps the wire level at the "
        "support; none: no weight"
    ),
]
ArmLength = Annotated[float | None, Field(gt=0, le=5, description="length of the arm [m]")]
ArmMass = Annotated[float, Field(ge=0, le=20, description="mass per length of the arm [kg/m]")]
ClampMass = Annotated[float, Field(ge=0, le=20, description="mass of a clamp [kg]")]
ArmDamper = Annotated[NonNegative, Field(le=1e6, description="vertical damper between wire and ground [N s/m]")]
ArmAction = Annotated[
    Literal["pull", "push"], Field(description="kind of lateral force of the arm on the contact wire")
]
SupportStiffness = Annotated[Positive, Field(le=1e10, description="vertical stiffness [N/m]")]
SupportDamper = Annotated[NonNegative, Field(description="vertical damper [N s/m]")]
AlongTrack = Annotated[
    Literal["free", "fixed"],
    Field(
        description="motion of the messenger wire along the track at the supports; free: its tension is constant; "
        "fixed: its tension changes with its elongation between two supports"
    ),
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
    clamp_kg: ClampMass = 0.0
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
    static_share: StaticShare | None = None
    length_m: ArmLength = None
    mass_kg_m: ArmMass | None = None
    clamp_kg: ClampMass | None = None
    vertical_damper_N_s_m: ArmDamper | None = None
    acts: ArmAction | None = None


class MessengerSupportChanges(InputTable):
    """Values of the messenger support at one support that differ from the table messenger_support of the line."""

    stiffness_N_m: SupportStiffness | None = None
    damping_N_s_m: SupportDamper | None = None
    along_track: AlongTrack | None = None


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
    stagger_contact_wire_m: SignedStagger | None = None
    stagger_messenger_m: SignedStagger | None = None
    contact_wire_height_m: Height | None = None
    encumbrance_m: Encumbrance | None = None
    steady_arm: SteadyArmChanges | None = None
    messenger_support: MessengerSupportChanges | None = None


def overlay_changes(table: Table, changes: InputTable | None) -> Table:
    """Table of the line with the values that differ at one support."""
    if changes is None:
        return table
    return type(table).model_validate(table.model_dump() | changes.model_dump(exclude_none=True))
