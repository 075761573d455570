"""Places in the files of a user that criteria belong to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class FilePlace:
    """Line of a file."""

    path: Path
    """The file."""
    line: int | None = None
    """Number of the line, from 1; None: the file as a whole."""


@dataclass(frozen=True)
class LimitPlace:
    """Place of a limit."""

    quantity: str
    """Name of the quantity."""
    pantograph: int | None
    """Number of the pantograph; None: every pantograph, or the line."""
    item: int | None
    """Number of the value among several."""
    place: FilePlace
    """Head of its table."""

    def bounds(self, quantity: str, pantograph: int, item: int | None) -> bool:
        """Whether the limit bounds a value."""
        return (self.quantity, self.item) == (quantity, item) and self.pantograph in (None, pantograph)


@dataclass(frozen=True)
class CasePlaces:
    """Places of a case."""

    case: FilePlace | None
    """Place of the case as a whole."""
    limits: tuple[LimitPlace, ...] = ()
    """Places of the limits; the first that bounds a value counts."""


@dataclass(frozen=True)
class ReportPlaces:
    """Places of the criteria of a report."""

    default: FilePlace | None = None
    """Place of everything that has no place of its own."""
    baseline: FilePlace | None = None
    """Place of a comparison with a baseline."""
    cases: Mapping[str, CasePlaces] = field(default_factory=dict)
    """Places of the cases by their id."""
    limits: tuple[LimitPlace, ...] = ()
    """Places of the limits of any other case."""

    def find_case(self, case_id: str) -> FilePlace | None:
        """Place of a case as a whole."""
        return self.cases[case_id].case if case_id in self.cases else self.default

    def find_limit(self, case_id: str, quantity: str, pantograph: int, item: int | None) -> FilePlace | None:
        """Place in a file that states the limit of a value; otherwise the place of its case."""
        limits = self.cases[case_id].limits if case_id in self.cases else self.limits
        stated = (limit.place for limit in limits if limit.bounds(quantity, pantograph, item))
        return next(stated, self.find_case(case_id))
