"""Stored studies of the inputs of a case: resolving power, and conditions of its values.

Resolving power is the largest error of an input that the verdicts let pass. Conditions are the changes of the values by
inputs that are not traced, or that publications leave open. Drivers in `verification/tables` write both, into
`resolving-power/` and `conditions/` of the library; the path below is the id of the case.
"""

import datetime
from functools import cache
from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import Field

from pantocheck.conformance.cases.limits import QuantityName
from pantocheck.conformance.core.sourced_table import InputTable, NonNegative
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.trust import StudiedPart
from pantocheck.conformance.line.library_folder import library_folder

StudyText = Annotated[str, Field(min_length=1, max_length=1000)]


class InputStudyFile(InputTable):
    """Head of a stored study."""

    case: Annotated[str, Field(max_length=200)]
    """Id of the case."""
    case_digest: Annotated[str, Field(max_length=100)]
    """Digest of the inputs of the case."""
    date: datetime.date
    """Day of the computation."""
    command: StudyText
    """Command that writes the file."""


class ErrorBound(InputTable):
    """First change of a verdict when the error of an input grows from zero."""

    passed: NonNegative
    """Largest error below which every tried error passes."""
    noticed: NonNegative | None = None
    """Smallest tried error that does not pass; none: every error up to `passed` passes."""
    by: str = ""
    """Quantities or check that notice it; without `noticed`, the reason why no larger error can be tried."""


class InputBounds(InputTable):
    """Largest errors of one input that pass: an input that is too large (up) or too small (down)."""

    name: StudyText
    group: StudiedPart
    unit: StudyText
    """Unit of the errors; %: relative to the value of the case."""
    not_applicable: str | None = None
    """Reason why the case does not support an error of this input."""
    up: ErrorBound | None = None
    """Bound of an input that is too large, under both verdicts."""
    down: ErrorBound | None = None
    """Bound of an input that is too small, under both verdicts."""
    up_criteria: ErrorBound | None = None
    """Bound of an input that is too large, under the EN 50318 criteria alone; none: no limit counts."""
    down_criteria: ErrorBound | None = None
    """Bound of an input that is too small, under the EN 50318 criteria alone; none: no limit counts."""


class ResolvingPowerFile(InputStudyFile):
    """Content of a file of the resolving power of a case."""

    schema_: Annotated[Literal["pantocheck.resolving-power/1"], Field(alias="schema")]
    limits_digest: Annotated[str, Field(max_length=100)]
    """Digest of the limits of the case."""
    rule: Literal["simple"]
    """Decision rule of the criteria."""
    processor_s: NonNegative
    """Processor time of the computation [s]."""
    input: Annotated[tuple[InputBounds, ...], Field(strict=False, max_length=200)] = ()


class ValueChange(InputTable):
    """Change of a quantity by a changed input."""

    quantity: QuantityName
    pantograph: Annotated[int, Field(ge=0, le=20)]
    """Number of the pantograph, from 1; 0 for the line."""
    change_pct: float
    """Change relative to the value with the inputs of the case [%]."""


class ValueCondition(InputTable):
    """Changed input, and its effect."""

    name: StudyText
    group: StudiedPart
    not_applicable: str | None = None
    """Reason why the case does not support this change."""
    change: Annotated[tuple[ValueChange, ...], Field(strict=False, max_length=100)] = ()


class ConditionsFile(InputStudyFile):
    """Content of a file of the conditions of a case."""

    schema_: Annotated[Literal["pantocheck.conditions/1"], Field(alias="schema")]
    condition: Annotated[tuple[ValueCondition, ...], Field(strict=False, max_length=200)] = ()


F = TypeVar("F", ResolvingPowerFile, ConditionsFile)


def find_resolving_power(case_id: str) -> ResolvingPowerFile | None:
    """Resolving power of a library case; None if it was not computed."""
    return _find_study("resolving-power", ResolvingPowerFile, case_id)


def find_conditions(case_id: str) -> ConditionsFile | None:
    """Conditions of the values of a library case; None if they were not computed."""
    return _find_study("conditions", ConditionsFile, case_id)


@cache
def _find_study(folder: str, model: type[F], case_id: str) -> F | None:
    path = library_folder() / folder / f"{case_id}.toml"
    return read_study(path, model) if path.is_file() else None


def read_study(path: Path, model: type[F]) -> F:
    """Read the file of a study; InputError if it is invalid."""
    return read_model(path, model, "input study")
