"""Derived values of a case: the conventions of its equations as numbers, sent to programs beside the inputs.

Lists follow the order of the line: parts of parallel wires follow each other at one position, wire 1 first. Lists of
droppers have one list per span. Values of arms and supports are one number if they are all equal, and else a list.
"""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import InputTable, is_absent
from pantocheck.conformance.records.sidecar_tables import StartTable

Numbers = Annotated[tuple[float, ...], Field(strict=False)]
BySpan = Annotated[tuple[Numbers, ...], Field(strict=False)]
BySupport = float | Numbers
WireNumbers = Annotated[tuple[int, ...], Field(strict=False)]

MassCoefficient = Annotated[
    float, Field(description="damper to the ground over mass, of every lumped mass of this table [1/s]")
]
StiffnessCoefficient = Annotated[float, Field(description="damper over stiffness, of the springs of this table [s]")]


class DerivedStretch(InputTable):
    """Stretch of a wire with constant properties."""

    from_m: Annotated[float, Field(description="start [m]")]
    to_m: Annotated[float, Field(description="end [m]")]
    tension_N: Annotated[float, Field(description="tension [N]")]
    mass_kg_m: Annotated[float, Field(description="mass per length [kg/m]")]
    bending_stiffness_N_m2: Annotated[float, Field(description="bending stiffness EI [N m2]")]


class DerivedIrregularity(InputTable):
    """Heights that a head feels in addition to those of the wire: a cubic spline with zero slope at both ends."""

    x_m: Annotated[Numbers, Field(description="positions of the points [m]")]
    height_m: Annotated[Numbers, Field(description="heights [m]; beyond the points that of the nearest end")]


class DerivedPointMass(InputTable):
    """Mass on a wire; it hangs on the wire at rest, and moves with it in both directions."""

    position_m: Annotated[float, Field(description="position [m]")]
    wire: Annotated[Literal["contact_wire", "messenger_wire"], Field(description="kind of wire")]
    number: Annotated[int, Field(description="number of the wire among the parallel ones, from 1")]
    mass_kg: Annotated[float, Field(description="mass [kg]")]
    mass_coefficient_1_s: MassCoefficient


class DerivedCurve(InputTable):
    """TrackCurve of the track: T times curvature loads every wire per length towards positive y, at rest."""

    from_m: Annotated[float, Field(description="start, with its transition [m]")]
    to_m: Annotated[float, Field(description="end, with its transition [m]")]
    curvature_1_m: Annotated[float, Field(description="curvature between the transitions [1/m]")]
    transition_m: Annotated[float, Field(description="length at either end over which the curvature rises [m]")]


class DerivedWire(InputTable):
    """Contact wire or messenger wire; parallel wires differ in their lateral positions only."""

    start_m: Annotated[float, Field(description="position of the first anchor [m]")]
    end_m: Annotated[float, Field(description="position of the last anchor [m]")]
    end_condition: Annotated[
        Literal["fixed_without_moment"],
        Field(description="end of the wire at an anchor: no displacement from the state of rest, no bending moment"),
    ] = "fixed_without_moment"
    wave_speed_m_s: Annotated[
        float, Field(description="speed of transverse waves of low frequency, sqrt(tension / mass per length) [m/s]")
    ]
    height_m: Annotated[
        Numbers,
        Field(description="height at rest at every position of span_limits_m, first wire [m]"),
    ]
    lateral_position_m: Annotated[
        tuple[Numbers, ...] | None,
        Field(
            strict=False,
            description="prescribed lateral position of every parallel wire at every position of span_limits_m [m]; "
            "null: motion in the vertical plane only",
        ),
    ]
    stretches: Annotated[
        tuple[DerivedStretch, ...],
        Field(
            strict=False,
            exclude_if=is_absent,
            description="properties from end to end, in place of those of the line; absent: those of the line",
        ),
    ] = ()


class DerivedContactWire(DerivedWire):
    """Contact wire; parallel wires differ in their lateral positions only."""

    irregularity: Annotated[
        DerivedIrregularity | None, Field(exclude_if=is_absent, description="absent: a smooth wire")
    ] = None


class DerivedStitchWires(InputTable):
    """Stitch wires, clamped to the messenger wires on both sides of every support."""

    start_m: Annotated[Numbers, Field(description="position of the first clamp of every stitch wire [m]")]
    end_m: Annotated[Numbers, Field(description="position of the second clamp of every stitch wire [m]")]
    end_condition: Annotated[
        Literal["joined_to_messenger_without_moment"],
        Field(description="end of the wire: the displacements of the messenger wire, no bending moment"),
    ] = "joined_to_messenger_without_moment"
    wave_speed_m_s: Annotated[float, Field(description="as for the contact wire [m/s]")]
    messenger_tension_N: Annotated[
        float, Field(description="tension of a messenger wire between the clamps of a stitch wire [N]")
    ]
    clamp_mass_kg: Annotated[float, Field(description="mass of a clamp, on the messenger wire [kg]")]
    mass_coefficient_1_s: MassCoefficient


