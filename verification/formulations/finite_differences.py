"""Second formulation against the reference simulator; prints the tables of docs/second-formulation.md.

python -m verification.formulations.finite_differences [CASE ...] [--coarse 0.25] [--fine 0.125] [--jobs 2]
    [--pantograph FILE [--law constraint]]
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.toml_file import read_model, read_toml, validate_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import ContactTable, PantographFile
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.command_system import build_case_message
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.statics.elasticity import static_uplift
from verification.formulations.difference_passage import (
    LINE_QUANTITIES,
    QUANTITIES,
    Quantities,
    difference_quantities,
    force_quantities,
    name_forces,
)
from verification.formulations.library_passages import PASSAGES
from verification.formulations.parallel_wires import merge_parallel_wires

FINE_MESH = (0.125, 2.5e-4)
"""Element length [m] and time step [s] of the reference simulator."""
AIM_PCT = 1.0
"""Largest difference of the standard deviation and of a band, with which a value counts as confirmed."""
AIMED = ("std_force_N", "rms_0_5_N", "rms_5_20_N", "rms_20_50_N")


@dataclass(frozen=True)
class Comparison:
    """Quantities of a case at the coarse and the fine spacing, and of the reference simulator."""

    case: str
    uplift_forces: tuple[float, ...]
    coarse: Quantities
    fine: Quantities
    reference: Quantities

    @property
    def limit(self) -> Quantities:
        """Richardson extrapolation of order 2 for spacings h and h / 2."""
        return {key: value + (value - self.coarse[key]) / 3 for key, value in self.fine.items()}

    @property
    def difference_pct(self) -> Quantities:
        """Extrapolated second formulation minus reference simulator [%]."""
        return {key: 100 * (value / self.reference[key] - 1) for key, value in self.limit.items()}


def compare(name: str, coarse: float, fine: float, pantograph: PantographFile | None = None) -> Comparison:
    """Run a case with both formulations and the same uplift forces, with its pantographs or with another one."""
    case = find_case(name)
    if pantograph is not None:
        case = replace(case, pantographs=(pantograph,) * len(case.pantographs))
    forces, message = uplift_forces(case), build_case_message(merge_parallel_wires(case))
    return Comparison(
        name,
        forces,
        difference_quantities(message, coarse, forces),
        difference_quantities(message, fine, forces),
        reference_quantities(case, *FINE_MESH, forces),
    )


def find_case(name: str) -> Case:
    """Library case by its id; behind a plus sign, the name of a change of its line in changed_lines.toml."""
    id_, _, change = name.partition("+")
    case = next(candidate for candidate in select_cases([id_]) if candidate.id == id_)
    if not change:
        return case
    changes = read_toml(Path(__file__).with_name("changed_lines.toml"), "changed lines")[change]
    tables = case.line.model_dump(mode="json", exclude_unset=True)
    tables |= {key: table if isinstance(table, list) else tables.get(key, {}) | table for key, table in changes.items()}
    return replace(case, line=validate_model(tables, LineFile, name))


def uplift_forces(case: Case) -> tuple[float, ...]:
    """Uplift forces of the case; where it has none, those to which the reference simulator tunes its default mesh."""
    forces = [lift.stated_uplift_force for lift in case.lift_forces]
    if None not in forces:
        return tuple(map(float, forces))
    discretisation = case.file.discretisation
    line = discretise(build_catenary(case.line), discretisation.element_m)
    return run_passage(case, line, discretisation).uplift_forces


def reference_quantities(case: Case, element: float, step: float, forces: tuple[float, ...]) -> Quantities:
    """Quantities of a case on the reference simulator; pantograph 0 is the line."""
    discretisation = case.file.discretisation.model_copy(update={"element_m": element, "time_step_s": step})
    line = discretise(build_catenary(case.line), element)
    record = run_passage(case, line, discretisation, forces).record
    signals = RecordSignals(record, case.file.filter, case.line.geometry.supports)
    values = signals.evaluation.values
    quantities = {(k, name): float(values[k][name]) for k in range(1, len(forces) + 1) for name in QUANTITIES}
    quantities |= _strip_quantities(case, record)
    uplift = 1e3 * signals.delivered_line.largest_uplift  # of a short run, too, which begins near its supports
    return quantities | {
        (0, name): value for name, value in zip(LINE_QUANTITIES, (uplift, *_elasticity(case, line)), strict=True)
    }


def _strip_quantities(case: Case, record: Record) -> Quantities:
    """Quantities of the force of every strip; none of a head with one strip."""
    if record.front_strip is None or record.rear_strip is None:
        return {}
    section, low_pass, edges = case.analysis_section, case.file.filter, [(band.low, band.high) for band in BANDS]
    strips = zip(record.position, record.front_strip, record.rear_strip, strict=True)
    return {
        (k, channel + name): value
        for k, (position, *forces) in enumerate(strips, 1)
        for channel, force in name_forces(np.array(forces)).items()
        if channel
        for name, value in force_quantities(force, position, record.rate, section, low_pass, edges).items()
    }


def _elasticity(case: Case, line: DiscretisedLine) -> list[float]:
    """Uplift per force in mid-span and at the support [mm/N]."""
    start, end = case.line.geometry.span(case.analysed_spans[0])
    return [1e3 * float(u) for u in static_uplift(line, np.array([(start + end) / 2, start]), 1.0)]


def print_comparison(comparison: Comparison, spacings: Sequence[float]) -> None:
    """Print the table of one case in Markdown."""
    forces = ", ".join(f"{force:.3f}" for force in comparison.uplift_forces)
    print(f"\n## {comparison.case}\n\nUplift force {forces} N.\n")
    columns = ["quantity", *(f"{h:g} m" for h in spacings), "extrapolated", "reference", "difference [%]"]
    print(f"| pantograph | {' | '.join(columns)} |\n| --: | :-- |{' --: |' * 5}")
    for key, limit in sorted(comparison.limit.items(), key=lambda item: item[0][0] or 99):
        values = (comparison.coarse[key], comparison.fine[key], limit, comparison.reference[key])
        digits = 4 if "elasticity" in key[1] else 2
        numbers = " | ".join(f"{value:.{digits}f}" for value in values)
        print(f"| {key[0] or 'line'} | {key[1]} | {numbers} | {comparison.difference_pct[key]:+.2f} |", flush=True)


def print_summary(comparisons: Sequence[Comparison]) -> None:
    """Print the largest difference of every quantity, and the entries that miss the aim."""
    print("\n## Largest differences\n\n| quantity | difference [%] | case | pantograph |\n| :-- | --: | :-- | --: |")
    entries = [(c.case, key, value) for c in comparisons for key, value in c.difference_pct.items()]
    for name in dict.fromkeys(key[1] for _, key, _ in entries):
        case, (pantograph, _), value = max((e for e in entries if e[1][1] == name), key=lambda e: abs(e[2]))
        print(f"| {name} | {value:+.2f} | {case} | {pantograph or 'line'} |")
    above = [
        f"{case}, pantograph {key[0]}, {key[1]} {value:+.2f} %"
        for case, key, value in entries
        if key[1].split()[-1] in AIMED and abs(value) > AIM_PCT
    ]
    print(f"\nStandard deviations and bands that differ by more than {AIM_PCT:g} %: {'; '.join(above) or 'none'}.")


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", default=PASSAGES, metavar="CASE")
    options.add_argument("--coarse", type=float, default=0.25, help="coarse spacing of the points [m]")
    options.add_argument(
        "--fine", type=float, default=0.125, help="fine spacing of the points, half the coarse one [m]"
    )
    options.add_argument("--jobs", type=int, default=1, help="cases that run at the same time")
    options.add_argument("--pantograph", type=Path, help="pantograph file in place of those of the cases")
    options.add_argument("--law", choices=("spring", "constraint"), default="spring", help="contact of that pantograph")
    chosen = options.parse_args()
    pantograph = None
    if chosen.pantograph is not None:
        pantograph = read_model(chosen.pantograph, PantographFile, "pantograph")
        if chosen.law == "constraint":
            pantograph = pantograph.model_copy(update={"contact": ContactTable(law="constraint")})
    comparisons = []
    with ProcessPoolExecutor(chosen.jobs) as executor:
        runs = [executor.submit(compare, name, chosen.coarse, chosen.fine, pantograph) for name in chosen.cases]
        for run in runs:
            comparisons.append(run.result())
            print_comparison(comparisons[-1], (chosen.coarse, chosen.fine))
    print_summary(comparisons)


if __name__ == "__main__":
    main()
