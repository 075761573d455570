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

from pantocheck.model.description.curves import TrackCurve
from pantocheck.model.description.irregularity import Irregularity

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
    """Rayleigh damping of one kind of component: C = alpha M + beta K."""

    mass_coefficient: float = 0.0
    """Coefficient alpha of the mass [1/s]."""
    stiffness_coefficient: float = 0.0
    """Coefficient beta of the stiffness [s]."""


@dataclass(frozen=True)
class TensionChange:
    """Stretch of a wire with a different tension, such as the messenger wire between the clamps of a stitch wire."""

    start: float
    end: float
    """Ends of the stretch [m]."""
    change: float
    """Added to the tension of the wire [N]."""


@dataclass(frozen=True)
class SectionChange:
    """Stretch of a wire with another cross-section, such as a worn wire or a splice."""

    start: float
    end: float
    """Ends of the stretch [m]."""
    mass_per_length: float = 0.0
    """Added to the mass per length of the wire [kg/m]."""
    bending_stiffness: float = 0.0
    """Added to the bending stiffness of the wire [N m2]."""


@dataclass(frozen=True)
class Wire:
    """Tensioned wire from anchor to anchor."""

    name: str
    """Unique within the line."""
    kind: Kind
    """Contact, messenger or stitch wire."""
    start: float
    end: float
    """Positions of the fixed anchors [m]."""
    tension: float
    """Tension T [N]."""
    mass_per_length: float
    """Mass per length [kg/m]."""
    bending_stiffness: float
    """Bending stiffness EI [N m2]."""
    tension_changes: tuple[TensionChange, ...] = ()
    """Stretches with a different tension."""
    stagger: tuple[tuple[float, float], ...] | None = None
    """Prescribed lateral positions (x, y) at supports and steady arms [m, m]; None: no lateral field."""
    axial_stiffness: float | None = None
    """Axial stiffness EA, needed if a support is fixed along the track [N]."""
    end_heights: tuple[float, float] | None = None
    """Heights at the anchors [m, m]; None: a contact wire ends at height zero, a messenger wire level with its next
    support. A stitch wire ends at its clamps.
    """
    irregularity: Irregularity | None = None
    """Heights that a pantograph feels in addition to those of the wire; only of a contact wire."""
    section_changes: tuple[SectionChange, ...] = ()
    """Stretches with another cross-section."""
    terminations: tuple[Termination, Termination] | None = None
    """Terminations at both ends; None: constant tension, or rigid anchors if a support is fixed along the track."""


@dataclass(frozen=True)
class Dropper:
    """Tension-only bar between two wires."""

    position: float
    """Position along the track [m]."""
    upper: str
    lower: str
    """Names of the wires."""
    stiffness: float | None = None
    """Axial stiffness of the taut dropper [N/m]; None: it follows from `axial_stiffness`."""
    axial_stiffness: float | None = None
    """EA; the stiffness is EA over the length in the initial state [N]."""
    mass: float = 0.0
    """Mass, half of it at each end [kg]."""
    upper_clamp_mass: float = 0.0
    lower_clamp_mass: float = 0.0
    """Masses of the clamps [kg]."""
    contact_wire_height: float | None = 0.0
    """Prescribed height of the lower wire at the dropper [m]; None: not prescribed."""

    def taut_stiffness(self, length: float) -> float:
        """Stiffness along the taut dropper: as given, or EA / length [N/m].

        Args:
            length: Length at rest [m].
        """
        return (self.axial_stiffness or 0.0) / length if self.stiffness is None else self.stiffness


