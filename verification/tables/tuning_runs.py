"""Runs of the tuning of cases with a required mean contact force, without the uplift force that they state.

python -m verification.tables.tuning_runs [CASE ...]
"""

import argparse
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import PassageRun, run_passage
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces, tune_uplift

CASES = ["en50318-2018/ac-simple/*", "en50318-2018/ac-stitched/*"]


def without_stated_forces(case: Case) -> Case:
    """Case whose uplift forces are not stated where a mean contact force is required."""
    uses = [
        use if lift.target_mean_force is None else use.model_copy(update={"uplift_force_N": None})
        for use, lift in zip(case.file.pantograph, case.lift_forces, strict=True)
    ]
    return replace(case, file=case.file.model_copy(update={"pantograph": tuple(uses)}))


def print_runs(case: Case) -> None:
    """Tune a case and print uplift forces and mean contact forces of every run."""
    line = discretise_line(case.line, case.file.discretisation.element_m)
    targets = [lift.target_mean_force for lift in case.lift_forces]

    def run(forces: tuple[float, ...]) -> PassageRun:
        return run_passage(case, line, case.file.discretisation, forces)

    def mean_forces(passage: PassageRun) -> np.ndarray:
        signals = RecordSignals(passage.record, case.file.filter)
        means = np.array([pantograph.delivered.mean() for pantograph in signals.pantographs.values()])
        cells = (", ".join(f"{value:.3f}" for value in values) for values in (passage.uplift_forces, means))
        print(f"| {case.id} | {' | '.join(cells)} |", flush=True)
        return means

    tune_uplift(run, mean_forces, estimate_uplift_forces(case, line), targets)


def main() -> None:
    """Tune the cases and print a row per run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="*", default=CASES, help=f"ids or patterns; default: {' '.join(CASES)}")
    print("| case | uplift forces [N] | mean contact forces [N] |\n|---|--:|--:|")
    for case in map(without_stated_forces, select_cases(parser.parse_args().case)):
        if not case.is_static and any(lift.target_mean_force is not None for lift in case.lift_forces):
            print_runs(case)


if __name__ == "__main__":
    main()
