"""Verdict of a held-out passage on lines whose dropper clamps are heavier than the line file says.

python -m verification.tables.line_hold_out RESULTS.csv [--tolerances 12] [--planted 200]

EN 50318:2002. All properties of a built line differ from those stated by their tolerances (1 %, damping 20 %), and each
lower dropper clamp has a mass that the line file lacks: a wrong form of the model, since no property of a line update
can replace it. On the lines `planted`, both tensions are wrong by -3 to +3 % at a stated tolerance of 2 %, and three
droppers have half their stiffness. Passages at 250 and 200 km/h update the line; one at 225 km/h judges it. They are
simulated with half the element length and time step of the update, and each band of 5 Hz is measured with an
independent error of 5 %. Line s has the seed (50336, s). RESULTS.csv has one row for each line; lines that it holds are
not repeated.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product
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
from pantocheck.conformance.line.elements.tolerance import ToleranceTable
from pantocheck.conformance.line.line_parameters import scale_line
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, discretise
from verification.tables.field_bound import COVERED
from verification.tables.interval_share import IntervalShare, append_row, print_table, read_rows
from verification.tables.line_coverage import TENSION_ERROR, soften_droppers

SEED = 50336
SCENARIOS = {"tolerances": (12, (0.0, 0.2, 0.4)), "planted": (200, (0.0, 0.4))}
"""Number of lines, and masses that the line file lacks [kg]."""
TENSION_TOLERANCE_PCT = 2.0
"""Stated tolerance of the tensions of a planted line."""
TENSIONS = slice(0, 2)
"""Places of the tensions in an estimate."""
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


def judge_line(scenario: str, clamp_kg: float, number: int) -> dict[str, object]:
    """Row of the store: errors of the updated tensions in standard deviations, and held-out probability."""
    cases, random = build_cases(), np.random.default_rng((SEED, number))
    stated, planted = cases[JUDGING].line, scenario == "planted"
    if planted:
        shares = {f"{wire}_wire_tension_pct": TENSION_TOLERANCE_PCT for wire in ("contact", "messenger")}
        table = ToleranceTable(source="planted", trust="provisional", **shares)
        stated = stated.model_copy(update={"tolerance": table})
    estimate = begin_estimate(stated)
    factors = random.multivariate_normal(estimate.factors, estimate.covariance)
    if planted:
        factors[TENSIONS] = 1 + random.uniform(-TENSION_ERROR, TENSION_ERROR, 2)
    built = scale_line(build_catenary(stated), estimate.parameters, factors.tolist())
    if planted:
        built = soften_droppers(built, random)
    heavier = (replace(each, lower_clamp_mass=each.lower_clamp_mass + clamp_kg) for each in built.droppers)
    built = replace(built, droppers=tuple(heavier))
    for speed in UPDATING:
        estimate = update_by_passage(estimate, stated, record_passage(cases[speed], built, random))
    error = (estimate.factors - factors)[TENSIONS] / np.sqrt(np.diag(estimate.covariance))[TENSIONS]
    probability = judge_held_out(estimate, stated, record_passage(cases[JUDGING], built, random))[1]
    return {
        "scenario": scenario,
        "clamp_kg": clamp_kg,
        "line": number,
        "contact_tension_sd": f"{error[0]:.2f}",
        "messenger_tension_sd": f"{error[1]:.2f}",
        "probability": f"{probability:.3g}",
    }


def describe_rows(rows: Sequence[Mapping[str, str]], scenario: str, clamp_kg: float) -> list[str]:
    """Table row of a mass: refusals with their 95 % confidence interval, and tensions inside their intervals."""
    probability = np.array([float(row["probability"]) for row in rows])
    refused = IntervalShare(probability.size, int(np.sum(probability < HOLD_OUT_LEVEL)), 1.0)
    known = [row for row in rows if row["contact_tension_sd"]]
    error = np.array([[float(row[f"{wire}_tension_sd"]) for wire in ("contact", "messenger")] for row in known])
    inside = (np.abs(error.reshape(-1, 2)) <= COVERED).sum(axis=0)
    return [
        scenario,
        f"{clamp_kg:g}",
        f"{len(rows)}",
        f"{refused.contained}",
        "{:.1f} to {:.1f}".format(*refused.confidence),
        f"{probability.min():.2g} to {probability.max():.2g}",
        f"{inside[0]} and {inside[1]} of {len(known)}",
    ]


def main() -> None:
    """Judge the lines that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, metavar="RESULTS.csv")
    for scenario, (count, _) in SCENARIOS.items():
        parser.add_argument(f"--{scenario}", type=int, default=count, help="lines for each mass; default: %(default)s")
    options = parser.parse_args()
    done = {(row["scenario"], float(row["clamp_kg"]), int(row["line"])) for row in read_rows(options.results)}
    for scenario, (_, clamps) in SCENARIOS.items():
        for number, clamp in product(range(getattr(options, scenario)), clamps):
            if (scenario, clamp, number) not in done:
                append_row(options.results, judge_line(scenario, clamp, number))
    stored = read_rows(options.results)
    found = {
        (scenario, clamp): [row for row in stored if (row["scenario"], float(row["clamp_kg"])) == (scenario, clamp)]
        for scenario, (_, clamps) in SCENARIOS.items()
        for clamp in clamps
    }
    heads = ["lines", "mass that each clamp lacks [kg]", "number", "refused by the held-out passage"]
    heads += ["confidence [%]", "probabilities", "tensions contained"]
    print_table(heads, (describe_rows(rows, *key) for key, rows in found.items() if rows))


if __name__ == "__main__":
    main()
