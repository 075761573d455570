"""Tables `track` and `position` of a sidecar: the kilometres of the line, and the position of the train."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Discriminator, Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, Positive, validation_problem
from pantocheck.conformance.records.logger.column_tables import FileColumnName


class KilometreTable(InputTable):
    """Kilometres of the line: x = 1000 (km - zero_km), or 1000 (zero_km - km) if they decrease in running direction."""

    zero_km: Annotated[float, Field(ge=-10000, le=10000)]
    """Kilometre of the line at x = 0."""
    kilometres: Literal["increasing", "decreasing"]
    """Kilometres of the line in running direction."""

    @property
    def direction(self) -> float:
        """1 if the kilometres increase in running direction, else -1."""
        return 1.0 if self.kilometres == "increasing" else -1.0

    def place(self, kilometre: float) -> float:
        """Position x in running direction [m]."""
        return self.direction * 1000 * (kilometre - self.zero_km)


class CounterPosition(InputTable):
    """Position from a counter of distance pulses; it may count up or down."""

    kind: Literal["counter"]
    column: FileColumnName
    metres_per_pulse: Annotated[Positive, Field(le=1000)]
    """Distance per pulse [m]."""
    start_m: float
    """Position of the first pantograph at the first sample [m]."""


class PulsePosition(InputTable):
    """Position from a pulse train: the signal of a wheel sensor, whose rising edges are counted."""

    kind: Literal["pulses"]
    column: FileColumnName
    metres_per_pulse: Annotated[Positive, Field(le=1000)]
    """Distance per pulse [m]."""
    start_m: float
    """Position of the first pantograph at the first sample [m]."""


class KilometreMark(InputTable):
    """Passing of a kilometre mark by the first pantograph."""

    time_s: float
    """Time of the passing, as in the channel time_s [s]."""
    km: Annotated[float, Field(ge=-10000, le=10000)]
    """Kilometre of the line."""


class MarkPosition(InputTable):
    """Position from the times at which the first pantograph passes kilometre marks, interpolated between them."""

    kind: Literal["marks"]
    mark: Annotated[tuple[KilometreMark, ...], Field(strict=False, min_length=2, max_length=10000)]
    """Passings of kilometre marks in order of time."""

    @cross_check
    def _check_order(self) -> Problems:
        if any(later.time_s <= earlier.time_s for earlier, later in pairwise(self.mark)):
            yield validation_problem("mark", "the times do not increase", "List the marks in the order of time.")


PositionTable = Annotated[CounterPosition | PulsePosition | MarkPosition, Discriminator("kind")]
