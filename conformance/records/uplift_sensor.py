"""Faults of uplift sensors: an inverted sign, an overload and a zero error, for which no uplift at a support counts.

The uplift counts from rest, and a passing pantograph lifts the wire. The rest is the median while the first pantograph
is 100 to 150 m before the support. In a record without the whole of this stretch, the uplift does not count: a zero
error could not be seen. The stretch is fixed, so that no record passes after a part of it is removed. A run of a case
may start nearer to the support: its first sample is then the rest.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.line_signals import (
    LONGEST_STEP_M,
    UPLIFT_STRETCH_M,
    LineSignals,
    supports_inside,
)
from pantocheck.conformance.records.clock_join import NEIGHBOURHOOD_M
from pantocheck.conformance.records.force_checks import find_clipping
from pantocheck.conformance.records.record_resolution import find_step

REST_M = (100.0, 150.0)
"""Distances of the first pantograph before a support between which the wire there is at rest [m]."""

REST_TOLERANCE_M = 2e-3
"""Accepted rest beside 0 [m]; the largest of the simulated cases of the library is 0.40 mm, and sensors drift."""

REST_SHARE = 0.02
"""Accepted rest as a share of the rise: waves ahead of the train scale with it, and so does a wrong unit."""

START_SHARE = 0.1
"""The same at the start of a run that begins nearer to a support, whose pantographs lift the wire there."""

NOISE_DEVIATIONS = 3.0
"""Accepted rest in standard deviations of the noise, if this is more."""

OVERLOAD_STEPS = 100.0
"""Smallest rise to a flat top on both sides within its length, in steps of the resolution.

A rounded parabola has at most 8, a rounded curve of fourth order 80."""


def refuse_faulty_uplift(line: LineSignals, position: RealArray, run_start: float | None = None) -> LineSignals:
    """Signals of a line whose uplift does not count if a sensor at a support of the analysis section has a fault.

    Args:
        line: Uplift at supports with the times of the record.
        position: Positions of the pantographs, (p, n) [m].
        run_start: Position of the first pantograph at the start of the run of the case [m]; None: no run of a case.
    """
    if line.support_position is None or line.support_uplift is None:
        return line
    first, last, inside = (
        position.max(axis=0),
        position.min(axis=0),
        supports_inside(line.support_position, line.section),
    )
    rows = zip(line.support_position[inside], line.support_uplift[inside], strict=True)
    whole = run_start is not None and bool(first[0] <= run_start + LONGEST_STEP_M)
    findings = (find_uplift_fault(float(place), row, first, last, whole) for place, row in rows)
    faults = [fault for fault in findings if fault is not None]
    return replace(line, fault="; ".join(faults)) if faults else line


def find_uplift_fault(
    support: float, uplift: RealArray, first: RealArray, last: RealArray, whole: bool = False
) -> str | None:
    """Fault of the sensor at a support in words; None without a fault.

    Args:
        support: Position of the support [m].
        uplift: Uplift there, (n,) [m].
        first: Positions of the first pantograph at the same times, (n,) [m].
        last: Positions of the last pantograph, (n,) [m].
        whole: Whether the record begins with the run of a case, so that its first sample is at rest.
    """
    inversion = find_inversion(support, uplift, first, last)
    return inversion or next(_list_other_faults(support, uplift, first, last, whole), None)


def find_inversion(support: float, uplift: RealArray, first: RealArray, last: RealArray) -> str | None:
    """Deviation of an uplift whose largest part is downwards, in words; arguments as of `find_uplift_fault`."""
    rest = _find_rest(support, uplift, first)
    passing = _find_passing(support, uplift, first, last, NEIGHBOURHOOD_M)
    level = float(np.median(rest)) if rest.size else 0.0
    fall, rise = level - passing.min(initial=level), passing.max(initial=level) - level
    if fall <= max(rise, _find_tolerance(rest)):
        return None
    return (
        f"the uplift at {support:g} m falls by {1e3 * fall:.3g} mm and rises by {1e3 * rise:.3g} mm at the passage, "
        "but a pantograph lifts the wire; check the sign of the sensor"
    )


def _list_other_faults(
    support: float, uplift: RealArray, first: RealArray, last: RealArray, whole: bool
) -> Iterator[str]:
    rest, share = _find_rest(support, uplift, first), REST_SHARE
    if whole and not rest.size:
        rest, share = uplift[:1][np.isfinite(uplift[:1])], START_SHARE
    passing = _find_passing(support, uplift, first, last, UPLIFT_STRETCH_M)
    if passing.size and is_overloaded(passing):
        top = 1e3 * passing.max()
        yield f"the uplift at {support:g} m is flat at its largest value, {top:.4g} mm: the sensor was overloaded"
    if not rest.size:
        near, far = REST_M
        yield f"the uplift at {support:g} m has no rest, {near:g} to {far:g} m before the passage, from which it counts"
        return
    level = float(np.median(rest))
    tolerance = max(_find_tolerance(rest), share * float(passing.max(initial=level) - level))
    if abs(level) > tolerance:
        yield (
            f"the uplift at {support:g} m is {1e3 * level:.3g} mm at rest, before the passage, and not 0 within "
            f"{1e3 * tolerance:.2g} mm; correct the zero of the sensor"
        )


def _find_rest(support: float, uplift: RealArray, first: RealArray) -> RealArray:
    """Uplift before the passage, (k,) [m]; empty if the record lacks a part of it."""
    begin, end = support - REST_M[1], support - REST_M[0]
    inside = np.isfinite(uplift) & (first >= begin) & (first <= end)
    gaps = np.diff(first[inside], prepend=begin, append=end)
    return uplift[inside] if gaps.max() <= LONGEST_STEP_M else np.empty(0)


def _find_passing(support: float, uplift: RealArray, first: RealArray, last: RealArray, stretch: float) -> RealArray:
    """Uplift while the train is less than a stretch [m] before or behind the support, (k,) [m]."""
    inside = (first >= support - stretch) & (last <= support + stretch)
    return uplift[inside & np.isfinite(uplift)]


def _find_tolerance(rest: RealArray) -> float:
    """Accepted rest beside 0 [m]."""
    noise = 1.4826 * float(np.median(np.abs(rest - np.median(rest)))) if rest.size else 0.0
    return max(REST_TOLERANCE_M, NOISE_DEVIATIONS * noise)


def is_overloaded(uplift: RealArray) -> bool:
    """Whether an uplift without missing values (n,) [m] has a flat top that its resolution does not explain."""
    top, smallest = float(uplift.max()), OVERLOAD_STEPS * find_step(uplift)
    for start, end in find_clipping(uplift):
        before, after = uplift[max(2 * start - end, 0) : start], uplift[end : 2 * end - start]
        if uplift[start] == top and before.size and after.size and top - max(before.min(), after.min()) > smallest:
            return True
    return False
