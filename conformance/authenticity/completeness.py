"""Completeness of results: parts that every run writes must not be missing.

Whoever strips curves, uncertainties or the state of a record could hide a contradiction. A missing part is therefore a
discrepancy, unless the results state why there is none.
"""

from collections.abc import Iterator

from pantocheck.conformance.results.criterion_format import COMPONENT_NAMES
from pantocheck.conformance.results.results_format import CaseResult, Results

REASONS = ("not known", "does not apply")
"""Beginnings of a basis that explains why a component of the uncertainty is missing."""


def find_gaps(results: Results) -> list[str]:
    """Missing parts of results, as sentences.

    Args:
        results: Results of a document.
    """
    only_verified = bool(results.cases) and all(case.id in results.verification_only for case in results.cases)
    gaps = [] if results.scope else ["scope is missing"]
    if results.criteria_verdict is None and not only_verified:
        gaps.append("criteria_verdict is missing")
    return gaps + [f"{case.id}: {gap}" for case in results.cases for gap in _find_case_gaps(case)]


def _find_case_gaps(case: CaseResult) -> Iterator[str]:
    if case.criteria_verdict is None and not case.profile:
        yield "criteria_verdict is missing"
    yield from _find_record_gap(case)
    yield from _find_start_gap(case)
    if case.quantities:
        yield from _find_uncertainty_gaps(case)
    if case.run.rate_Hz is not None and case.run.evaluated_m is not None:
        yield from _find_trace_gaps(case)


def _find_record_gap(case: CaseResult) -> Iterator[str]:
    """A graded passage states whether its record was verified."""
    ungraded = not case.criteria and case.reason and case.verdict in ("skip", "error")
    if case.record is None and case.run.evaluated_m is not None and not ungraded:
        yield "the state of the record is missing"


def _find_start_gap(case: CaseResult) -> Iterator[str]:
    """A start that differs from that of the case is a warning, one that is not stated a note."""
    record = case.record
    if record is None or record.start_text is None or case.reason:
        return
    texts = case.warnings if record.start == "differs" else case.notes
    if record.start != "as in the case" and record.start_text not in texts:
        yield "the remark on the start of the record is missing"


def _find_trace_gaps(case: CaseResult) -> Iterator[str]:
    """A record with samples has the curves of every pantograph, and of the uplift where there is one."""
    for owner, quantities in case.quantities.items():
        if owner == "0" or "mean_force_N" not in quantities:
            continue
        trace = case.traces.get(owner)
        if trace is None:
            yield f"pantograph {owner}: the curves are missing"
        elif not trace.position_m or not trace.force_N or not trace.spectrum.frequency_Hz:
            yield f"pantograph {owner}: the curve of the force or its spectrum is empty"
        elif "std_force_N" in quantities and (not trace.force_20_N or trace.std_N is None or trace.histogram is None):
            yield f"pantograph {owner}: the curve, deviation or histogram of the 20 Hz force is missing"
    if "max_uplift_at_support_mm" in case.quantities.get("0", {}) and not case.uplift and case.profile is None:
        yield "the curves of the uplift are missing"


def _find_uncertainty_gaps(case: CaseResult) -> Iterator[str]:
    """Every component of the uncertainty has a basis; one that is known has values."""
    for name in COMPONENT_NAMES:
        basis = case.uncertainty_basis.get(name)
        if basis is None:
            yield f"the basis of the uncertainty '{name}' is missing"
        elif not basis.startswith(REASONS) and not any(
            name in parts for quantities in case.uncertainty_components.values() for parts in quantities.values()
        ):
            yield f"the uncertainty '{name}' has a basis, but no value"
    for row in case.criteria:
        known = case.uncertainty_components.get(str(row.pantograph), {}).get(row.quantity, {})
        if known and row.value is not None and not row.is_drift and not row.components:
            yield f"{row.quantity} of pantograph {row.pantograph}: the components of its uncertainty are missing"
