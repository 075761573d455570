"""What a quantity is."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Quantity:
    """A number that can be graded.

    Parameters
    ----------
    name : str
        As it stands in case files and results, the unit at its end.
    unit : str
        As printed; empty for a ratio.
    definition : str
        One sentence.
    needs : str
        What a record, or a static check, must deliver for it.
    scope : Literal[pantograph, line, static, mass_drop, study]
        `pantograph` (one value each), `line` (one value a run), `static` (of the line at rest), `mass_drop`, `study`
        (what a comparison of runs shows).
    """

    name: str
    unit: str
    definition: str
    needs: str
    scope: Literal["pantograph", "line", "static", "mass_drop", "study"]
