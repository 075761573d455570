"""Difference between a record and the run of a case that it should represent."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import SPEED_TOLERANCE, Record

SECTION_TOLERANCE_M = 0.01
"""Tolerance of the analysis section of a record against that of its case [m]."""

SPACING_TOLERANCE_M = 0.5
"""Tolerance of the distance between two pantographs [m].

A train at 250 km/h travels 3.5 m in one period of 20 Hz; the tolerance is a seventh of it. The tolerance of the speed
gives the same error at a distance of 100 m."""


def find_record_mismatch(case: Case, record: Record) -> str | None:
    """Reason why a record is no run of a case; None if it is one.

    Parameters
    ----------
    case : Case
        Case with its train.
    record : Record
        Delivered record.
    """
    if record.pantographs != len(case.pantographs):
        return f"the record has {record.pantographs} pantographs, the case has {len(case.pantographs)}"
    if not abs(record.speed / case.speed - 1) <= SPEED_TOLERANCE:
        return f"the record was made at {3.6 * record.speed:.4g} km/h, the case runs at {3.6 * case.speed:.4g} km/h"
    (start, end), (first, last) = record.evaluated, case.analysis_section
    if not max(abs(start - first), abs(end - last)) <= SECTION_TOLERANCE_M:
        return f"the record evaluates {start:g} m to {end:g} m, the case {first:g} m to {last:g} m"
    return _find_other_spacing(case, record)


def _find_other_spacing(case: Case, record: Record) -> str | None:
    for number, expected in enumerate(case.file.spacing_m or (), 2):
        distance = record.position[number - 2] - record.position[number - 1]
        worst = float(distance[np.abs(distance - expected).argmax()])
        if not abs(worst - expected) <= SPACING_TOLERANCE_M:
            return (
                f"pantograph {number} runs {worst:.5g} m behind pantograph {number - 1} in the record, "
                f"{expected:g} m in the case"
            )
    return None


def find_other_case(case: Case, case_digest: str | None) -> str | None:
    """Reason why a record was made for another version of a case; None if it was not, or does not state it.

    Parameters
    ----------
    case : Case
        Case that is graded.
    case_digest : str or None
        Digest of the inputs of the case, as the record states it.
    """
    if case_digest in {None, case.digest}:
        return None
    return (
        f"the record was made for another version of the case: its case_digest is {case_digest}, "
        f"that of the case is {case.digest}"
    )
