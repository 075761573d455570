"""Table `arc` of a sidecar: arc detector and current of a pantograph."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, Positive, validation_problem
from pantocheck.conformance.records.logger.column_tables import ColumnTable, FileColumnName

LOADED_SHARE = 0.3
"""Share of the nominal current above which time counts for the arc share: EN 50317, by secondary sources."""


class ArcTable(InputTable):
    """Arc detector of one pantograph; an arc lasts while its number exceeds a level."""

    pantograph: Annotated[int, Field(ge=1, le=20)]
    """Number of the pantograph in running order."""
    detector: FileColumnName
    """Column of the arc detector."""
    above: float
    """Level that the number of the detector exceeds during an arc."""
    current: ColumnTable | None = None
    """Current of the pantograph."""
    nominal_current_A: Annotated[Positive | None, Field(le=1e5)] = None
    """Nominal current [A]."""

    @cross_check
    def _check_current(self) -> Problems:
        if (self.current is None) != (self.nominal_current_A is None):
            yield validation_problem(
                "current",
                "current and nominal_current_A belong together",
                "Give both; without them there is no arc share.",
            )
