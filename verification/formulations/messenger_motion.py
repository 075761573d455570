"""Motion of the messenger wire along the track, exact and linear; prints the tables of docs/exact-model.md.

python -m verification.formulations.messenger_motion [--spans 20] [--element 0.25]
"""

import argparse
import sys
import time
from dataclasses import replace
from typing import get_args

import numpy as np

from pantocheck.model.modal.modes import compute_modes
from pantocheck.model.statics.elasticity import static_uplift
from verification.formulations.cable_stiffness import TensionLaw, irvine_parameter, linearise_wire
from verification.formulations.exact_case import AlongTrack, ExactCase, build_exact_case, change_pct, print_rows
from verification.formulations.exact_forces import natural_frequencies, point_elasticity
from verification.formulations.exact_line import ExactLine, support_points, watched_points
from verification.formulations.exact_passage import Rest, find_rest

MESSENGER = 1
"""Number of the messenger wire."""
COMPARED: dict[str, tuple[TensionLaw, ...]] = {
    "fixed": ("constant", "per span", "per span, second order"),
    "free": ("constant", "per section", "axial field free"),
}
"""Linear laws that are compared with the exact model, by the motion of the supports along the track."""
TANGENT_SPANS = 3
"""Spans of the line whose tangent stiffness is compared."""


def build_models(study: ExactCase) -> tuple[Rest, dict[str, ExactLine]]:
    """Rest of the exact model with a fixed messenger, and all models about this rest."""
    rest, supports = study.find_rest(), support_points(study.line)
    models = {"exact, fixed": rest.line, "exact, free": study.release(rest).line}
    for law in get_args(TensionLaw):
        models[law] = linearise_wire(rest.line, rest.position, MESSENGER, supports, law)
    return rest, models


def print_tangent(element: float) -> None:
    """Print Irvine's parameter, and elasticities and lowest frequencies for small displacements."""
    study = build_exact_case(TANGENT_SPANS, element, 0.0)
    rest, models = build_models(study)
    limits = np.array([rest.line.wires.first[MESSENGER], *support_points(study.line), rest.line.wires.last[MESSENGER]])
    parameter = irvine_parameter(rest.line, rest.position, MESSENGER, limits)
    print(f"\nIrvine's parameter of the spans: {', '.join(f'{value:.2f}' for value in parameter)}\n")
    geometry = study.case.line.geometry
    start, middle = geometry.span(geometry.middle_span)[0], geometry.mid_span(geometry.middle_span)
    wire = study.line.catenary.contact_wires[0].name
    points = watched_points(study.line, ((wire, start), (wire, (start + middle) / 2), (wire, middle)))
    names = [f"frequency {n} [Hz]" for n in range(1, TANGENT_SPANS + 1)]
    names += ["elasticity at the support [mm/N]", "at a quarter", "in mid-span"]
    print(f"| model | {' | '.join(names)} |\n| :-- |{' --: |' * len(names)}")
    for name, line in models.items():
        frequencies = natural_frequencies(line, rest.position, TANGENT_SPANS, axes=(0, 2))
        values = [*frequencies, *(1e3 * point_elasticity(line, rest.position, points))]
        print(f"| {name} | {' | '.join(f'{value:.4f}' for value in values)} |", flush=True)
    for along_track in get_args(AlongTrack):
        reference = study.build_reference(along_track)
        elasticity = static_uplift(reference, np.array([start, (start + middle) / 2, middle]), 1.0)
        values = [*compute_modes(reference, TANGENT_SPANS).frequency, *(1e3 * elasticity)]
        print(f"| reference simulator, {along_track} | {' | '.join(f'{value:.4f}' for value in values)} |", flush=True)


def print_passages(spans: int, element: float) -> None:
    """Print the quantities of a passage in the vertical plane."""
    study = build_exact_case(spans, element, 0.0)
    rest, models = build_models(study)
    rows = {}
    for name, line in models.items():
        at_rest = find_rest(line, rest.position) if name in get_args(TensionLaw) else replace(rest, line=line)
        rows[name] = study.simulate_exactly(at_rest)
        print(f"{name}: {rows[name]}", file=sys.stderr, flush=True)
    print(f"\nPassage, spans {study.section[0]} to {study.section[1]} of {spans}, elements of {element:g} m\n")
    print_rows(rows)
    print("\nDifference to the exact model [%]\n")
    print_rows(
        {
            f"{along_track}: {law}": change_pct(rows[law], rows[f"exact, {along_track}"])
            for along_track, laws in COMPARED.items()
            for law in laws
        }
    )


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--spans", type=int, default=20, help="spans of the line of the passages; 0: no passage")
    options.add_argument("--element", type=float, default=0.25, help="distance of the mass points [m]")
    chosen = options.parse_args()
    print_tangent(0.25)
    if chosen.spans:
        print_passages(chosen.spans, chosen.element)
    print(f"\n{time.process_time():.0f} s of process time.")


if __name__ == "__main__":
    main()
