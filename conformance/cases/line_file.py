"""Line files: geometry, wires, connectors and damping of a catenary whose spans are all alike."""

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

Tension = Annotated[float, Field(gt=0, le=200e3, description="axial tension, one wire [N]")]
MassPerLength = Annotated[float, Field(gt=0, le=20, description="mass per length, one wire [kg/m]")]
BendingStiffness = Annotated[float, Field(ge=0, le=1e5, description="bending stiffness EI, one wire [N m2]")]
Area = Annotated[float | None, Field(gt=0, le=1000, description="cross-section [mm2]")]
ClampMass = Annotated[float, Field(ge=0, le=20, description="mass of a clamp [kg]")]


class Geometry(SourcedTable):
    """Spans and heights."""

    span_m: Annotated[float, Field(ge=10, le=120, description="length of every span [m]")]
    spans: Annotated[int, Field(ge=1, le=1000, description="number of spans")]
    encumbrance_m: Annotated[
        float, Field(gt=0, le=5, description="height of the messenger wire above the contact wire at a support [m]")
    ]
    stagger_contact_wire_m: Annotated[
        float, Field(ge=-1, le=1, description="lateral offset at supports, its sign alternating [m]")
    ] = 0.0
    stagger_messenger_m: Annotated[
        float, Field(ge=-1, le=1, description="lateral offset at supports, its sign alternating [m]")
    ] = 0.0

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
        """Positions of the supports between the first span and the last [m]; the wires end in anchors beyond them."""
        return self.span_limits[1:-1]

    @property
    def length(self) -> float:
        """Length of the line from anchor to anchor [m]."""
        return self.span_limits[-1]

    @property
    def middle_span(self) -> int:
        """Number of the span half way along the line, counted from 1."""
        return self.spans // 2 + 1

    def span(self, number: int) -> tuple[float, float]:
        """Start and end of a span, counted from 1 [m]."""
        return self.section(number, number)

    def mid_span(self, number: int) -> float:
        """Position half way along a span, counted from 1 [m]."""
        return sum(self.span(number)) / 2

    def section(self, first: int, last: int) -> tuple[float, float]:
        """Start of one span and end of another, counted from 1 [m]."""
        return self.span_limits[first - 1], self.span_limits[last]

    def shorten(self, spans: int) -> "Geometry":
        """The same line with no more than its first spans."""
        return self.model_copy(update={"spans": min(self.spans, spans)})


class WireTable(SourcedTable):
    """Contact wire or messenger wire; two of them run side by side, each with these numbers."""

    number: Annotated[Literal[1, 2], Field(description="how many run in parallel")] = 1
    spacing_m: Annotated[float | None, Field(gt=0, le=1, description="lateral distance of two parallel wires [m]")] = (
        None
    )
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    area_mm2: Area = None


class StitchWireTable(SourcedTable):
    """A wire clamped to the messenger on both sides of a support, from which the nearest droppers hang."""

    length_m: Annotated[Positive, Field(description="distance between its clamps, the support in the middle [m]")]
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    clamp_kg: ClampMass = 0.0


class DropperTable(SourcedTable):
    """Droppers of a span: tension-only bars, the same in every span."""

    x_m: Annotated[PositiveList, Field(description="positions along the span, increasing [m]")]
    presag_m: Annotated[
        NumberList | None,
        Field(description="sag of the contact wire at the droppers, one value each [m]; left out: none"),
    ] = None
    length_m: Annotated[
        PositiveList | None, Field(description="published lengths, one value each, for comparison [m]")
    ] = None
    stiffness_N_m: Annotated[float | None, Field(gt=0, description="stiffness of a taut dropper [N/m]")] = None
    axial_stiffness_EA_N: Annotated[
        float | None, Field(gt=0, description="axial stiffness EA; the stiffness is then EA over the length [N]")
    ] = None
    mass_kg: Annotated[float | None, Field(ge=0, le=20, description="mass of one dropper [kg]")] = None
    mass_kg_m: Annotated[float | None, Field(ge=0, le=20, description="mass per length of a dropper [kg/m]")] = None
    clamp_on_messenger_kg: ClampMass = 0.0
    clamp_on_contact_kg: ClampMass = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> "DropperTable":
        n = len(self.x_m)
        for i in range(1, n):
            if self.x_m[i] <= self.x_m[i - 1]:
                raise validation_problem(
                    f"x_m[{i + 1}]",
                    f"{self.x_m[i]:g} m does not follow {self.x_m[i - 1]:g} m",
                    "List the droppers in the direction of travel, each at its own place.",
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
                "the stiffness of a dropper must be said once",
                "Give either stiffness_N_m or axial_stiffness_EA_N.",
            )
        if self.mass_kg is not None and self.mass_kg_m is not None:
            raise validation_problem(
                "mass_kg", "the mass of a dropper is said twice", "Give either mass_kg or mass_kg_m."
            )
        return self


class SteadyArmTable(SourcedTable):
    """Arm that holds the contact wire at a support."""

    vertical_stiffness_N_m: Annotated[
        float | None,
        Field(ge=0, le=1e7, description="vertical stiffness at the wire [N/m]; left out: from its force and length"),
    ] = None
    static_share: Annotated[
        Literal["level", "none"],
        Field(
            description="level: the arm carries its share of the wire, so that the wire is level at the support; "
            "none: the arm carries nothing of it"
        ),
    ]
    length_m: Annotated[float | None, Field(gt=0, le=5, description="length of the arm [m]")] = None
    mass_kg_m: Annotated[float, Field(ge=0, le=20, description="mass per length of the arm [kg/m]")] = 0.0
    clamp_kg: ClampMass = 0.0
    vertical_damper_N_s_m: Annotated[
        NonNegative, Field(le=1e6, description="vertical damper between claw and ground [N s/m]")
    ] = 0.0
    acts: Annotated[
        Literal["pull", "push"], Field(description="which way the arm holds the wire against its stagger")
    ] = "pull"

    @model_validator(mode="after")
    def _stiffness_can_be_had(self) -> "SteadyArmTable":
        if self.vertical_stiffness_N_m is None and self.length_m is None:
            raise validation_problem(
                "vertical_stiffness_N_m",
                "neither a stiffness nor a length is given",
                "Give vertical_stiffness_N_m, or length_m from which it follows.",
            )
        return self


class MessengerSupportTable(SourcedTable):
    """Spring and damper under the messenger wire at a support."""

    stiffness_N_m: Annotated[Positive, Field(le=1e10, description="vertical stiffness [N/m]")]
    damping_N_s_m: Annotated[NonNegative, Field(description="vertical damper [N s/m]")] = 0.0


class LineFile(InputTable):
    """A catenary."""

    title: Annotated[str, Field(description="what it is", max_length=200)]
    geometry: Geometry
    contact_wire: WireTable
    messenger_wire: WireTable
    stitch_wire: StitchWireTable | None = None
    droppers: DropperTable
    steady_arm: SteadyArmTable
    messenger_support: MessengerSupportTable
    damping: Damping
    note: Annotated[str | None, Field(description="what a reader should know about it", max_length=4000)] = None

    @model_validator(mode="after")
    def _fits_together(self) -> "LineFile":
        span = self.geometry.span_m
        for i, x in enumerate(self.droppers.x_m, 1):
            if x >= span:
                raise validation_problem(
                    f"droppers.x_m[{i}]",
                    f"the dropper at {x:g} m lies outside its span of {span:g} m",
                    f"Positions are between 0 and {span:g} m, measured from the support before.",
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
