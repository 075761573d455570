"""Difference between a record and the run of a case that it should represent."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.quantities.filters import is_same_cutoff
from pantocheck.conformance.records.record import SPEED_TOLERANCE, Record
from pantocheck.conformance.records.record_summary import RecordSummary

SECTION_TOLERANCE_M = 0.01
"""Tolerance of the analysis section of a record against that of its case [m]."""

SPACING_TOLERANCE_M = 0.5
"""Tolerance of the distance between two pantographs [m].

A train at 250 km/h travels 3.5 m in one period of 20 Hz; the tolerance is a seventh of it. The tolerance of the speed
gives the same error at a distance of 100 m."""


def find_record_mismatch(case: Case, record: Record) -> str | None:
    """Reason why a record is no run of a case; None if it is one.

    Args:
        case: Case with its train.
        record: Delivered record.
    """
    other = _find_other_run(case, record.pantographs, 3.6 * record.speed, record.evaluated)
    return f"the record {other}" if other is not None else _find_other_spacing(case, record)


def find_summary_mismatch(case: Case, summary: RecordSummary) -> str | None:
    """Reason why a summary record is not of a run of a case; None if it is.

    Args:
        case: Case with its train.
        summary: Delivered summary record.
    """
    other = _find_other_run(case, len(summary.pantograph), summary.speed_km_h, summary.evaluated_m)
    if other is not None:
        return f"the summary record {other}"
    stated, cutoff = summary.filter_cutoff_Hz, case.file.filter.cutoff_Hz
    if not is_same_cutoff(stated, cutoff):
        return f"the summary record has a filter of {stated:g} Hz, the case requires {cutoff:g} Hz"
    return None


def _find_other_run(case: Case, pantographs: int, speed_km_h: float, section: Sequence[float] | None) -> str | None:
    """Difference of train, speed or analysis section from a case; a static case has no speed."""
    if pantographs != len(case.pantographs):
        return f"has {count_noun(pantographs, 'pantograph')}, the case has {len(case.pantographs)}"
    expected = case.file.speed_km_h
    if expected is not None and not abs(speed_km_h / expected - 1) <= SPEED_TOLERANCE:
        return f"was made at {speed_km_h:.4g} km/h, the case runs at {expected:.4g} km/h"
    start, end = case.analysis_section
    if section is not None and not max(abs(section[0] - start), abs(section[1] - end)) <= SECTION_TOLERANCE_M:
        return f"evaluates {section[0]:g} m to {section[1]:g} m, the case {start:g} m to {end:g} m"
    return None


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
    """Reason why a record was made with other inputs than those of a case; None if it was not, or does not state it.

    Args:
        case: Case that is graded.
        case_digest: Digest of the inputs of the case, as the record states it.
    """
    if case_digest in {None, case.digest}:
        return None
    return (
        f"the record was made with other inputs than those of the case: its case_digest is {case_digest}, "
        f"that of the case is {case.digest}"
    )