class DerivedDroppers(InputTable):
    """Droppers at rest. A taut dropper is a spring and a damper along its direction at rest.

    Its tension is max(0, tension + stiffness elongation + damping elongation rate). Across its direction it is a spring
    without damping, taut or slack.
    """

    position_m: Annotated[BySpan, Field(description="position [m]")]
    contact_wire: Annotated[
        tuple[WireNumbers, ...], Field(strict=False, description="number of the contact wire, from 1")
    ]
    on_stitch_wire: Annotated[
        tuple[tuple[bool, ...], ...],
        Field(strict=False, description="true: the upper end is on a stitch wire; false: on the messenger wire"),
    ]
    contact_wire_height_m: Annotated[
        BySpan,
        Field(
            description="prescribed height of the contact wire at rest [m]: the straight line between supports, less "
            "the pre-sag"
        ),
    ]
    length_m: Annotated[BySpan, Field(description="length at rest, between the axes of the wires [m]")]
    height_m: Annotated[BySpan, Field(description="vertical part of the length [m]")]
    width_m: Annotated[BySpan, Field(description="lateral part of the length, upper minus lower end [m]")]
    vertical_force_N: Annotated[
        BySpan,
        Field(description="vertical force at rest, at mid-length of the dropper; tension = force length / height [N]"),
    ]
    stiffness_N_m: Annotated[BySpan, Field(description="stiffness of a taut dropper [N/m]")]
    transverse_stiffness_N_m: Annotated[
        BySpan | None,
        Field(description="stiffness across the dropper: tension / length [N/m]; null: vertical plane only"),
    ]
    mass_kg: Annotated[BySpan, Field(description="mass of a dropper without clamps, half of it at each end [kg]")]
    upper_clamp_kg: Annotated[float, Field(description="mass of the clamp at the upper end [kg]")]
    lower_clamp_kg: Annotated[float, Field(description="mass of the clamp at the lower end [kg]")]
    mass_coefficient_1_s: MassCoefficient
    stiffness_coefficient_s: StiffnessCoefficient


class DerivedSteadyArms(InputTable):
    """Steady arms at rest.

    With a lateral position, an arm is a hinged bar: its wire cannot move along the direction of the force at rest, and
    across it acts the transverse stiffness. A pushing arm has a negative one.
    """

    position_m: Annotated[Numbers, Field(description="position [m]")]
    lateral_force_N: Annotated[Numbers, Field(description="lateral force on the contact wire at rest [N]")]
    vertical_force_N: Annotated[Numbers, Field(description="vertical force on the contact wire at rest [N]")]
    transverse_stiffness_N_m: Annotated[
        Numbers | None,
        Field(description="force / length, across the force [N/m]; null: vertical_stiffness_N_m acts"),
    ]
    vertical_stiffness_N_m: Annotated[
        BySupport | None, Field(description="vertical spring to the ground [N/m]; null: transverse_stiffness_N_m acts")
    ]
    vertical_damper_N_s_m: Annotated[BySupport, Field(description="vertical damper to the ground [N s/m]")]
    mass_kg: Annotated[
        BySupport,
        Field(description="mass on the contact wire, in both directions: a third of the bar, and the clamp [kg]"),
    ]
    mass_coefficient_1_s: MassCoefficient
    stiffness_coefficient_s: StiffnessCoefficient


class DerivedMessengerSupports(InputTable):
    """Supports of the messenger wires: springs and dampers to the ground, whose force is zero at rest."""

    position_m: Annotated[Numbers, Field(description="position [m]")]
    height_m: Annotated[BySupport, Field(description="height of the messenger wire at rest [m]")]
    vertical_stiffness_N_m: Annotated[BySupport, Field(description="vertical spring [N/m]")]
    lateral_stiffness_N_m: Annotated[
        BySupport | None, Field(description="lateral spring [N/m]; null: vertical plane only")
    ]
    vertical_damper_N_s_m: Annotated[BySupport, Field(description="vertical damper [N s/m]")]
    lateral_damper_N_s_m: Annotated[
        BySupport | None, Field(description="lateral damper [N s/m]; null: vertical plane only")
    ]
    held_along_track: Annotated[
        bool | tuple[bool, ...],
        Field(description="whether a support holds the wire along the track, so that its tension is not constant"),
    ]
    mass_kg: Annotated[float, Field(description="moving mass of a support [kg]")] = 0.0


class DerivedSection(InputTable):
    """Tension section at rest: its wires and the parts on them."""

    span_limits_m: Annotated[
        Numbers, Field(description="positions of both anchors, and of the supports between them [m]")
    ]
    contact_wire: DerivedContactWire
    messenger_wire: DerivedWire
    stitch_wires: DerivedStitchWires | None
    droppers: DerivedDroppers
    steady_arms: DerivedSteadyArms
    messenger_supports: DerivedMessengerSupports
    point_masses: Annotated[
        tuple[DerivedPointMass, ...],
        Field(strict=False, exclude_if=is_absent, description="masses on the wires; absent: none"),
    ] = ()


