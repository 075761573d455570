"""Zeros of the position and of the contact height of a record, against those of its case."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import StartTable
from pantocheck.conformance.simulation.derived_values import build_derived

PLACE_TOLERANCE_M = 1.0
"""Distance by which a first sample may lie before the start [m]: a rounded place, or one step of a slow record."""

HEIGHT_TOLERANCE_M = 0.1
"""Difference of heights at the start that needs no other zero [m].

The contact height of the short case varies by 0.05 m. Usual other zeros, the rail and the messenger wire, are more than
1 m away."""


def describe_other_position(case: Case, record: Record, stated: StartTable | None) -> str | None:
    """Text on positions that begin before the start; None if they do not.

    Args:
        case: Case with a speed.
        record: Delivered record.
        stated: Start that the sidecar states; None stands for that of the case.
    """
    first, place = float(record.position[-1, 0]), (stated or case.start_table).place_m
    if first >= place - PLACE_TOLERANCE_M:
        return None
    source = "the start of the case is" if stated is None else "[start] states"
    return (
        f"the first sample of the last pantograph is at {first:.4g} m, but {source} {place:g} m. Count positions from "
        "x = 0 of the line, its first anchor, and not from the start of the run."
    )


def describe_other_height(case: Case, record: Record) -> str | None:
    """Text on a contact height with another zero than that of the case; None for the same zero or without a height.

    Args:
        case: Case with a speed and one tension section.
        record: Delivered record.
    """
    train = build_derived(case).train
    if record.contact_height is None or train is None:
        return None
    first, expected = float(record.contact_height[0, 0]), train.pantographs[0].start_wire_height_m
    if abs(first - expected) <= HEIGHT_TOLERANCE_M:
        return None
    return (
        f"the contact height begins at {first:.4g} m, the case starts with {expected:.3g} m (start_wire_height_m): "
        "its zero differs, or its unit. Another zero changes no verdict: the range and the checks use changes of the "
        "height alone. A comparison of heights needs the zero of the case."
    )
