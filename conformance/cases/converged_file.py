"""Converged values of a case: quantities on which two formulations of the same equations agree."""

from functools import cache
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.cases.limits import FiniteBound, QuantityName
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    PositiveList,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.trust import Computed
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.registry import QUANTITIES

FOLDER = "converged"
"""Folder of these files in the library; the path below it is the id of the case."""


class OwnedQuantity(InputTable):
    """Quantity of a pantograph or of the line."""

    quantity: QuantityName
    pantograph: Annotated[int | None, Field(ge=1, le=20)] = None
    """Number of the pantograph in running order; none for a quantity of the line."""

    @cross_check
    def _owned(self) -> Problems:
        if (QUANTITIES[self.quantity].scope == "pantograph") != (self.pantograph is not None):
            yield validation_problem(
                "pantograph",
                f"{self.quantity} is given {'with' if self.pantograph else 'without'} a pantograph",
                "Quantities of a pantograph have its number, those of the line and of a static check have none.",
            )

    @property
    def owner(self) -> int:
        """Number of the pantograph, from 1; 0 for the line."""
        return self.pantograph or 0


class ConvergedValue(OwnedQuantity):
    """Converged value with its interval, and the value of the second formulation."""

    value: FiniteBound
    """Extrapolated value, in the unit of the quantity."""
    half_width: NonNegative
    """Half-width of the interval of the value."""
    start_half_width: NonNegative | None = None
    """Half-width of the change of the value with other starts; none where it is not known."""
    order: float | None = None
    """Observed order of convergence; none where it is not observed."""
    second_value: FiniteBound
    """Value of the second formulation."""
    difference_pct: FiniteBound
    """Second value minus value, relative to the value or the dynamic part [%]."""


class OmittedValue(OwnedQuantity):
    """Quantity without a converged value."""

    reason: Annotated[str, Field(min_length=1, max_length=1000)]


class Formulation(InputTable):
    """Formulation of the equations of a case, with the meshes from which its values are extrapolated."""

    name: Annotated[str, Field(min_length=1, max_length=1000)]
    spacing_m: PositiveList
    """Element lengths or distances of points, the coarsest first."""
    time_step_s: PositiveList
    """Time steps, the coarsest first."""


class ConvergedFile(InputTable):
    """Content of a file of converged values."""

    schema_: Annotated[Literal["pantocheck.converged/1"], Field(alias="schema")]
    case: Annotated[str, Field(max_length=200)]
    """Id of the case."""
    case_digest: Annotated[str, Field(max_length=100)]
    """Digest of the inputs of the case."""
    trust: Computed
    uplift_force_N: Annotated[tuple[float, ...], Field(strict=False, max_length=20)] = ()
    """Uplift force of each pantograph [N]."""
    reference: Formulation
    second: Formulation
    value: Annotated[tuple[ConvergedValue, ...], Field(strict=False, max_length=1000)] = ()
    omitted: Annotated[tuple[OmittedValue, ...], Field(strict=False, max_length=1000)] = ()

    @cross_check
    def _distinct(self) -> Problems:
        seen = set()
        for entry in (*self.value, *self.omitted):
            if (entry.owner, entry.quantity) in seen:
                yield validation_problem("value", f"{entry.quantity} occurs twice", "Give each quantity once.")
            seen.add((entry.owner, entry.quantity))


@cache
def find_converged(case_id: str) -> ConvergedFile | None:
    """Converged values of a library case; None if there are none."""
    path = library_folder() / FOLDER / f"{case_id}.toml"
    is_known = path.is_file() and ".." not in path.parts
    return read_model(path, ConvergedFile, "converged values") if is_known else None
