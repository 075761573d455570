"""Comparison with a baseline in results.json: a verdict beside those by the criteria and by verification."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.results_part import FiniteNumber, ResultsPart
from pantocheck.conformance.core.verdicts import Verdict


class BaselineComparison(ResultsPart):
    """Comparison of the values of a case with earlier results.

    Its criteria stand among those of the case: their `trust` is null, because their bounds are earlier values and no
    limits of a standard. A value that has not drifted has no such criterion.
    """

    verdict: Verdict
    """Worst of its criteria; info: no value was compared."""
    name: str
    """Name of the file with the earlier results."""
    drift_pct: Annotated[FiniteNumber, Field(gt=0)]
    """Largest accepted drift of a value [%]."""
    values: Annotated[int, Field(ge=0)]
    """Number of values of the baseline; 0: no comparison is possible."""
    drifted: Annotated[int, Field(ge=0)]
    """Number of values that drifted or are missing."""
