"""Search of a damping that agrees with Vo Van, Balmes and Lorang (2015), as a stand-in for their measured line.

    python -m verification.tables.stand_in_search --out reference_cases/vovan2015/damping/stand-in.toml

A candidate has one damping ratio per group of span modes, constant in the group: that of group 1, two ratios between
neighbouring groups, and an exponent of the frequency from group 3 on. The candidates are a seeded Sobol sequence in the
ranges of `RANGES`; each further round searches the smallest box around the best candidates so far. The imposed findings
of the case vovan2015/mass-drop/stand-in are graded on the computed modes of its line. The candidate with the largest
least margin wins: it is the farthest from every bound.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import tomli_w
from scipy.stats import qmc

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.verdicts import margin
from pantocheck.conformance.drops.mode_groups import LAST_GROUP, number_groups
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.studies.vovan2015.line_damping import (
    compare_reference,
    compute_group_findings,
    computed_damping_ratios,
)
from pantocheck.model import discretise
from pantocheck.model.modal.modes import compute_modes_below

CASE = "vovan2015/mass-drop/stand-in"
REFERENCE = "initial"
SEED, CANDIDATES, ROUNDS, BEST = 20150817, 1024, 4, 16
RANGES = {
    "damping ratio of group 1, log10": (np.log10(5e-4), np.log10(1e-2)),
    "group 2 over group 1": (0.5, 1.2),
    "group 3 over group 2": (0.5, 1.2),
    "exponent of the frequency from group 3 on": (-0.5, 0.5),
}
"""Lower and upper end of each parameter: well beyond every finding on both sides."""
OF_THE_LINE = {"modes_in_group", "mode_frequency_Hz"}
"""Quantities that the damping does not change; the line was chosen with them."""
DIGITS = 5
"""Decimals of a damping ratio in the file."""


@dataclass(frozen=True)
class GroupedLine:
    """Line of the case without damping, and the reference model on it."""

    frequency: RealArray
    """Median frequency of each group of span modes, (g,) [Hz]."""
    edges: RealArray
    """Limits between the groups, half-way between their outer modes, (g + 1,) [Hz]."""
    modes: RealArray
    reference: RealArray
    """Frequencies of the modes [Hz], and their damping ratios under the reference model [-], (n,)."""


def group_line(case: Case) -> GroupedLine:
    """Compute the modes of the line of a case and divide them into groups."""
    line = build_catenary(case.line)
    mesh = discretise(line, case.file.discretisation.element_m)
    shapes = compute_modes_below(mesh, 9.0)
    model = build_catenary(case.with_damping(REFERENCE, case.dampings[REFERENCE]).line)
    groups = number_groups(shapes.frequency, shapes.frequency, case.line.geometry.spans)
    members = [shapes.frequency[groups == number] for number in range(1, LAST_GROUP + 1)]
    between = [(low[-1] + high[0]) / 2 for low, high in pairwise(members)]
    width = between[1] - between[0]
    return GroupedLine(
        frequency=np.array([np.median(group) for group in members]),
        edges=np.array([between[0] - width, *between, between[-1] + width]),
        modes=shapes.frequency,
        reference=computed_damping_ratios(mesh, shapes, model),
    )


def damping_of_groups(parameters: RealArray, frequency: RealArray) -> RealArray:
    """Damping ratio of each group, (g,), from the four parameters in the order of `RANGES`; rounded as in the file."""
    logarithm, second, third, exponent = parameters
    first = 10**logarithm
    later = first * second * third * (frequency[2:] / frequency[2]) ** exponent
    return np.round(np.array([first, first * second, *later]), DIGITS)


def grade_damping(ratio: RealArray, line: GroupedLine, limits: Sequence[Limit]) -> list[float]:
    """Margin of each limit for the damping ratios of the groups, (g,), which identification would find exactly."""
    modes = [
        Mode(
            frequency_Hz=float(frequency),
            damping_ratio=float(damping),
            damping_ratio_std=0.0,
            group=number,
            sensor_shape=(),
            record="candidate",
        )
        for number, (frequency, damping) in enumerate(zip(line.frequency, ratio, strict=True), 1)
    ]
    values = compute_group_findings(modes)
    values["reference_over_identified_damping"] = compare_reference(modes, line.modes, line.reference)
    found = [find_value(limit.target, {LINE: values}) for limit in limits]
    return [
        -np.inf if value is None else margin(value, limit.lower, limit.upper)
        for value, limit in zip(found, limits, strict=True)
    ]


def search(line: GroupedLine, limits: Sequence[Limit]) -> tuple[RealArray, RealArray]:
    """Search the candidates.

    Returns:
        chosen: Parameters of the candidate with the largest least margin, (4,).
        agreeing: Candidates of the first round that meet every limit, (n, 4).
    """
    found = [search_box(*np.transpose(list(RANGES.values())), line, limits)]
    for _ in range(1, ROUNDS):
        best = found[-1][0][:BEST]
        found.append(search_box(best.min(axis=0), best.max(axis=0), line, limits))
    candidates, least = found[0]
    return max(found, key=lambda pair: pair[1][0])[0][0], candidates[least >= 0]


def search_box(
    lower: RealArray, upper: RealArray, line: GroupedLine, limits: Sequence[Limit]
) -> tuple[RealArray, RealArray]:
    """Candidates between two corners, (n, 4), the best first, and their least margins, (n,)."""
    sample = qmc.Sobol(len(RANGES), rng=np.random.default_rng(SEED)).random(CANDIDATES)
    candidates = qmc.scale(sample, lower, upper)
    least = np.array([min(grade_damping(damping_of_groups(p, line.frequency), line, limits)) for p in candidates])
    order = np.argsort(-least, kind="stable")
    return candidates[order], least[order]


def select_imposed(case: Case) -> list[Limit]:
    """Limits of imposed findings that depend on the damping."""
    return [limit for limit in case.limits if limit.is_imposed and limit.quantity not in OF_THE_LINE]


def write_damping(ratio: RealArray, line: GroupedLine) -> str:
    """Damping file with a band for each group, and Rayleigh damping above that continues it at the last edge."""
    stiffness = float(f"{ratio[-1] / (np.pi * line.edges[-1]):.3g}")
    wire = {"stiffness_coefficient_s": stiffness}
    bands = [
        {"from_Hz": round(float(low), 3), "to_Hz": round(float(high), 3), "damping_ratio": float(damping)}
        for low, high, damping in zip(line.edges[:-1], line.edges[1:], ratio, strict=True)
    ]
    table = {
        "trust": "provisional",
        "source": "assumed",
        "note": "Damping of the stand-in for the measured line, written by verification/tables/stand_in_search.py. "
        "Each group of span modes has a constant damping ratio, which the search chose with the imposed findings of "
        "the paper. Above the last group, stiffness damping of both wires continues it.",
        "contact_wire": wire,
        "messenger_wire": wire,
        "modal": bands,
    }
    return "#:schema ../../schema/damping.schema.json\n" + tomli_w.dumps({"damping": table})


def print_search(chosen: RealArray, agreeing: RealArray, line: GroupedLine, limits: Sequence[Limit]) -> None:
    """Print the range of each parameter over the candidates that meet every finding, and the margins of the chosen."""
    print(f"{len(agreeing)} of {CANDIDATES} candidates of the first round meet every imposed finding")
    for name, value, values in zip(RANGES, chosen, agreeing.T, strict=True):
        low, high, best = ((10**x if "log10" in name else x) for x in (values.min(), values.max(), value))
        print(f"{name.removesuffix(', log10'):<45}{low:>10.4g} to {high:<10.4g} chosen {best:.4g}")
    ratio = damping_of_groups(chosen, line.frequency)
    print("damping ratio of the groups [%]:", *(f"{100 * z:.3f}" for z in ratio))
    margins = zip(grade_damping(ratio, line, limits), limits, strict=True)
    for value, limit in sorted(margins, key=lambda pair: pair[0]):
        print(f"margin {value:+8.3f}  {limit.finding.sentence if limit.finding else limit.quantity}")


def main() -> None:
    """Search, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="damping file to write")
    out: Path = parser.parse_args().out
    (case,) = select_cases([CASE])
    line = group_line(case)
    limits = select_imposed(case)
    chosen, agreeing = search(line, limits)
    print_search(chosen, agreeing, line, limits)
    out.write_text(write_damping(damping_of_groups(chosen, line.frequency), line), encoding="utf-8")


if __name__ == "__main__":
    main()
