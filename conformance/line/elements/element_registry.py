"""Registry: the only list of the elements of a line."""

from typing import cast

from pantocheck.conformance.line.elements.curve import TrackCurves
from pantocheck.conformance.line.elements.damping import LineDamping
from pantocheck.conformance.line.elements.dropper import Droppers
from pantocheck.conformance.line.elements.element import Element
from pantocheck.conformance.line.elements.messenger_support import MessengerSupports
from pantocheck.conformance.line.elements.point_mass import PointMasses
from pantocheck.conformance.line.elements.steady_arm import SteadyArms
from pantocheck.conformance.line.elements.stitch_wire import StitchWires
from pantocheck.conformance.line.elements.tension_section import TensionSections
from pantocheck.conformance.line.elements.tolerance import Tolerances
from pantocheck.conformance.line.elements.variation import Variations
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.conformance.line.elements.wire_irregularity import Irregularities
from pantocheck.conformance.line.elements.wire_spring import WireSprings


class LineElements(
    Tolerances,
    Variations,
    TrackCurves,
    TensionSections,
    WireSprings,
    PointMasses,
    Irregularities,
    LineDamping,
    MessengerSupports,
    SteadyArms,
    Droppers,
    StitchWires,
    Wires,
):
    """Keys of all elements. An element is added to its line after those below it, and its keys follow theirs."""


ELEMENTS = cast("tuple[type[Element], ...]", LineElements.__bases__[::-1])
"""All elements, in the order in which they are added to a line."""
