"""Null models of the damping study: held-out findings that come out without the measured damping.

python -m verification.tables.null_model STUDY_RESULTS --draws 8

The study runs again with the reference model in place of every damping model ("unchanged"), and with wires whose
Rayleigh coefficients are drawn from a prior ("drawn"); the reference model then stays. The commands print the numbers
of findings, and each finding with its outcomes.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.findings import FindingOutcome
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.execution.study_dispatch import run_study
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.elements.damping import ComponentDamping, Damping, DampingFile, overlay_damping
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from pantocheck.model.description.failures import SimulationError

REFERENCE = "vovan2015/damping/initial.toml"
COARSE = {"element_m": 1.0, "time_step_s": 0.002}
"""Mesh and time step of the passages, twice those of the cases; drops keep theirs."""
SEED = 20150819
MASS_1_S = (0.0116, 0.062)
STIFFNESS_S = (6.13e-6, 3.3e-3)
"""Prior: log-uniform between the smallest and largest positive coefficient of the published pairs (massat2007, its
Figure 3.27, navik2016, appsci2023, cwt_catenary)."""

Outcomes = dict[str, FindingOutcome]
"""Outcome of every held-out finding by its sentence."""


def draw_damping(count: int) -> Iterator[Damping]:
    """Rayleigh damping of both wires, drawn from the prior; droppers and steady arms stay those of the line."""
    random = np.random.default_rng(SEED)
    for _ in range(count):
        mass, stiffness = np.exp(random.uniform(*np.log([MASS_1_S, STIFFNESS_S]).T))
        wire = ComponentDamping(mass_coefficient_1_s=float(mass), stiffness_coefficient_s=float(stiffness))
        yield Damping(trust="provisional", source="assumed", contact_wire=wire, messenger_wire=wire)


def replace_damping(case: Case, damping: Damping) -> Case:
    """Case with one damping in place of all models but the reference, and with a coarse mesh for passages."""
    line = case.line.model_copy(update={"damping": overlay_damping(case.line.damping, damping)})
    dampings = {name: model if name == "initial" else damping for name, model in case.dampings.items()}
    file = case.file
    if case.file.speed_km_h is not None:
        # The updated model stays near the tuned mean force: damping moves it by less than 1 N.
        uses = tuple(use.model_copy(update={"target_mean_force_N": None}) for use in file.pantograph)
        steps = file.discretisation.model_copy(update=COARSE)
        file = file.model_copy(update={"pantograph": uses, "discretisation": steps})
    return replace(case, file=file, line=line, dampings=dampings)


def run_model(damping: Damping) -> Outcomes:
    """Outcomes of the held-out findings of the study with one damping; a case without a solution evaluates none."""
    outcomes: Outcomes = {}
    for case in select_cases(["vovan2015/*"]):
        print(f"{case.id}: {count_reproduced(outcomes)} reproduced before", file=sys.stderr, flush=True)
        variant = replace_damping(case, damping)
        try:
            rows = grade_case(variant, run_study(variant, UnrefinedSimulator()), "primary").criteria
            outcomes |= {
                row.finding.sentence: row.finding.outcome
                for row in rows
                if row.finding is not None and row.finding.role == "held_out"
            }
        except (InputError, SimulationError):
            limits = [limit.finding for limit in case.limits if limit.finding is not None]
            outcomes |= {finding.sentence: "not_evaluated" for finding in limits if finding.role == "held_out"}
    return outcomes


def read_study(path: Path) -> Outcomes:
    """Outcomes of the held-out findings in the results of the study."""
    rows = [row.finding for case in read_results(path).cases for row in case.criteria if row.finding is not None]
    return {finding.sentence: finding.outcome for finding in rows if finding.role == "held_out"}


def count_reproduced(outcomes: Outcomes) -> int:
    """Number of reproduced findings."""
    return list(outcomes.values()).count("reproduced")


def main() -> None:
    """Run the null models and print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="results.json of the study")
    parser.add_argument("--draws", type=int, default=8)
    options = parser.parse_args()
    study = read_study(options.results)
    reference = read_model(library_folder() / REFERENCE, DampingFile, "damping").damping
    unchanged = run_model(reference)
    drawn = [run_model(damping) for damping in draw_damping(options.draws)]
    counts = sorted(map(count_reproduced, drawn))
    print(f"| model | held-out findings reproduced, of {len(study)} |\n|---|---|")
    print(f"| study | {count_reproduced(study)} |\n| unchanged damping | {count_reproduced(unchanged)} |")
    spread = f"{counts[0]} to {counts[-1]}, median {np.median(counts):g}"
    print(f"| damping drawn from the prior, {len(drawn)} draws | {spread} |")
    print("\n| finding | study | unchanged | drawn |\n|---|---|---|--:|")
    for sentence, outcome in study.items():
        number = [model[sentence] for model in drawn].count("reproduced")
        words = " | ".join(text.replace("_", " ") for text in (outcome, unchanged[sentence]))
        print(f"| {sentence} | {words} | {number} of {len(drawn)} |")


if __name__ == "__main__":
    main()
