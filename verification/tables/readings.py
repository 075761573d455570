"""Readings of "0-20 Hz" on the EN 50318 cases; prints the tables of docs/readings.md.

python -m verification.tables.readings

One run of the reference simulator for each case; only the evaluation differs. An asterisk marks a value outside its
limits.
"""

import argparse
import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Reading
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.criterion_grading import GradedValues, grade_limit
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.bands import band_part, band_rms
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered

EDITIONS = {
    "2018": ("en50318-2018/ac-simple/275", "en50318-2018/ac-simple/320"),
    "2002": ("en50318-2002/250", "en50318-2002/300"),
}
FORCES = ("std_force_N", "max_force_N", "min_force_N")
LOW_BANDS = ("rms_0_5_N", "rms_5_20_N")
TWICE = partial(Filter, attenuation_dB=6, bands="band-pass")
"""Filter that is run forwards and backwards without correction of its cut-off; the argument is its total order."""
CAUSAL = partial(Filter, phase="causal", bands="band-pass")
READINGS = {
    "default: order 3 twice, -3 dB in total": Filter(),
    "order 2 twice, -3 dB in total": Filter(order=4, bands="band-pass"),
    **{f"order {order} twice": TWICE(order=2 * order) for order in (2, 3, 4, 6)},
    **{f"causal, order {order}": CAUSAL(order=order) for order in (2, 4, 6)},
}
OTHER_FORCES = ("ideal low-pass",)
OTHER_BANDS = ("spectral lines of the filtered force", "squares of sigma at 5 and 20 Hz subtracted")
"""Definitions that are no filter of their own."""


class Run(NamedTuple):
    """Case with its run by the reference simulator."""

    case: Case
    delivered: Delivered

    def read(self, low_pass: Filter) -> CaseEvaluation:
        """Evaluation under a filter."""
        return CaseEvaluation(self.case.with_reading(Reading(id="tried", filter=low_pass)), self.delivered)

    def list_misses(self, low_pass: Filter) -> list[str]:
        """Quantities outside their limits under a filter, whatever the trust of the limits."""
        values = GradedValues(self.read(low_pass).evaluation)
        rows = [grade_limit(limit, values, "provisional") for limit in self.case.limits]
        return [f"{row.quantity} {self.case.file.speed_km_h:g}" for row in rows if row.verdict != "pass"]

    def mark(self, names: Sequence[str], values: Sequence[float]) -> list[str]:
        """Values with an asterisk outside their limits."""
        limits = {limit.quantity: (limit.lower or -math.inf, limit.upper or math.inf) for limit in self.case.limits}
        inside = [limits[name][0] <= value <= limits[name][1] for name, value in zip(names, values, strict=True)]
        return [f"{value:.2f}{'' if kept else '*'}" for value, kept in zip(values, inside, strict=True)]

    def force_cells(self, low_pass: Filter) -> list[str]:
        """Statistics of the filtered force."""
        values = self.read(low_pass).evaluation.values[1]
        return self.mark(FORCES, [float(values[name]) for name in FORCES])  # type: ignore[arg-type]

    def band_cells(self, low_pass: Filter) -> list[str]:
        """Bands, and the root of their sum of squares against the standard deviation."""
        values = self.read(low_pass).evaluation.values[1]
        low, high, std = (float(values[name]) for name in (*LOW_BANDS, "std_force_N"))  # type: ignore[arg-type]
        return self.compare(low, high, std)

    def compare(self, low: float, high: float, std: float) -> list[str]:
        """Cells of two bands and a standard deviation [N]."""
        return [*self.mark(LOW_BANDS, (low, high)), f"{100 * (math.hypot(low, high) / std - 1):+.1f} %"]

    def other_cells(self) -> dict[str, list[str]]:
        """Cells of the definitions that are no filter: an ideal low-pass, and two other bands."""
        signals = self.read(Filter()).signals
        assert signals is not None
        part = signals.pantographs[1]
        force, rate, inside = part.force.delivered, part.rate, part.inside
        ideal = (force.mean() + band_part(force, rate, 0, 20))[inside]
        low, whole = (float(Filter(cutoff_Hz=cutoff)(force, rate)[inside].std()) for cutoff in (5.0, 20.0))
        lines = [band_rms(part.graded, rate, *edges) for edges in ((0, 5), (5, 20))]
        return {
            OTHER_FORCES[0]: self.mark(FORCES, [ideal.std(), ideal.max(), ideal.min()]),
            OTHER_BANDS[0]: self.compare(*lines, whole),
            OTHER_BANDS[1]: self.compare(low, math.sqrt(whole**2 - low**2), whole),
            "18 to 22 Hz": [f"{band_rms(part.delivered, rate, 18, 22):.1f} N"],
        }


def print_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table in Markdown."""
    print(f"\n| {' | '.join(headings)} |\n| :-- |{' --: |' * (len(headings) - 1)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")


def main() -> None:
    """Run the cases, and print the tables."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    cases = {name: load_case(library_folder() / f"{name}.toml") for names in EDITIONS.values() for name in names}
    runs = {name: Run(case, ReferenceSimulator().run_unrefined(case)) for name, case in cases.items()}
    shown = [runs[name] for name in EDITIONS["2018"]]
    others = [run.other_cells() for run in shown]

    for title, columns, cells, extra in (
        ("reading of 20 Hz", ("sigma", "max", "min"), Run.force_cells, OTHER_FORCES),
        ("reading of the bands", ("0-5", "5-20", "sum over sigma"), Run.band_cells, OTHER_BANDS),
    ):
        rows = [[label, *cells(shown[0], low_pass), *cells(shown[1], low_pass)] for label, low_pass in READINGS.items()]
        rows += [[label, *others[0][label], *others[1][label]] for label in extra]
        print_table([title, *(f"{run.case.file.speed_km_h:g}: {column}" for run in shown for column in columns)], rows)
    rows = []
    for label, low_pass in READINGS.items():
        row = [label]
        for names in EDITIONS.values():
            missed = [text for name in names for text in runs[name].list_misses(low_pass)]
            limits = sum(len(cases[name].limits) for name in names)
            row += [f"{limits - len(missed)} of {limits}", ", ".join(missed) or "none"]
        rows.append(row)
    print_table(["reading", *(text for edition in EDITIONS for text in (edition, f"missed {edition}"))], rows)
    print(f"\nForce at 18 to 22 Hz: {', '.join(cells for each in others for cells in each['18 to 22 Hz'])}")


if __name__ == "__main__":
    main()
