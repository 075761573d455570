"""Table `columns` of a sidecar: the columns of the file that hold the channels of a record."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, Positive, validation_problem

FileColumnName = Annotated[
    str, Field(min_length=1, max_length=300, description="name of a column or channel as in the file")
]


class ColumnTable(InputTable):
    """Column of the file: the value is scale times the number of the file plus offset, in the stated unit."""

    column: FileColumnName
    unit: Annotated[str | None, Field(max_length=40)] = None
    """Unit of the value, such as kN; default: the unit that the file states."""
    scale: float = 1.0
    """Factor on the numbers of the file [unit per number]."""
    offset: float = 0.0
    """Number added after the factor, in the unit of the value."""

    @cross_check
    def _check_scale(self) -> Problems:
        if self.scale == 0:
            yield validation_problem("scale", "found 0", "Give the factor from the numbers of the file to the unit.")
        if self.unit is None and (self.scale != 1 or self.offset != 0):
            yield validation_problem("unit", "missing beside scale or offset", "Give the unit of the scaled value.")


class HeadPart(InputTable):
    """Part of the pantograph head above the force sensors, with its accelerometer."""

    mass_kg: Annotated[Positive, Field(le=200)]
    """Mass of this part of the head [kg]."""
    acceleration: ColumnTable
    """Vertical acceleration of this part, positive upward."""


class SensorSum(InputTable):
    """Contact force from several force sensors: their sum, less the inertia of the head above them."""

    sum: Annotated[tuple[ColumnTable, ...], Field(strict=False, min_length=1, max_length=32)]
    """Force sensors between head and frame, positive under pressure."""
    head: Annotated[tuple[HeadPart, ...], Field(strict=False, max_length=32)] = ()
    """Parts of the head above the sensors, for the inertia force."""
    aerodynamic_N: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    """Constant lift of the parts above the sensors [N], upward positive."""


ColumnSource = ColumnTable | SensorSum
