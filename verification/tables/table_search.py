"""Search for a scenario of Table 1 of Vo Van, Balmes and Lorang (2015).

python -m verification.tables.table_search --out docs/table-1-search.csv

The front pantograph runs alone in every scenario of the grid, with the initial damping only. The search compares its
RMS up to 20 Hz with the printed values under the initial damping. It uses no printed change, and no value of the rear
pantograph. The command writes every scenario, and prints the closest ones.
"""

import argparse
import csv
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.studies.vovan2015.damping_change import COMPARED_QUANTITIES
from verification.tables.table_scenarios import (
    PANTOGRAPHS,
    TENSIONS_N,
    InitialRun,
    Scenario,
    load_study,
    run_initial,
    wave_speed,
)

SPANS_M = (50.0, 54.0, 63.0)
PRESAG_SHARES = (0.0, 1e-3)
SPEEDS_KM_H = (270.0, 285.0, 300.0)
LARGEST_SHARE_OF_WAVE_SPEED = 0.7
"""Rule for the speed of a line over the wave speed of its contact wire (profile acceptance-ac)."""
LARGEST_CONTACT_LOSS_PCT = 0.1
LARGEST_UPLIFT_MM = 100.0
"""Bounds of a scenario as on a line in service: a choice, above the values of AC simple with two pantographs."""
COMPARED_BANDS = ("rms_0_5_N", "rms_5_20_N")
"""Bands whose levels are compared: above 20 Hz, lumped pantographs are not validated."""
LISTED = 8


def front_grid() -> Iterator[Scenario]:
    """Scenarios of the front pantograph whose speed obeys the rule on the wave speed."""
    for values in product(SPANS_M, TENSIONS_N, PRESAG_SHARES, SPEEDS_KM_H, PANTOGRAPHS):
        scenario = Scenario(*values)
        if scenario.speed_km_h / 3.6 <= LARGEST_SHARE_OF_WAVE_SPEED * wave_speed(scenario):
            yield scenario


def level_error(run: InitialRun) -> float:
    """Root mean square of the logarithm of computed over printed RMS in the compared bands, initial damping."""
    printed = {table.pantograph: table.values for table in load_study().file.study.printed if table.model == "initial"}
    ratios = [float(run.values[p][band]) / printed[p][band] for p in run.pantographs for band in COMPARED_BANDS]
    return float(np.sqrt(np.mean(np.log(ratios) ** 2)))


def is_plausible(run: InitialRun) -> bool:
    """Whether contact loss and uplift are as on a line in service."""
    return run.contact_loss_pct <= LARGEST_CONTACT_LOSS_PCT and run.uplift_mm <= LARGEST_UPLIFT_MM


def count_reproduced(changes: ValuesByOwner) -> int:
    """Number of findings of the case that the changes reproduce."""
    values = [(limit, find_value(limit.target, changes)) for limit in load_study().limits]
    return sum(value is not None and judge(value, limit.lower, limit.upper) == "pass" for limit, value in values)


def run_all(scenarios: Iterable[Scenario], path: Path) -> list[InitialRun]:
    """Run scenarios and write one row each; return the plausible ones, the closest first."""
    runs: list[InitialRun] = []
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for scenario in scenarios:
            run = run_initial(scenario)
            if run is None:
                writer.writerow([*scenario, "no solution"])
                continue
            names = ("mean_force_N", *COMPARED_QUANTITIES)
            if not runs:
                heads = [f"{name} {p}" for p in run.pantographs for name in names]
                writer.writerow([*Scenario._fields, *heads, "contact_loss_pct", "uplift_mm", "level_error"])
            levels = [run.values[p][name] for p in run.pantographs for name in names]
            facts = (run.contact_loss_pct, run.uplift_mm, level_error(run))
            writer.writerow([*scenario, *(f"{level:.4g}" for level in levels), *(f"{fact:.3g}" for fact in facts)])
            file.flush()
            runs.append(run)
    plausible = sorted(filter(is_plausible, runs), key=level_error)
    print(f"\n{path.stem}: {len(runs)} scenarios, {len(plausible)} plausible")
    return plausible


def print_levels(runs: Sequence[InitialRun]) -> None:
    """Print the levels of scenarios as a Markdown table."""
    print("\n| scenario | coefficient of variation | RMS by band [N] | contact loss [%] | uplift [mm] | level error |")
    print("|---|---|---|--:|--:|--:|")
    for run in runs:
        variation = "; ".join(f"{run.values[p]['cov_20']:.2f}, {run.values[p]['cov_50']:.2f}" for p in run.pantographs)
        bands = "; ".join(
            ", ".join(f"{run.values[p][name]:.1f}" for name in COMPARED_QUANTITIES[2:]) for p in run.pantographs
        )
        facts = f"{run.contact_loss_pct:.1f} | {run.uplift_mm:.0f} | {level_error(run):.2f}"
        print(f"| {name_scenario(run.scenario)} | {variation} | {bands} | {facts} |")


def name_scenario(scenario: Scenario) -> str:
    """Scenario in words."""
    spacing = "" if scenario.spacing_m is None else f", {scenario.spacing_m:g} m apart"
    return (
        f"{scenario.span_m:g} m, {scenario.tensions} kN, pre-sag {1e3 * scenario.presag_share:g} mm/m, "
        f"{scenario.speed_km_h:g} km/h, {scenario.pantograph}{spacing}"
    )


def main() -> None:
    """Search and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", type=Path, required=True, help="CSV file for the scenarios")
    print_levels(run_all(front_grid(), options.parse_args().out)[:LISTED])


if __name__ == "__main__":
    main()
