"""Passages through overlaps of tension sections; prints the tables of docs/sections.md.

python -m verification.tables.overlap_passages

AC simple of EN 50318:2018 with sections of 22 spans of 55 m; the wires rise by 0.5 m. The line without overlaps has the
same spans in one section.
"""

import argparse
import math
import os
import time
from dataclasses import replace

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.tension_section import OverlapTable, SectionTable
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.model import DiscretisedLine, History, Passage, discretise, simulate_passage
from pantocheck.model.discretisation.discretised_line import max_wave_speed
from verification.speed.passage_lines import ac_simple, passage

SPANS, RISE, SPAN = 22, 0.5, 55.0
ELEMENT, STEP = 0.5, 1e-3
LOW_PASS = Filter()
NAMES = ("σ", "min", "max")
KEPT_BEHIND = 1.5 * SPAN
REACH = 660.0
"""Half-width of the active window, as of the case [m]."""


def sectioned(case: Case, sections: int, overlap: int) -> Case:
    """A case on sections of 22 spans with overlaps of a number of spans."""
    spans = sections * SPANS - (sections - 1) * overlap
    line = case.line.shorten(spans).model_copy(
        update={
            "section": (SectionTable(spans=SPANS),) * sections,
            "overlap": OverlapTable(spans=overlap, anchor_rise_m=RISE),
        }
    )
    return replace(case, line=line)


def whole(case: Case) -> Case:
    """The same spans in one section."""
    return replace(case, line=case.line.shorten(case.line.geometry.spans))


def discretised(case: Case, element: float = ELEMENT) -> DiscretisedLine:
    """Line of a case."""
    return discretise(build_catenary(case.line), element)


def run(
    case: Case, pantographs: int, until: float, reach: float = math.inf, scale: float = 1.0
) -> tuple[Passage, History, float]:
    """Passage up to a position [m] with scaled element length and time step, and process time per simulated time."""
    line = discretised(case, scale * ELEMENT)
    way = passage(case, line, scale * STEP, pantographs, until, reach)
    way = replace(way, kept_behind=KEPT_BEHIND, watched=())
    simulate_passage(line, replace(way, duration=0.01))
    begin = time.process_time()
    history = simulate_passage(line, way)
    return way, history, (time.process_time() - begin) / way.duration


def statistics(case: Case, history: History, pantograph: int, step: float) -> str:
    """Mean, standard deviation, smallest and largest 20 Hz force in the overlaps and elsewhere, from span 11 on [N]."""
    force = LOW_PASS(history.force[pantograph], 1 / step)
    x = history.position[pantograph]
    settled = x > 10 * SPAN
    inside = np.any([(start <= x) & (x < end) for start, end in case.line.overlaps], axis=0)
    parts = (force[settled & inside], force[settled & ~inside])
    return " | ".join(f"{part.mean():.1f} | {part.std():.1f} | {part.min():.0f} | {part.max():.0f}" for part in parts)


def print_overlaps(case: Case) -> None:
    """Forces in and outside of overlaps of one to five spans, on three sections."""
    names = (
        "overlap [spans]",
        "pantograph",
        "mean, in overlaps",
        *NAMES,
        "mean, elsewhere",
        *NAMES,
        "process time / s",
    )
    print(f"| {' | '.join(names)} |\n|{' --: |' * len(names)}")
    for overlap in range(1, 6):
        here = sectioned(case, 3, overlap)
        for pantographs in (1, 2):
            end = here.line.geometry.length - 6 * SPAN
            way, history, ratio = run(here, pantographs, end, REACH)
            for p in range(pantographs):
                name = "alone" if pantographs == 1 else ("leading", "trailing")[p]
                values = statistics(here, history, p, way.time_step)
                print(f"| {overlap} | {name} | {values} | {ratio:.3f} |", flush=True)


def print_difference(case: Case) -> None:
    """Largest difference of the force from that of the line without overlaps, by distance from the overlap."""
    here = sectioned(case, 3, 3)
    start = here.line.overlaps[0][0]
    (way, first, _), (_, second, _) = (run(each, 2, start + 16 * SPAN) for each in (here, whole(here)))
    difference = np.abs(first.force - second.force)
    # The rear end of the incoming wires is at the start of the overlap: a wave from the head returns from there.
    c = max_wave_speed(discretised(here, 5.0))
    arrival = 2 * (start - first.position[0, 0]) / (c + way.speed)
    before = first.time < arrival
    print("\n| distance of the head from the start of the overlap | leading | trailing |\n| :-- | --: | --: |")
    reached = first.position[0][before].max() - start
    print(f"| to {reached:.0f} m, before a wave can return | " + cells(difference[:, before], "{:.1e} N") + " |")
    for low, high in ((-3, 0), (0, 3), (3, 5), (5, 8), (8, 12), (12, 16)):
        inside = (first.position >= start + low * SPAN) & (first.position < start + high * SPAN)
        print(f"| {low} to {high} spans | {cells(np.where(inside, difference, 0.0), '{:.3g} N')} |")


def cells(values: np.ndarray, form: str) -> str:
    """Largest value of each row as cells of a table."""
    return " | ".join(form.format(row.max()) for row in values)


def print_convergence(case: Case) -> None:
    """Forces in the first overlap with coarser and finer elements and steps."""
    here = sectioned(case, 2, 3)
    start, end = here.line.overlaps[0]
    print("\n| element [m] | time step [ms] | σ in the overlap | min | max |\n| --: | --: | --: | --: | --: |")
    for scale in (2.0, 1.0, 0.5, 0.25):
        way, history, _ = run(here, 1, end + 2 * SPAN, REACH, scale)
        force = LOW_PASS(history.force[0], 1 / way.time_step)
        part = force[(history.position[0] >= start) & (history.position[0] < end)]
        print(
            f"| {scale * ELEMENT:g} | {1e3 * scale * STEP:g} | {part.std():.2f} | {part.min():.1f} | {part.max():.1f} |"
        )


def main() -> None:
    """Measure and print."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    case = ac_simple(400)
    print_overlaps(case)
    print_difference(case)
    print_convergence(case)


if __name__ == "__main__":
    main()
