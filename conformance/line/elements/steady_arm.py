"""Steady arms, which hold the contact wire at the supports."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.line.elements.derived_numbers import (
    BySupport,
    MassCoefficient,
    Numbers,
    StiffnessCoefficient,
    join_equal,
    round_number,
    round_numbers,
    round_positions,
)
from pantocheck.conformance.line.elements.element import BuiltSection, DerivedKeys, DrawnMark, Element
from pantocheck.conformance.line.elements.line_layout import LineLayout, SupportLayout
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.model import Catenary, Kind, SteadyArm

ARMS = Feature("steady_arms")
ARM_MASS = Feature("steady_arm_mass")

ClampMass = Annotated[float, Field(ge=0, le=20, description="mass of a clamp [kg]")]


class SteadyArmTable(SourcedTable):
    """Steady arm, which holds the contact wire at a support."""

    vertical_stiffness_N_m: Annotated[float | None, Field(ge=0, le=1e7), ARMS] = None
    """Vertical stiffness at the wire [N/m]; default: force of the arm / length."""
    static_share: Literal["level", "none"]
    """Weight of the contact wire on the arm at rest; level: as much as keeps the wire level at the support; none: no
    weight.
    """
    length_m: Annotated[float | None, Field(gt=0, le=5), ARMS] = None
    """Length of the arm [m]."""
    mass_kg_m: Annotated[float, Field(ge=0, le=20), ARM_MASS] = 0.0
    """Mass per length of the arm [kg/m]."""
    clamp_kg: Annotated[ClampMass, ARM_MASS] = 0.0
    vertical_damper_N_s_m: Annotated[NonNegative, Field(le=1e6), Feature("steady_arm_dampers")] = 0.0
    """Vertical damper between wire and ground [N s/m]."""
    acts: Annotated[Literal["pull", "push"], Feature("pushing_steady_arms")] = "pull"
    """Kind of lateral force of the arm on the contact wire."""

    @cross_check
    def _check_stiffness(self) -> Problems:
        if self.vertical_stiffness_N_m is None and self.length_m is None:
            yield validation_problem(
                "vertical_stiffness_N_m",
                "the steady arm has neither a stiffness nor a length",
                "Give vertical_stiffness_N_m, or length_m for a stiffness of force / length.",
            )


class DerivedSteadyArms(InputTable):
    """Steady arms at rest.

    With a lateral position, an arm is a hinged bar: its wire cannot move along the direction of the force at rest, and
    across it acts the transverse stiffness. A pushing arm has a negative one.
    """

    position_m: Numbers
    """Position [m]."""
    lateral_force_N: Numbers
    """Lateral force on the contact wire at rest [N]."""
    vertical_force_N: Numbers
    """Vertical force on the contact wire at rest [N]."""
    transverse_stiffness_N_m: Numbers | None
    """Force / length, across the force [N/m]; null: vertical_stiffness_N_m acts."""
    vertical_stiffness_N_m: BySupport | None
    """Vertical spring to the ground [N/m]; null: transverse_stiffness_N_m acts."""
    vertical_damper_N_s_m: BySupport
    """Vertical damper to the ground [N s/m]."""
    mass_kg: BySupport
    """Mass on the contact wire, in both directions: a third of the bar, and the clamp [kg]."""
    mass_coefficient_1_s: MassCoefficient
    stiffness_coefficient_s: StiffnessCoefficient


class SteadyArms(Element):
    """Steady arms at all supports."""

    derived: ClassVar[DerivedKeys] = {"steady_arms": (DerivedSteadyArms, ...)}
    support_tables: ClassVar[tuple[str, ...]] = ("steady_arm",)
    symbol: ClassVar[DrawnSymbol] = DrawnSymbol(name="steady arm", marker="o", filled=False)

    steady_arm: SteadyArmTable

    def steady_arm_at(self, support: SupportLayout) -> SteadyArmTable:
        """Steady arm with the values of one support."""
        return support.overlay("steady_arm", self.steady_arm)

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add an arm to every contact wire at every support."""
        return replace(catenary, steady_arms=tuple(self._build_arms(layout)))

    def _build_arms(self, layout: LineLayout) -> Iterator[SteadyArm]:
        for support in layout.supports:
            arm = self.steady_arm_at(support)
            # A bar that rotates about its hinge acts at the claw with a third of its mass.
            mass = arm.mass_kg_m * (arm.length_m or 0.0) / 3 + arm.clamp_kg
            for contact in self.part(Wires).wire_names(Kind.CONTACT_WIRE):
                yield SteadyArm(
                    support.limit.position,
                    contact,
                    vertical_stiffness=arm.vertical_stiffness_N_m,
                    length=arm.length_m,
                    mass=mass,
                    vertical_damper=arm.vertical_damper_N_s_m,
                    carries_share=arm.static_share == "level",
                    acts=arm.acts,
                    height=support.limit.contact_wire_height,
                )

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Steady arms at rest, with their stiffness and damping."""
        from pantocheck.model.discretisation.connectors import arm_direction

        catenary, force = section.line.catenary, section.line.state.arm_force
        arms, rayleigh = catenary.steady_arms, catenary.rayleigh(Kind.STEADY_ARM)
        tensions = [arm_direction(arm, f)[2] for arm, f in zip(arms, force, strict=True)]
        across = [arm.transverse_stiffness(tension) for arm, tension in zip(arms, tensions, strict=True)]
        hinged = [catenary.has_lateral_field and arm.vertical_stiffness is None for arm in arms]
        derived = DerivedSteadyArms(
            position_m=round_positions(arm.position for arm in arms),
            lateral_force_N=round_numbers(force[:, 0]),
            vertical_force_N=round_numbers(force[:, 1]),
            transverse_stiffness_N_m=round_numbers(across) if any(hinged) else None,
            vertical_stiffness_N_m=None if all(hinged) else join_equal(arm.vertical_stiffness or 0.0 for arm in arms),
            vertical_damper_N_s_m=join_equal(arm.vertical_damper for arm in arms),
            mass_kg=join_equal(round_number(arm.mass) for arm in arms),
            mass_coefficient_1_s=rayleigh.mass_coefficient,
            stiffness_coefficient_s=rayleigh.stiffness_coefficient,
        )
        return {"steady_arms": derived}

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Points of the arms on the contact wires."""
        return (DrawnMark(cls.symbol, arm.wire, arm.position) for arm in catenary.steady_arms)
