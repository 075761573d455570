"""Library case of this version: its values beside published ranges, and beside converged values."""

import os
import platform
import time
from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.app.self_test.mutants import MutantResult, run_self_test
from pantocheck.conformance.app.self_test.numerical_faults import NumericalResult, run_numerical_faults
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces
from pantocheck.model import discretise, simulate_passage
from verification.guide.guide_format import (
    ConvergedComparison,
    DetectedFault,
    LibraryCase,
    Performance,
    SelfTestSummary,
    Timing,
)


def compute_library_case(case_id: str) -> LibraryCase:
    """Run a library case on the reference simulator and list its values.

    Raises:
        RuntimeError: The reference simulator has no result.
    """
    (case,) = (case for case in select_cases([case_id]) if case.id == case_id)
    result = run_case(case, ReferenceSimulator(), "provisional")
    if result.verdict == "error":
        raise RuntimeError(result.reason or "the reference simulator has no result")
    return list_case_values(case, result)


def list_case_values(case: Case, result: CaseResult) -> LibraryCase:
    """Values of a graded library case beside its published ranges and converged values."""
    return LibraryCase(
        case=case.id,
        title=case.file.title,
        edition=case.file.edition,
        superseded_by=case.file.superseded_by,
        input_digest=case.digest,
        quantities=result.quantities,
        published=result.criteria,
        converged=list_converged(result),
        simulated_s=result.run.simulated_s,
        wall_s=result.run.wall_s,
    )


def _lies_between(value: float, lower: float | None, upper: float | None) -> bool:
    return (lower is None or value >= lower) and (upper is None or value <= upper)


def list_converged(result: CaseResult) -> list[ConvergedComparison]:
    """Values of a result beside the converged values of both formulations; empty where none are stored."""
    converged = find_converged(result.id)
    if converged is None or result.verification is None:
        return []
    limits = {(row.pantograph, row.quantity): row for row in result.verification.criteria}
    rows = []
    for stored in converged.value:
        limit = limits.get((stored.owner, stored.quantity))
        if limit is None or limit.value is None or limit.lower is None or limit.upper is None:
            continue
        rows.append(
            ConvergedComparison(
                quantity=stored.quantity,
                pantograph=stored.owner,
                value=limit.value,
                discretisation=limit.components.get("discretisation"),
                first=stored.value,
                second=stored.second_value,
                half_width=stored.half_width,
                lower=limit.lower,
                upper=limit.upper,
                inside=_lies_between(limit.value, limit.lower, limit.upper),
            )
        )
    return rows


# Self-test of the suite for the guide: verdict on every known fault.
RECORD_CASES = ("en50318-2002/250", "en50318-2002/300")
FAULT_CASES = (*RECORD_CASES, "en50318-2018/ac-simple/320-twin")
"""Cases of the faults of records, and of the numerical faults, as in `pantocheck system self-test`."""


def summarise_self_test() -> SelfTestSummary:
    """Run the self-test and summarise it."""
    self_test = run_self_test(select_cases(RECORD_CASES), _ignore)
    with_train = [case for case in select_cases(FAULT_CASES) if not case.is_static]
    return SelfTestSummary(
        reference={name: verdict for name, (verdict, _) in self_test.reference.items()},
        records=[describe_mutant(row) for row in (*self_test.severe, *self_test.mild)],
        numerical=[describe_fault(row) for row in run_numerical_faults(with_train, _ignore)],
    )


def _ignore(name: str) -> None:
    pass


def describe_mutant(result: MutantResult) -> DetectedFault:
    """Verdict on a fault of a record; a mild fault is detected if its verdict is not a pass."""
    expected = result.mutant.expected_check
    found = expected if expected is not None and result.detected else ", ".join(result.checks)
    return DetectedFault(
        name=result.mutant.name,
        case=result.case,
        verdict=result.verdict,
        detected_by=found,
        must_be_detected=expected is not None,
        detected=result.detected if expected is not None else result.verdict != "pass",
    )


def describe_fault(result: NumericalResult) -> DetectedFault:
    """Verdict of the verification on a numerical fault."""
    return DetectedFault(
        name=result.fault.name,
        case=result.case,
        verdict=result.verification,
        detected_by=", ".join(result.outside),
        must_be_detected=result.fault.must_be_detected,
        detected=result.verification == "fail",
    )


# Computing times of passages on this machine, in one process after compilation.
TIMED_CASES = (
    "en50318-2002/250",
    "en50318-2018/ac-simple/320",
    "en50318-2018/ac-simple/320-twin",
    "en50318-2018/ac-stitched/320",
)

REPETITIONS = 2
"""Number of runs of which the fastest counts."""


def measure_performance() -> Performance:
    """Measure the process time of a passage of each case."""
    timings = [measure_passage(case_id) for case_id in TIMED_CASES]
    return Performance(processor=name_processor(), cores=os.cpu_count() or 1, timings=timings)


def measure_passage(case_id: str) -> Timing:
    """Process time of the passage of a library case, with its set-up and without compilation."""
    (case,) = (case for case in select_cases([case_id]) if case.id == case_id)
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    passage = build_passage(case, line, discretisation, estimate_uplift_forces(case, line))
    simulate_passage(line, replace(passage, duration=discretisation.time_step_s))
    times = []
    for _ in range(REPETITIONS):
        unused = replace(line)  # a line that no other simulation has set up
        begin = time.process_time()
        simulate_passage(unused, passage)
        times.append(time.process_time() - begin)
    return Timing(
        case=case.id,
        pantographs=len(case.pantographs),
        simulated_s=passage.duration,
        process_s=min(times),
        ratio=min(times) / passage.duration,
    )


def name_processor() -> str:
    """Name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
