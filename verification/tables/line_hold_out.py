"""Verdict of a held-out passage on lines whose dropper clamps are heavier than the line file says.

python -m verification.tables.line_hold_out RESULTS.csv [--lines 3]

EN 50318:2002 on a coarse mesh. The tensions of a built line differ from those stated by 1 % (standard deviation), and
each lower dropper clamp has a mass that the line file lacks: a wrong form of the model, since no property of a line
update can replace it. Passages at 250 and 200 km/h update the line; one at 225 km/h judges it. Line s has the seed
(50335, s). RESULTS.csv has one row for each line; lines that it holds are not repeated.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.comparison.line_update import (
    HOLD_OUT_LEVEL,
    MeasuredPassage,
    begin_estimate,
    judge_held_out,
    update_by_passage,
)
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_parameters import MECHANICAL, scale_line
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, discretise
from verification.tables.interval_share import append_row, print_table, read_rows

SEED, TENSION_SCATTER = 50335, 0.01
CLAMPS_KG = (0.0, 0.1, 0.2, 0.4)
"""Masses that the line file lacks [kg]."""
UPDATING, JUDGING = (250.0, 200.0), 225.0
"""Speeds [km/h]."""
MESH = {"element_m": 2.0, "time_step_s": 0.004}


def build_cases() -> dict[float, Case]:
    """Case at each speed."""
    (case,) = select_cases(["en50318-2002/250"])
    file = case.file.model_copy(update={"discretisation": case.file.discretisation.model_copy(update=MESH)})
    return {speed: replace(case, file=file.model_copy(update={"speed_km_h": speed})) for speed in (*UPDATING, JUDGING)}


def record_passage(case: Case, built: Catenary) -> MeasuredPassage:
    """Passage over the built line."""
    discretisation = case.file.discretisation
    run = run_passage(case, discretise(built, discretisation.element_m), discretisation)
    return MeasuredPassage(f"{case.file.speed_km_h:g} km/h", case, run.record)


def judge_line(clamp_kg: float, number: int) -> float:
    """Probability of the held-out passage on the updated line [-]."""
    cases = build_cases()
    stated = cases[JUDGING].line
    factors = 1 + TENSION_SCATTER * np.random.default_rng((SEED, number)).standard_normal(2)
    built = scale_line(build_catenary(stated), MECHANICAL[:2], factors.tolist())
    heavier = (replace(each, lower_clamp_mass=each.lower_clamp_mass + clamp_kg) for each in built.droppers)
    built = replace(built, droppers=tuple(heavier))
    estimate = begin_estimate(stated)
    for speed in UPDATING:
        estimate = update_by_passage(estimate, stated, record_passage(cases[speed], built))
    return judge_held_out(estimate, stated, record_passage(cases[JUDGING], built))[1]


def main() -> None:
    """Judge the lines that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, metavar="RESULTS.csv")
    parser.add_argument("--lines", type=int, default=3, help="lines for each mass; default: %(default)s")
    options = parser.parse_args()
    done = {(float(row["clamp_kg"]), int(row["line"])) for row in read_rows(options.results)}
    for number in range(options.lines):
        for clamp in CLAMPS_KG:
            if (clamp, number) not in done:
                row = {"clamp_kg": clamp, "line": number, "probability": f"{judge_line(clamp, number):.3g}"}
                append_row(options.results, row)
    found: dict[float, list[float]] = {}
    for row in read_rows(options.results):
        found.setdefault(float(row["clamp_kg"]), []).append(float(row["probability"]))
    print_table(
        ["mass that each clamp lacks [kg]", "lines", "refused by the held-out passage", "probabilities"],
        (
            [
                f"{clamp:g}",
                f"{len(each)}",
                f"{sum(p < HOLD_OUT_LEVEL for p in each)}",
                f"{min(each):.2g} to {max(each):.2g}",
            ]
            for clamp, each in sorted(found.items())
        ),
    )


if __name__ == "__main__":
    main()