class DerivedLine(DerivedSection):
    """Line at rest: x counts from the first anchor, y from the centre line, z from the datum of the line."""

    gravity_m_s2: Annotated[float, Field(description="acceleration of gravity [m/s2]")]
    origin_x_m: Annotated[float, Field(description="position of the first anchor of the line [m]")] = 0.0
    zero_height_m: Annotated[
        float,
        Field(
            description="datum of all heights [m]; on a level line the height of the contact wire at anchors, and at "
            "supports whose arm keeps it level"
        ),
    ] = 0.0
    curves: Annotated[
        tuple[DerivedCurve, ...],
        Field(strict=False, exclude_if=is_absent, description="curves of the track; absent: a straight track"),
    ] = ()
    further_sections: Annotated[
        tuple[DerivedSection, ...],
        Field(
            strict=False,
            exclude_if=is_absent,
            description="every tension section behind the first one, in running order; the tables beside this key hold "
            "for the first. Absent: one section",
        ),
    ] = ()


class DerivedPantograph(InputTable):
    """Pantograph at the start: M z'' + C z' + K z = constant_force - contact force on the head.

    z counts upwards from the zero of all heights; its unknowns are the masses of a chain from base to head, the degrees
    of freedom of the matrices, or the modes.
    """

    uplift_force_N: Annotated[
        float,
        Field(description="uplift force for which this table holds [N]; with target_mean_force_N: start of the tuning"),
    ]
    working_height_m: Annotated[
        float,
        Field(
            description="static height of the head under the uplift force: mean uplift of the contact wire over "
            "working_height_positions_m, plus its nominal height, plus uplift force / contact stiffness [m]"
        ),
    ]
    constant_force: Annotated[
        Numbers,
        Field(
            description="constant force on every unknown: uplift force, and force of the springs at z = 0 [N; modes: "
            "N kg^-1/2]"
        ),
    ]
    contact_stiffness_N_m: Annotated[
        float, Field(description="contact force = max(0, stiffness (height of the head - height of the wire)) [N/m]")
    ]
    contact_force_share: Annotated[float, Field(description="share of every contact wire at the start [-]")]
    start_m: Annotated[float, Field(description="position at the start [m]")]
    start_force_N: Annotated[float, Field(description="contact force at the start [N]")]
    start_wire_height_m: Annotated[
        float, Field(description="height of the contact wire at the position of the head at the start [m]")
    ]
    start_displacement: Annotated[Numbers, Field(description="z of every unknown at the start [m; modes: m kg^1/2]")]


class DerivedStart(StartTable):
    """Start of the run, and its motion from the time 0 on."""

    speed_m_s: Annotated[float, Field(description="speed of the train from the time 0 on [m/s]")]
    line_velocity_m_s: Annotated[float, Field(description="velocity of every point of line and pantographs [m/s]")] = (
        0.0
    )
    duration_s: Annotated[float, Field(description="simulated time [s]")]


class DerivedEvaluation(InputTable):
    """Conventions of the quantities. Mean, bands and contact loss use the unfiltered force."""

    time_step_s: Annotated[
        float, Field(description="time step of the reference simulator, and time of its first sample [s]")
    ]
    section_m: Annotated[
        tuple[float, float],
        Field(description="analysis section [m]: samples at start <= position < end of their own pantograph"),
    ]
    bands_Hz: Annotated[
        tuple[tuple[float, float], ...],
        Field(
            strict=False, description="bands ]low, high] of the amplitude spectrum of the section, without window [Hz]"
        ),
    ]
    filter_passes: Annotated[int, Field(description="passes of the filter over the whole record, 2: forwards and back")]
    filter_pass_order: Annotated[int, Field(description="order of the Butterworth filter of a single pass")]
    filter_pass_cutoff_Hz: Annotated[
        float,
        Field(description="-3 dB frequency of a single pass at 1 / time_step_s, by the bilinear transform [Hz]"),
    ]
    std_degrees_of_freedom: Annotated[
        int, Field(description="subtracted from the number of samples in the standard deviation")
    ] = 0
    tuned_mean_tolerance_N: Annotated[
        float, Field(description="largest difference of a tuned mean contact force from target_mean_force_N [N]")
    ]


class DerivedTrain(InputTable):
    """Train of the case: pantographs, start and evaluation."""

    pantographs: Annotated[
        tuple[DerivedPantograph, ...], Field(strict=False, description="pantographs in running order")
    ]
    working_height_positions_m: Annotated[
        Numbers,
        Field(description="positions of the mean uplift: the first span of the analysis section, without its end [m]"),
    ]
    start: DerivedStart
    evaluation: DerivedEvaluation


class Derived(InputTable):
    """Values that follow from the inputs of a case by the conventions of docs/systems.md, to six digits."""

    line: DerivedLine
    train: Annotated[DerivedTrain | None, Field(description="null: check of the line at rest")]
