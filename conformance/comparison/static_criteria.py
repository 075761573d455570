"""Criteria of a static comparison: the largest difference in the evaluated section against a tolerance of the user."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.comparison.static_comparison_format import StaticCriterion
from pantocheck.conformance.comparison.static_differences import find_static_gaps, select_section
from pantocheck.conformance.comparison.static_record import StaticValue
from pantocheck.conformance.comparison.static_sidecar import StaticSidecar
from pantocheck.conformance.comparison.value_pair import ValuePair
from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.verdicts import judge, margin

MOST_NAMED_GAPS = 5
"""Largest number of gaps that a reason names."""


@dataclass(frozen=True)
class DifferenceKind:
    """Kind of difference that a criterion bounds.

    Parameters
    ----------
    name : StaticValue
        Compared values.
    unit : str
        Unit of the difference.
    """

    name: StaticValue
    unit: str

    def scale(self, measured: RealArray) -> RealArray:
        """Factor from a difference in SI units to the unit of the criterion, for each measured value."""
        return 100 / measured if self.unit == "%" else np.full(measured.size, 1e3)

    def stated_uncertainty(self, sidecar: StaticSidecar) -> float:
        """Half-width of the 95 % interval of a measured value [m/N or m]; 0 if the sidecar states none."""
        width = sidecar.elasticity_uncertainty_mm_N if self.name == "elasticity" else sidecar.height_uncertainty_mm
        return (width or 0.0) / 1e3


CRITERIA = {
    "elasticity_difference_mm_N": DifferenceKind("elasticity", "mm/N"),
    "elasticity_difference_pct": DifferenceKind("elasticity", "%"),
    "contact_wire_height_difference_mm": DifferenceKind("contact_wire_height", "mm"),
}
"""Criteria by name: the largest absolute difference between model and measurement, in the unit at the end."""


def grade_tolerance(
    quantity: str,
    tolerance: float,
    pairs: Mapping[StaticValue, ValuePair],
    sidecar: StaticSidecar,
    section: tuple[float, float],
) -> StaticCriterion:
    """Grade the largest difference in the evaluated section by a tolerance.

    The criterion is skipped unless the whole section was measured at the distances that the sidecar states, so that
    no row can be left out unnoticed.

    Parameters
    ----------
    quantity : str
        Name of the criterion, from `CRITERIA`.
    tolerance : float
        Largest accepted absolute difference, in the unit of the criterion.
    pairs : mapping of StaticValue to ValuePair
        Compared values.
    sidecar : StaticSidecar
        Sidecar of the record.
    section : tuple of float
        Start and end of the evaluated section [m].

    Returns
    -------
    StaticCriterion
        The criterion.
    """
    kind = CRITERIA[quantity]
    pair = pairs.get(kind.name)
    missing = _find_missing(kind, pair, sidecar, section)
    inside = np.zeros(0, dtype=np.int64) if pair is None else np.flatnonzero(select_section(pair.position, section))
    if pair is None or not inside.size:
        return StaticCriterion(
            quantity=quantity, unit=kind.unit, value=None, tolerance=tolerance, verdict="skip", reason=missing,
            margin=None, discretisation=None, measurement=0.0, close=(),
        )  # fmt: skip
    scale = kind.scale(pair.measured[inside])
    size, fine_size = (
        np.abs(values[inside] - pair.measured[inside]) * scale for values in (pair.model, pair.fine_model)
    )
    largest = int(np.argmax(size))
    value = float(size[largest])
    discretisation = abs(value - float(fine_size.max()))
    measurement = kind.stated_uncertainty(sidecar) * float(scale[largest])
    errors = ValueErrors(components={"discretisation": discretisation}, limit_uncertainty=measurement)
    beyond = f"{value - tolerance:.3g} {kind.unit} beyond the tolerance, at {pair.position[inside][largest]:g} m"
    verdict = judge(value, None, tolerance)
    return StaticCriterion(
        quantity=quantity,
        unit=kind.unit,
        value=value,
        tolerance=tolerance,
        verdict=verdict if missing is None else "skip",
        reason="; ".join(filter(None, (missing, beyond if verdict == "fail" else None))) or None,
        margin=margin(value, None, tolerance),
        discretisation=discretisation,
        measurement=measurement,
        close=tuple(near_limit_remarks(value, (None, tolerance), kind.unit, errors)),
    )


def _find_missing(
    kind: DifferenceKind, pair: ValuePair | None, sidecar: StaticSidecar, section: tuple[float, float]
) -> str | None:
    """Data that a criterion needs and the record does not have; None if it is complete."""
    if pair is None:
        return f"the record has no {kind.name.replace('_', ' ')}"
    if sidecar.largest_distance_m is None:
        return "the sidecar does not state largest_distance_m, so that missing values would not be noticed"
    gaps = find_static_gaps(pair.position, section, sidecar.largest_distance_m)
    if not gaps:
        return None
    names = ", ".join(f"{start:g} and {end:g} m" for start, end in gaps[:MOST_NAMED_GAPS])
    further = f" and {len(gaps) - MOST_NAMED_GAPS} more" if len(gaps) > MOST_NAMED_GAPS else ""
    return f"no measured value between {names}{further}; the stated distance is {sidecar.largest_distance_m:g} m"