@dataclass(frozen=True)
class SteadyArm:
    """Hinged bar that holds the contact wire at its stagger; in the vertical plane it acts as a soft spring."""

    position: float
    """Position along the track [m]."""
    wire: str
    """Name of the contact wire."""
    vertical_stiffness: float | None = None
    """Vertical stiffness [N/m]; None: with a lateral field axial force over length, otherwise zero."""
    length: float | None = None
    """Length from the hinge to the contact-wire clamp [m]."""
    mass: float = 0.0
    """Mass of bar and clamp that moves with the wire [kg]."""
    vertical_damper: float = 0.0
    """Damper between the clamp and the ground [N s/m]."""
    carries_share: bool = False
    """Whether the arm carries its share of the contact wire, so that the wire lies at a prescribed height."""
    acts: Literal["pull", "push"] = "pull"
    """Direction of the arm force on the wire; a pushing arm is a negative spring."""
    height: float = 0.0
    """Height at which an arm that carries its share holds the wire [m]."""

    def transverse_stiffness(self, tension: float) -> float:
        """Stiffness across a hinged bar: tension / length, 0 beside a vertical stiffness [N/m].

        Args:
            tension: Axial force of the bar [N].
        """
        return 0.0 if self.vertical_stiffness is not None or self.length is None else tension / self.length


@dataclass(frozen=True)
class MessengerSupport:
    """Spring and damper under the messenger wire at a mast."""

    position: float
    """Position along the track [m]."""
    wire: str
    """Name of the messenger wire."""
    height: float
    """Height of the messenger wire at the support [m]."""
    stiffness: float
    """Vertical stiffness [N/m]."""
    damping: float = 0.0
    """Vertical damping [N s/m]."""
    along_track: Literal["free", "fixed"] = "free"
    """Whether the messenger wire can move along the track: free, as on a swivelling cantilever, its tension is
    constant; fixed, its tension changes with the elongation of the stretches between fixed points.
    """


@dataclass(frozen=True)
class Clamp:
    """Rigid joint of two wires, such as a stitch wire and the messenger wire."""

    position: float
    """Position along the track [m]."""
    upper: str
    lower: str
    """Names of the wires."""
    mass: float = 0.0
    """Mass of the clamp [kg]."""


@dataclass(frozen=True)
class PointMass:
    """Mass on a wire, such as a section insulator or a clamp; it hangs on the wire at rest and moves with it."""

    position: float
    """Position along the track [m]."""
    wire: str
    """Name of the wire."""
    mass: float
    """Mass [kg]."""
    owner: str = ""
    """Name of the element of the line that the mass belongs to."""


@dataclass(frozen=True)
class Spring:
    """Vertical spring and damper between two wires, without force at rest."""

    position: float
    """Position along the track [m]."""
    upper: str
    lower: str
    """Names of the wires."""
    stiffness: float
    """Stiffness [N/m]."""
    damping: float = 0.0
    """Damping [N s/m]."""
    owner: str = ""
    """Name of the element of the line that the spring belongs to."""


@dataclass(frozen=True)
class ModalBand:
    """Damping ratio of all modes in a frequency band, in place of their Rayleigh damping."""

    from_frequency: float
    to_frequency: float
    """Edges of the band; the upper edge is excluded [Hz]."""
    damping_ratio: float
    """Damping ratio [-]."""


@dataclass(frozen=True)
class Catenary:
    """Line: wires, connecting parts, and the damping of each kind of component."""

    wires: tuple[Wire, ...]
    """Wires of the line."""
    droppers: tuple[Dropper, ...] = ()
    """Droppers between messenger or stitch wire and contact wire."""
    steady_arms: tuple[SteadyArm, ...] = ()
    """Arms that hold the contact wire."""
    messenger_supports: tuple[MessengerSupport, ...] = ()
    """Supports of the messenger wire."""
    clamps: tuple[Clamp, ...] = ()
    """Rigid joints of two wires."""
    damping: dict[Kind, Rayleigh] = field(default_factory=dict)
    """Damping of each kind of component; a missing kind is undamped."""
    modal_damping: tuple[ModalBand, ...] = ()
    """Frequency bands with modal damping."""
    point_masses: tuple[PointMass, ...] = ()
    """Masses on the wires, each with the damping of its wire."""
    curves: tuple[TrackCurve, ...] = ()
    """Curves of the track."""
    springs: tuple[Spring, ...] = ()
    """Springs between two wires."""

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

        Args:
            kind: Kind of component; one without a value is undamped.
        """
        return self.damping.get(kind, Rayleigh())

    def wire(self, name: str) -> Wire:
        """Wire with a name.

        Args:
            name: Name of the wire.

        Raises:
            KeyError: There is no such wire.
        """
        return {wire.name: wire for wire in self.wires}[name]
