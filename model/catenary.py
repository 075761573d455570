"""What a line is made of: wires and the parts that connect them, as frozen values in SI units.

z ^      o support                                  o support
  |       \\____ messenger wire ___________________/
  |          |      |      |      |      |     |       droppers
  |  arm --o----------------------------------------o-- arm      contact wire
  +--------------------------------------------------------> x
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


class Kind(StrEnum):
    """Kinds of component; each has its own share of the damping."""

    CONTACT_WIRE = "contact_wire"
    MESSENGER_WIRE = "messenger_wire"
    STITCH_WIRE = "stitch_wire"
    DROPPER = "dropper"
    STEADY_ARM = "steady_arm"
    MESSENGER_SUPPORT = "messenger_support"


@dataclass(frozen=True)
class Rayleigh:
    """Damping of one kind of component: C = mass_coefficient M + stiffness_coefficient K.

    Parameters
    ----------
    mass_coefficient : float
        Multiplies the mass [1/s].
    stiffness_coefficient : float
        Multiplies the stiffness [s].
    """

    mass_coefficient: float = 0.0
    stiffness_coefficient: float = 0.0


@dataclass(frozen=True)
class TensionChange:
    """A stretch of a wire whose tension differs, as the messenger's between the clamps of a stitch wire.

    Parameters
    ----------
    start, end : float
        The stretch [m].
    change : float
        Added to the tension of the wire [N].
    """

    start: float
    end: float
    change: float


@dataclass(frozen=True)
class Wire:
    """A tensioned wire from anchor to anchor.

    Parameters
    ----------
    name : str
        Unique within the line.
    kind : Kind
        Contact, messenger or stitch wire.
    start, end : float
        Anchors, where the wire does not move [m].
    tension : float
        [N].
    mass_per_length : float
        [kg/m].
    bending_stiffness : float
        EI [N m2].
    tension_changes : tuple[TensionChange, ...]
        Stretches of other tension.
    stagger : tuple[tuple[float, float], ...] or None
        Prescribed lateral places (x, y) at supports and steady arms [m, m]; None leaves the lateral field out.
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


@dataclass(frozen=True)
class Dropper:
    """A tension-only bar between two wires at one place along the track.

    Parameters
    ----------
    position : float
        [m].
    upper, lower : str
        Names of the wires.
    stiffness : float or None
        Axial, while taut [N/m]; or None, and then axial_stiffness is given.
    axial_stiffness : float or None
        EA [N]; the stiffness is EA over the length that statics give.
    mass : float
        Its own, halved to its ends [kg].
    upper_clamp_mass, lower_clamp_mass : float
        [kg].
    contact_wire_height : float or None
        Prescribed height of the lower wire here, over the height at the supports [m]; None where the lower wire finds
        its own.
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


@dataclass(frozen=True)
class SteadyArm:
    """A hinged bar that holds the contact wire at its stagger; seen by the vertical plane as a soft spring.

    Parameters
    ----------
    position : float
        [m].
    wire : str
        Name of the contact wire.
    vertical_stiffness : float or None
        Given [N/m]; None: with a lateral field the axial force over the length of the arm, else none.
    length : float or None
        Of the bar, hinge to claw [m].
    mass : float
        What the bar and its claw add to the wire at the claw [kg].
    vertical_damper : float
        a damper between claw and ground [N s/m].
    carries_share : bool
        Does the arm carry its share of the contact wire, so that the wire is level at the support?
    acts : Literal[pull, push]
        "pull" or "push": which way it holds the wire; an arm that pushes is a negative spring.
    """

    position: float
    wire: str
    vertical_stiffness: float | None = None
    length: float | None = None
    mass: float = 0.0
    vertical_damper: float = 0.0
    carries_share: bool = False
    acts: Literal["pull", "push"] = "pull"


@dataclass(frozen=True)
class MessengerSupport:
    """Spring and damper under the messenger wire at a mast.

    Parameters
    ----------
    position : float
        [m].
    wire : str
        Name of the messenger wire.
    height : float
        Of the messenger over the contact wire at the support, the encumbrance [m].
    stiffness : float
        Vertical [N/m].
    damping : float
        Vertical [N s/m].
    """

    position: float
    wire: str
    height: float
    stiffness: float
    damping: float = 0.0


@dataclass(frozen=True)
class Clamp:
    """A rigid joint of two wires at one place, as where a stitch wire is clamped to the messenger.

    Parameters
    ----------
    position : float
        [m].
    upper, lower : str
        Names of the wires.
    mass : float
        [kg].
    """

    position: float
    upper: str
    lower: str
    mass: float = 0.0


@dataclass(frozen=True)
class ModalBand:
    """A damping ratio for all modes of a frequency band, in place of what Rayleigh damping gives them.

    Parameters
    ----------
    from_frequency, to_frequency : float
        The band, its upper edge left out [Hz].
    damping_ratio : float
        [-].
    """

    from_frequency: float
    to_frequency: float
    damping_ratio: float


@dataclass(frozen=True)
class Catenary:
    """A line: its wires, what connects them, and the damping of each kind of component.

    Parameters
    ----------
    wires, droppers, steady_arms, messenger_supports, clamps : tuple of Wire, tuple of Dropper, ...
        The parts.
    damping : dict[Kind, Rayleigh]
        By kind of component; a kind left out is undamped.
    modal_damping : tuple[ModalBand, ...]
        Bands whose modes have a damping ratio of their own.
    """

    wires: tuple[Wire, ...]
    droppers: tuple[Dropper, ...] = ()
    steady_arms: tuple[SteadyArm, ...] = ()
    messenger_supports: tuple[MessengerSupport, ...] = ()
    clamps: tuple[Clamp, ...] = ()
    damping: dict[Kind, Rayleigh] = field(default_factory=dict)
    modal_damping: tuple[ModalBand, ...] = ()

    @property
    def contact_wires(self) -> tuple[Wire, ...]:
        """The wires a pantograph touches."""
        return tuple(wire for wire in self.wires if wire.kind is Kind.CONTACT_WIRE)

    @property
    def has_lateral_field(self) -> bool:
        """Whether any wire prescribes a stagger, so that the lateral field is computed."""
        return any(wire.stagger is not None for wire in self.wires)

    def wire(self, name: str) -> Wire:
        """The wire of that name.

        Raises
        ------
        KeyError
            There is none.
        """
        return {wire.name: wire for wire in self.wires}[name]
