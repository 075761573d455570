"""Verdict of a held-out passage on lines whose dropper clamps are heavier than the line file says.

python -m verification.tables.line_hold_out RESULTS.csv [--lines 12]

EN 50318:2002. All properties of a built line differ from those stated by their tolerances (1 %, damping 20 %), and each
lower dropper clamp has a mass that the line file lacks: a wrong form of the model, since no property of a line update
can replace it. Passages at 250 and 200 km/h update the line; one at 225 km/h judges it. They are simulated with half
the element length and time step of the update, and each band of 5 Hz is measured with an independent error of 5 %.
Line s has the seed (50336, s). RESULTS.csv has one row for each line; lines that it holds are not repeated.
"""

import argparse
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.comparison.line_update import (
    BAND_EDGES_HZ,
    BAND_ERROR,
    HOLD_OUT_LEVEL,
    MeasuredPassage,
    begin_estimate,
    judge_held_out,
    update_by_passage,
)
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_parameters import scale_line
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, discretise
from verification.tables.interval_share import append_row, print_table, read_rows

SEED = 50336
CLAMPS_KG = (0.0, 0.2, 0.4)
"""Masses that the line file lacks [kg]."""
UPDATING, JUDGING = (250.0, 200.0), 225.0
"""Speeds [km/h]."""


def build_cases() -> dict[float, Case]:
    """Case at each speed."""
    (case,) = select_cases(["en50318-2002/250"])
    return {
        speed: replace(case, file=case.file.model_copy(update={"speed_km_h": speed})) for speed in (*UPDATING, JUDGING)
    }


def record_passage(case: Case, built: Catenary, random: np.random.Generator) -> MeasuredPassage:
    """Passage over the built line, with errors of the bands."""
    discretisation = case.file.discretisation.scale(1 / 2)
    record = run_passage(case, discretise(built, discretisation.element_m), discretisation).record
    frequency, lines = np.fft.rfftfreq(record.time.size, 1 / record.rate), np.fft.rfft(record.force)
    error = BAND_ERROR * random.standard_normal(len(BAND_EDGES_HZ) - 1)
    for (low, high), part in zip(pairwise(BAND_EDGES_HZ), error, strict=True):
        lines[:, (frequency > low) & (frequency <= high)] *= 1 + part
    force = np.fft.irfft(lines, record.time.size)
    return MeasuredPassage(f"{case.file.speed_km_h:g} km/h", case, replace(record, force=force))


def judge_line(clamp_kg: float, number: int) -> float:
    """Probability of the held-out passage on the updated line [-]."""
    cases, random = build_cases(), np.random.default_rng((SEED, number))
    stated = cases[JUDGING].line
    estimate = begin_estimate(stated)
    factors = random.multivariate_normal(estimate.factors, estimate.covariance)
    built = scale_line(build_catenary(stated), estimate.parameters, factors.tolist())
    heavier = (replace(each, lower_clamp_mass=each.lower_clamp_mass + clamp_kg) for each in built.droppers)
    built = replace(built, droppers=tuple(heavier))
    for speed in UPDATING:
        estimate = update_by_passage(estimate, stated, record_passage(cases[speed], built, random))
    return judge_held_out(estimate, stated, record_passage(cases[JUDGING], built, random))[1]


def main() -> None:
    """Judge the lines that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, metavar="RESULTS.csv")
    parser.add_argument("--lines", type=int, default=12, help="lines for each mass; default: %(default)s")
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
