"""Line files: geometry, wires, connectors and damping of a catenary with equal spans."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from pantocheck.conformance.cases.damping_file import Damping
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NonNegative,
    NumberList,
    Positive,
    PositiveList,
    SourcedTable,
    validation_problem,
)

Tension = Annotated[float, Field(gt=0, le=200e3, description="axial tension of one wire [N]")]
MassPerLength = Annotated[float, Field(gt=0, le=20, description="mass per length of one wire [kg/m]")]
BendingStiffness = Annotated[float, Field(ge=0, le=1e5, description="bending stiffness EI of one wire [N m2]")]
Area = Annotated[float | None, Field(gt=0, le=1000, description="cross-section [mm2]")]
Stagger = Annotated[float, Field(ge=-1, le=1, description="lateral offset at supports, alternating in sign [m]")]
ClampMass = Annotated[float, Field(ge=0, le=20, description="mass of a clamp [kg]")]


class Geometry(SourcedTable):
    """Spans, heights and stagger."""

    span_m: Annotated[float, Field(ge=10, le=120, description="length of every span [m]")]
    spans: Annotated[int, Field(ge=1, le=1000, description="number of spans")]
    encumbrance_m: Annotated[
        float, Field(gt=0, le=5, description="height of the messenger wire above the contact wire at a support [m]")
    ]
    stagger_contact_wire_m: Stagger = 0.0
    stagger_messenger_m: Stagger = 0.0

    @property
    def span_lengths(self) -> tuple[float, ...]:
        """Length of every span [m]."""
        return (self.span_m,) * self.spans

    @property
    def span_limits(self) -> tuple[float, ...]:
        """Positions of the first anchor, of every support and of the last anchor [m]; the line begins at 0."""
        return tuple(self.span_m * i for i in range(self.spans + 1))

    @property
    def supports(self) -> tuple[float, ...]:
        """Positions of the supports between the two anchors [m]."""
        return self.span_limits[1:-1]

    @property
    def length(self) -> float:
        """Length of the line from anchor to anchor [m]."""
        return self.span_limits[-1]

    @property
    def middle_span(self) -> int:
        """Number of the span in the middle of the line, from 1."""
        return self.spans // 2 + 1

    def span(self, number: int) -> tuple[float, float]:
        """Start and end of a span with a number from 1 [m]."""
        return self.section(number, number)

    def mid_span(self, number: int) -> float:
        """Middle of a span with a number from 1 [m]."""
        return sum(self.span(number)) / 2

    def section(self, first: int, last: int) -> tuple[float, float]:
        """Start of the first and end of the last span of a section, numbered from 1 [m]."""
        return self.span_limits[first - 1], self.span_limits[last]

    def shorten(self, spans: int) -> "Geometry":
        """Same line reduced to its first spans."""
        return self.model_copy(update={"spans": min(self.spans, spans)})


class WireTable(SourcedTable):
    """Contact wire or messenger wire; the values hold for each of two parallel wires."""

    number: Annotated[Literal[1, 2], Field(description="number of parallel wires")] = 1
    spacing_m: Annotated[float | None, Field(gt=0, le=1, description="lateral distance of parallel wires [m]")] = None
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    area_mm2: Area = None


class StitchWireTable(SourcedTable):
    """Wire clamped to the messenger on both sides of a support; it carries the nearest droppers."""

    length_m: Annotated[Positive, Field(description="distance of its clamps, symmetric to the support [m]")]
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    clamp_kg: ClampMass = 0.0


class DropperTable(SourcedTable):
    """Droppers of every span: bars that carry tension only."""

    x_m: Annotated[PositiveList, Field(description="positions along the span, increasing [m]")]
    presag_m: Annotated[
        NumberList | None,
        Field(description="sag of the contact wire at each dropper [m]; default: none"),
    ] = None
    length_m: Annotated[
        PositiveList | None, Field(description="published length of each dropper, for comparison [m]")
    ] = None
    stiffness_N_m: Annotated[float | None, Field(gt=0, description="stiffness of a taut dropper [N/m]")] = None
    axial_stiffness_EA_N: Annotated[
        float | None, Field(gt=0, description="axial stiffness EA, from which the stiffness is EA / length [N]")
    ] = None
    mass_kg: Annotated[float | None, Field(ge=0, le=20, description="mass of a dropper [kg]")] = None
    mass_kg_m: Annotated[float | None, Field(ge=0, le=20, description="mass per length of a dropper [kg/m]")] = None
    clamp_on_messenger_kg: ClampMass = 0.0
    clamp_on_contact_kg: ClampMass = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> "DropperTable":
        n = len(self.x_m)
        for i, (before, x) in enumerate(pairwise(self.x_m), 2):
            if x <= before:
                raise validation_problem(
                    f"x_m[{i}]",
                    f"{x:g} m does not follow {before:g} m",
                    "List the droppers in the direction of travel.",
                )
        for key in ("presag_m", "length_m"):
            value = getattr(self, key)
            if value is not None and len(value) != n:
                raise validation_problem(
                    key, f"{len(value)} values for {n} droppers", "Give one value per dropper of x_m."
                )
        if (self.stiffness_N_m is None) == (self.axial_stiffness_EA_N is None):
            raise validation_problem(
                "stiffness_N_m",
                "the stiffness of a dropper must be given once",
                "Give either stiffness_N_m or axial_stiffness_EA_N.",
            )
        if self.mass_kg is not None and self.mass_kg_m is not None:
            raise validation_problem(
                "mass_kg", "the mass of a dropper is given twice", "Give either mass_kg or mass_kg_m."
            )
        return self


class SteadyArmTable(SourcedTable):
    """Steady arm, which holds the contact wire at a support."""

    vertical_stiffness_N_m: Annotated[
        float | None,
        Field(ge=0, le=1e7, description="vertical stiffness at the wire [N/m]; default: force / length"),
    ] = None
    static_share: Annotated[
        Literal["level", "none"],
        Field(
            description="weight of the wire carried by the arm; level: so that the wire is level at the support; "
            "none: nothing"
        ),
    ]
    length_m: Annotated[float | None, Field(gt=0, le=5, description="length of the arm [m]")] = None
    mass_kg_m: Annotated[float, Field(ge=0, le=20, description="mass per length of the arm [kg/m]")] = 0.0
    clamp_kg: ClampMass = 0.0
    vertical_damper_N_s_m: Annotated[
        NonNegative, Field(le=1e6, description="vertical damper between wire and ground [N s/m]")
    ] = 0.0
    acts: Annotated[
        Literal["pull", "push"], Field(description="direction of the force of the arm on the staggered wire")
    ] = "pull"

    @model_validator(mode="after")
    def _check_stiffness(self) -> "SteadyArmTable":
        if self.vertical_stiffness_N_m is None and self.length_m is None:
            raise validation_problem(
                "vertical_stiffness_N_m",
                "neither a stiffness nor a length is given",
                "Give vertical_stiffness_N_m, or length_m to derive it.",
            )
        return self


class MessengerSupportTable(SourcedTable):
    """Spring and damper under the messenger wire at a support."""

    stiffness_N_m: Annotated[Positive, Field(le=1e10, description="vertical stiffness [N/m]")]
    damping_N_s_m: Annotated[NonNegative, Field(description="vertical damper [N s/m]")] = 0.0


class LineFile(InputTable):
    """Content of a line file: a catenary."""

    title: Annotated[str, Field(description="title in reports", max_length=200)]
    geometry: Geometry
    contact_wire: WireTable
    messenger_wire: WireTable
    stitch_wire: StitchWireTable | None = None
    droppers: DropperTable
    steady_arm: SteadyArmTable
    messenger_support: MessengerSupportTable
    damping: Damping
    note: Annotated[str | None, Field(description="remark for the reader", max_length=4000)] = None

    @model_validator(mode="after")
    def _fits_together(self) -> "LineFile":
        span = self.geometry.span_m
        for i, x in enumerate(self.droppers.x_m, 1):
            if x >= span:
                raise validation_problem(
                    f"droppers.x_m[{i}]",
                    f"the dropper at {x:g} m lies outside its span of {span:g} m",
                    f"Positions lie between 0 and {span:g} m, from the start of the span.",
                )
        if self.stitch_wire is not None and self.stitch_wire.length_m >= span:
            raise validation_problem(
                "stitch_wire.length_m",
                f"{self.stitch_wire.length_m:g} m in a span of {span:g} m",
                "Two neighbouring stitch wires would overlap.",
            )
        if self.messenger_wire.number > self.contact_wire.number:
            raise validation_problem(
                "messenger_wire.number",
                "two messenger wires above one contact wire",
                "One or two messenger wires carry two contact wires; one carries one.",
            )
        return self
