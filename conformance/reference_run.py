"""Run of the reference simulator beside a system under test, for information."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.results.reference_merging import merge_reference
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runner import Progress, RunInterrupted, run_cases
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator


def add_reference(results: Results, cases: Sequence[Case], jobs: int, progress: Progress | None = None) -> Results:
    """Run the cases on the reference simulator, and add its values to the results of another system.

    Args:
        results: Results of the system under test; their verdicts stay.
        cases: The cases of these results.
        jobs: Number of parallel processes.
        progress: Callback for each result of the reference simulator.

    Raises:
        RunInterrupted: The user stopped the run; the exception holds the results of the system, with the values of the
            finished cases.
    """
    try:
        reference = run_cases(cases, ReferenceSimulator(), results.trust, jobs, progress)
    except RunInterrupted as interruption:
        raise RunInterrupted(merge_reference(results, interruption.results), interruption.exit_code) from None
    return merge_reference(results, reference)
