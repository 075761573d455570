"""Description of a line: wires and the parts that connect them, as frozen values in SI units.

z ^      o support                                  o support
  |       \\____ messenger wire ___________________/
  |          |      |      |      |      |     |       droppers
  |  arm --o----------------------------------------o-- arm      contact wire
  +--------------------------------------------------------> x

Heights count from one datum, on a level line usually the contact wire at its supports.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

from pantocheck.model.curves import TrackCurve
from pantocheck.model.irregularity import Irregularity

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


class Kind(StrEnum):
    """Kinds of component; each kind has its own damping."""

    CONTACT_WIRE = "contact_wire"
    MESSENGER_WIRE = "messenger_wire"
    STITCH_WIRE = "stitch_wire"
    DROPPER = "dropper"
    STEADY_ARM = "steady_arm"
    MESSENGER_SUPPORT = "messenger_support"


class Termination(StrEnum):
    """Terminations of a wire along the track: a weight keeps its tension, an anchor holds its end."""

    WEIGHT = "weight"
    ANCHOR = "anchor"


@dataclass(frozen=True)
class Rayleigh:
    """Rayleigh damping of one kind of component: C = alpha M + beta K.

    Parameters
    ----------
    mass_coefficient : float
        Coefficient alpha of the mass [1/s].
    stiffness_coefficient : float
        Coefficient beta of the stiffness [s].
    """

    mass_coefficient: float = 0.0
    stiffness_coefficient: float = 0.0


@dataclass(frozen=True)
class TensionChange:
    """Stretch of a wire with a different tension, such as the messenger wire between the clamps of a stitch wire.

    Parameters
    ----------
    start, end : float
        Ends of the stretch [m].
    change : float
        Added to the tension of the wire [N].
    """

    start: float
    end: float
    change: float


@dataclass(frozen=True)
class SectionChange:
    """Stretch of a wire with another cross-section, such as a worn wire or a splice.

    Parameters
    ----------
    start, end : float
        Ends of the stretch [m].
    mass_per_length : float
        Added to the mass per length of the wire [kg/m].
    bending_stiffness : float
        Added to the bending stiffness of the wire [N m2].
    """

    start: float
    end: float
    mass_per_length: float = 0.0
    bending_stiffness: float = 0.0


@dataclass(frozen=True)
class Wire:
    """Tensioned wire from anchor to anchor.

    Parameters
    ----------
    name : str
        Unique within the line.
    kind : Kind
        Contact, messenger or stitch wire.
    start, end : float
        Positions of the fixed anchors [m].
    tension : float
        Tension T [N].
    mass_per_length : float
        Mass per length [kg/m].
    bending_stiffness : float
        Bending stiffness EI [N m2].
    tension_changes : tuple of TensionChange
        Stretches with a different tension.
    stagger : tuple of (float, float) or None
        Prescribed lateral positions (x, y) at supports and steady arms [m, m]; None: no lateral field.
    axial_stiffness : float or None
        Axial stiffness EA, needed if a support is fixed along the track [N].
    end_heights : (float, float) or None
        Heights at the anchors [m, m]; None: a contact wire ends at height zero, a messenger wire level with its next
        support. A stitch wire ends at its clamps.
    irregularity : Irregularity or None
        Heights that a pantograph feels in addition to those of the wire; only of a contact wire.
    section_changes : tuple of SectionChange
        Stretches with another cross-section.
    terminations : (Termination, Termination) or None
        Terminations at both ends; None: constant tension, or rigid anchors if a support is fixed along the track.
    """

    name: str
    kind: Kind
    start: float
    end: float
    tension: float
    mass_per_length: float
    bending_stiffness: float
    tension_changes: tuple[TensionChange, ...] = ()
    stagger: tuple[tuple[float, float], ...] | None = None
    axial_stiffness: float | None = None
    end_heights: tuple[float, float] | None = None
    irregularity: Irregularity | None = None
    section_changes: tuple[SectionChange, ...] = ()
    terminations: tuple[Termination, Termination] | None = None


@dataclass(frozen=True)
class Dropper:
    """Tension-only bar between two wires.

    Parameters
    ----------
    position : float
        Position along the track [m].
    upper, lower : str
        Names of the wires.
    stiffness : float or None
        Axial stiffness of the taut dropper [N/m]; None: it follows from `axial_stiffness`.
    axial_stiffness : float or None
        EA; the stiffness is EA over the length in the initial state [N].
    mass : float
        Mass, half of it at each end [kg].
    upper_clamp_mass, lower_clamp_mass : float
        Masses of the clamps [kg].
    contact_wire_height : float or None
        Prescribed height of the lower wire at the dropper [m]; None: not prescribed.
    """

    position: float
    upper: str
    lower: str
    stiffness: float | None = None
    axial_stiffness: float | None = None
    mass: float = 0.0
    upper_clamp_mass: float = 0.0
    lower_clamp_mass: float = 0.0
    contact_wire_height: float | None = 0.0

    def taut_stiffness(self, length: float) -> float:
        """Stiffness along the taut dropper: as given, or EA / length [N/m].

        Parameters
        ----------
        length : float
            Length at rest [m].
        """
        return (self.axial_stiffness or 0.0) / length if self.stiffness is None else self.stiffness


@dataclass(frozen=True)
class SteadyArm:
    """Hinged bar that holds the contact wire at its stagger; in the vertical plane it acts as a soft spring.

    Parameters
    ----------
    position : float
        Position along the track [m].
    wire : str
        Name of the contact wire.
    vertical_stiffness : float or None
        Vertical stiffness [N/m]; None: with a lateral field axial force over length, otherwise zero.
    length : float or None
        Length from the hinge to the contact-wire clamp [m].
    mass : float
        Mass of bar and clamp that moves with the wire [kg].
    vertical_damper : float
        Damper between the clamp and the ground [N s/m].
    carries_share : bool
        Whether the arm carries its share of the contact wire, so that the wire lies at a prescribed height.
    acts : {"pull", "push"}
        Direction of the arm force on the wire; a pushing arm is a negative spring.
    height : float
        Height at which an arm that carries its share holds the wire [m].
    """

    position: float
    wire: str
    vertical_stiffness: float | None = None
    length: float | None = None
    mass: float = 0.0
    vertical_damper: float = 0.0
    carries_share: bool = False
    acts: Literal["pull", "push"] = "pull"
    height: float = 0.0

    def transverse_stiffness(self, tension: float) -> float:
        """Stiffness across a hinged bar: tension / length, 0 beside a vertical stiffness [N/m].

        Parameters
        ----------
        tension : float
            Axial force of the bar [N].
        """
        return 0.0 if self.vertical_stiffness is not None or self.length is None else tension / self.length


@dataclass(frozen=True)
class MessengerSupport:
    """Spring and damper under the messenger wire at a mast.

    Parameters
    ----------
    position : float
        Position along the track [m].
    wire : str
        Name of the messenger wire.
    height : float
        Height of the messenger wire at the support [m].
    stiffness : float
        Vertical stiffness [N/m].
    damping : float
        Vertical damping [N s/m].
    along_track : {"free", "fixed"}
        Whether the messenger wire can move along the track: free, as on a swivelling cantilever, its tension is
        constant; fixed, its tension changes with the elongation of the stretches between fixed points.
    """

    position: float
    wire: str
    height: float
    stiffness: float
    damping: float = 0.0
    along_track: Literal["free", "fixed"] = "free"


@dataclass(frozen=True)
class Clamp:
    """Rigid joint of two wires, such as a stitch wire and the messenger wire.

    Parameters
    ----------
    position : float
        Position along the track [m].
    upper, lower : str
        Names of the wires.
    mass : float
        Mass of the clamp [kg].
    """

    position: float
    upper: str
    lower: str
    mass: float = 0.0


@dataclass(frozen=True)
class PointMass:
    """Mass on a wire, such as a section insulator or a clamp; it hangs on the wire at rest and moves with it.

    Parameters
    ----------
    position : float
        Position along the track [m].
    wire : str
        Name of the wire.
    mass : float
        Mass [kg].
    """

    position: float
    wire: str
    mass: float


@dataclass(frozen=True)
class Spring:
    """Vertical spring and damper between two wires, without force at rest.

    Parameters
    ----------
    position : float
        Position along the track [m].
    upper, lower : str
        Names of the wires.
    stiffness : float
        Stiffness [N/m].
    damping : float
        Damping [N s/m].
    """

    position: float
    upper: str
    lower: str
    stiffness: float
    damping: float = 0.0


@dataclass(frozen=True)
class ModalBand:
    """Damping ratio of all modes in a frequency band, in place of their Rayleigh damping.

    Parameters
    ----------
    from_frequency, to_frequency : float
        Edges of the band; the upper edge is excluded [Hz].
    damping_ratio : float
        Damping ratio [-].
    """

    from_frequency: float
    to_frequency: float
    damping_ratio: float


@dataclass(frozen=True)
class Catenary:
    """Line: wires, connecting parts, and the damping of each kind of component.

    Parameters
    ----------
    wires : tuple of Wire
        Wires of the line.
    droppers : tuple of Dropper
        Droppers between messenger or stitch wire and contact wire.
    steady_arms : tuple of SteadyArm
        Arms that hold the contact wire.
    messenger_supports : tuple of MessengerSupport
        Supports of the messenger wire.
    clamps : tuple of Clamp
        Rigid joints of two wires.
    damping : dict of Kind to Rayleigh
        Damping of each kind of component; a missing kind is undamped.
    modal_damping : tuple of ModalBand
        Frequency bands with modal damping.
    point_masses : tuple of PointMass
        Masses on the wires, each with the damping of its wire.
    curves : tuple of TrackCurve
        Curves of the track.
    springs : tuple of Spring
        Springs between two wires.
    """

    wires: tuple[Wire, ...]
    droppers: tuple[Dropper, ...] = ()
    steady_arms: tuple[SteadyArm, ...] = ()
    messenger_supports: tuple[MessengerSupport, ...] = ()
    clamps: tuple[Clamp, ...] = ()
    damping: dict[Kind, Rayleigh] = field(default_factory=dict)
    modal_damping: tuple[ModalBand, ...] = ()
    point_masses: tuple[PointMass, ...] = ()
    curves: tuple[TrackCurve, ...] = ()
    springs: tuple[Spring, ...] = ()

    @property
    def contact_wires(self) -> tuple[Wire, ...]:
        """Wires that a pantograph touches."""
        return tuple(wire for wire in self.wires if wire.kind is Kind.CONTACT_WIRE)

    @property
    def has_lateral_field(self) -> bool:
        """Whether a wire has a stagger, so that the lateral field is computed."""
        return any(wire.stagger is not None for wire in self.wires)

    def rayleigh(self, kind: Kind) -> Rayleigh:
        """Damping of a kind of component.

        Parameters
        ----------
        kind : Kind
            Kind of component; one without a value is undamped.
        """
        return self.damping.get(kind, Rayleigh())

    def wire(self, name: str) -> Wire:
        """Wire with a name.

        Parameters
        ----------
        name : str
            Name of the wire.

        Raises
        ------
        KeyError
            There is no such wire.
        """
        return {wire.name: wire for wire in self.wires}[name]
