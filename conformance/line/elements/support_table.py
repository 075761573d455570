"""Support of a line with its own values: heights, staggers, steady arm and messenger support."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import InputTable
from pantocheck.conformance.line.elements.messenger_support import MessengerSupportChanges
from pantocheck.conformance.line.elements.single_support import MOST_SPANS, SINGLE_SUPPORTS
from pantocheck.conformance.line.elements.steady_arm import SteadyArmChanges

Encumbrance = Annotated[
    float,
    Field(gt=0, le=5, description="vertical distance between messenger wire and contact wire at a support [m]"),
]
SignedStagger = Annotated[float, Field(ge=-1, le=1, description="lateral position, as built [m]")]
Height = Annotated[
    float, Field(ge=-20, le=20, description="height of the contact wire above a datum, for example the rail [m]")
]


class SupportTable(InputTable):
    """Support, or end of the line, with its own values; the other values are those of the line."""

    number: Annotated[int, Field(ge=0, le=MOST_SPANS)]
    """Number of the support in running order, from 1; 0 and the number of spans: ends of the line."""
    stagger_contact_wire_m: Annotated[SignedStagger | None, Feature("stagger", bool)] = None
    stagger_messenger_m: Annotated[SignedStagger | None, Feature("stagger", bool)] = None
    contact_wire_height_m: Annotated[Height | None, SINGLE_SUPPORTS] = None
    encumbrance_m: Annotated[Encumbrance | None, SINGLE_SUPPORTS] = None
    steady_arm: Annotated[SteadyArmChanges | None, SINGLE_SUPPORTS] = None
    messenger_support: Annotated[MessengerSupportChanges | None, SINGLE_SUPPORTS] = None
