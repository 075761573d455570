"""Repeated passages of an exported line with a reset between them: equal results, and no growth of memory.

`python -m verification.fmu.line_passages [HOURS]`: simulated time, default 24 h. The line is that of the adapter check,
five spans, with elements and time steps of four times the size.
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.runs.line_fmu import build_line_fmu
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.line_coupling import open_line


class RepeatedPassages(NamedTuple):
    """Comparison of the first passage of an instance with all others."""

    passages: int
    largest_difference: float
    """Largest difference of a force or uplift of the first and the last passage [N, m]."""
    memory_growth_MB: float
    """Growth of the memory of the process from the end of the second passage to that of the last one."""


def read_memory() -> float:
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * 4096 / 1e6


def repeat_passages(archive: Path, heights: RealArray, simulated_s: float) -> RepeatedPassages:
    """Repeat a passage under heights of the heads, given after every ten steps, (P, T) [m]; each saves a state."""
    with open_line(archive) as line:
        line.time_step *= 10
        passages = max(3, round(simulated_s / (heights.shape[1] * line.time_step)))
        for number in range(passages):
            rows = []
            for n, height in enumerate(heights.T):
                line.step("head_height", height)
                if n == 10:
                    kept = line.save()
                    line.restore(kept)
                    line.free(kept)
                rows.append(np.concatenate([line.get("contact_force"), line.get("uplift")]))
            if number == 0:
                first = np.array(rows)
            elif number == 1:
                memory = read_memory()
            line.reset({})
        return RepeatedPassages(passages, float(np.abs(rows - first).max()), read_memory() - memory)


def main() -> None:
    """Print the comparison."""
    hours, case = float((*sys.argv[1:], "24")[0]), build_short_case()
    discretisation = case.file.discretisation.scale(4)
    case = replace(case, file=case.file.model_copy(update={"discretisation": discretisation}))
    record = UnrefinedSimulator().run(case).record
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder) / "line.fmu"
        archive.write_bytes(build_line_fmu(case, "3.0", "height"))
        found = repeat_passages(archive, record.contact_height[:, 9::10], 3600 * hours)
    print(
        f"{case.id}: {found.passages} passages, {hours:g} h; first and last differ by"
        f" {found.largest_difference:g}; memory grew by {found.memory_growth_MB:.1f} MB"
    )


if __name__ == "__main__":
    main()
