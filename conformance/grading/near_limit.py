"""Near-limit rule: a value closer to a limit than one of its errors is marked, as its verdict could be reversed."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class ValueErrors:
    """Errors of a value, in its unit; None if an error is not known.

    Parameters
    ----------
    discretisation : float or None
        Change when element length and time step are halved.
    spread : float or None
        Largest change when the analysis section is shifted.
    uncertainty : float or None
        Half-width of the 95 % interval from the length of the record.
    limit_uncertainty : float
        Half-width of the 95 % interval of the limit itself, if it comes from a measured record.
    """

    discretisation: float | None = None
    spread: float | None = None
    uncertainty: float | None = None
    limit_uncertainty: float = 0.0


NO_ERRORS = ValueErrors()


def near_limit_remarks(
    value: float | None, limits: tuple[float | None, float | None], unit: str, errors: ValueErrors
) -> list[str]:
    """Remarks on every error of a value that is larger than its distance from the nearer limit.

    Parameters
    ----------
    value : float or None
        Graded value; None if there is none.
    limits : tuple of float or None
        Lower and upper limit. Equal limits have no remark: any error would exceed the distance.
    unit : str
        Unit of the value.
    errors : ValueErrors
        Errors of the value.
    """
    lower, upper = limits
    if value is None or lower == upper:
        return []
    distance = min(abs(value - limit) for limit in limits if limit is not None)
    record_length = math.hypot(errors.uncertainty or 0.0, errors.limit_uncertainty)
    return [
        f"lies {_format(distance, unit)} from a limit, less than its {name} of {_format(error, unit)}: "
        f"{remedy} could reverse the verdict"
        for error, name, remedy in (
            (errors.discretisation, "discretisation error", "mesh refinement"),
            (errors.spread, "spread over analysis sections", "another analysis section"),
            (record_length, "uncertainty", "a longer record"),
        )
        if error is not None and distance < error
    ]


def _format(number: float, unit: str) -> str:
    return f"{number:.2g} {unit}".rstrip()
