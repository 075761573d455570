"""Merging of the values of the reference simulator into the results of another system."""

import numpy as np

from pantocheck.conformance.results.figure_data import Traces
from pantocheck.conformance.results.reference_format import ReferenceValues
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.traces import round_series


def merge_reference(results: Results, reference: Results) -> Results:
    """Results with the values of the reference simulator; no verdict changes.

    Args:
        results: Results of the system under test.
        reference: Results of the reference simulator on the same cases.

    Returns:
        Results whose cases have the key `reference`; a case that the reference did not run keeps its content.
    """
    by_id = {case.id: case for case in reference.cases}
    cases = [
        case.model_copy(update={"reference": _select_values(case, by_id[case.id], reference)})
        if case.id in by_id
        else case
        for case in results.cases
    ]
    return results.model_copy(update={"cases": cases})


def _select_values(case: CaseResult, run: CaseResult, reference: Results) -> ReferenceValues:
    """Values of the reference for one case."""
    return ReferenceValues(
        name=reference.system.name,
        version=reference.system.version,
        reason=None if run.quantities else run.reason or "the reference simulator has no values of this case",
        quantities=run.quantities,
        uncertainty=run.uncertainty,
        force_20_N={
            owner: force
            for owner, trace in case.traces.items()
            if owner in run.traces and (force := _place_force(trace, run.traces[owner]))
        },
    )


def _place_force(trace: Traces, reference: Traces) -> list[float]:
    """Filtered force of the reference at the positions of a trace [N]; empty where the sections differ."""
    x, known = np.array(trace.position_m), np.array(reference.position_m)
    if reference.force_20_N is None or not x.size or not known.size or x[0] >= known[-1] or x[-1] <= known[0]:
        return []
    return round_series(np.interp(x, known, np.array(reference.force_20_N)))
