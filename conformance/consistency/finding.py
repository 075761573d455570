"""What a check found."""

from dataclasses import dataclass
from typing import Literal

CheckName = Literal["coverage", "motion", "support passing", "roll-off", "dynamics"]


@dataclass(frozen=True)
class Finding:
    """What a check found in a record; a check that finds nothing gives none.

    Parameters
    ----------
    check : CheckName
        Which one.
    kind : Literal[contradiction, doubt, unchecked]
        `contradiction` (the record cannot be graded), `doubt` (a warning), `unchecked` (the record lacks a channel).
    text : str
        One line, for the reader of a report.
    """

    check: CheckName
    kind: Literal["contradiction", "doubt", "unchecked"]
    text: str
