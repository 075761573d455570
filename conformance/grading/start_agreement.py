"""Comparison of the start that a record states with the start of its case.

The start moves the results of a line with a short run-in. Where a record states another start, the stored change of a
converged value with the start widens its limits, and the uncertainty from the start can mark a criterion as close. No
check compares the statement with the record. A criterion that passes only inside the widened limits therefore says so.
"""

from dataclasses import dataclass

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.records.sidecar_tables import StartTable
from pantocheck.conformance.results.case_facts_format import StartState

START_TOLERANCE_M = 0.1
"""Tolerance of the place and the ramp of a start [m].

The standard deviation of the 2002 model at 250 km/h moves by 2 N along a span of 60 m: 0.1 m are worth 0.01 N."""


@dataclass(frozen=True)
class StartAgreement:
    """Agreement of the start of a record with that of its case."""

    state: StartState
    """Whether the starts are the same, differ, or are not comparable because the record states none."""
    text: str
    """Remark for the reader of the report."""


def compare_starts(case: Case, stated: StartTable | None) -> StartAgreement:
    """Compare the stated start of a record with that of its case.

    Args:
        case: Case with a speed.
        stated: Start that the record states.
    """
    if stated is None:
        return StartAgreement(
            "not stated", "The record does not state its start: it is compared as if it had the start of the case."
        )
    expected = case.start_table
    differences = []
    if abs(stated.place_m - expected.place_m) > START_TOLERANCE_M:
        differences.append(
            f"its last pantograph starts at {stated.place_m:g} m, that of the case at {expected.place_m:g} m"
        )
    if abs(stated.ramp_m - expected.ramp_m) > START_TOLERANCE_M:
        differences.append(f"its ramp is {stated.ramp_m:g} m long, that of the case {expected.ramp_m:g} m")
    if stated.state != expected.state:
        differences.append(f"its state is {stated.state!r}, that of the case {expected.state!r}")
    if not differences:
        return StartAgreement("as in the case", "The start of the record is that of the case.")
    return StartAgreement("differs", f"The start of the record differs: {'; '.join(differences)}.")


def list_verification_components(start: StartState | None) -> tuple[ComponentName, ...]:
    """Components of the uncertainty that count against converged values, which have the section of the case.

    Args:
        start: Start of the record against that of its case; None without a record.
    """
    record: tuple[ComponentName, ...] = ("discretisation", "sampling", "resolution")
    return (*record, "start") if start == "differs" else record
