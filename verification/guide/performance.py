"""Computing times of passages on this machine, in one process after compilation."""

import os
import platform
import time
from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces
from pantocheck.model import discretise, simulate_passage
from verification.guide.guide_format import Performance, Timing

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
