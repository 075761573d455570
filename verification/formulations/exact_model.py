"""Geometrically exact model in space against the reference simulator; prints the first table of docs/exact-model.md.

python -m verification.formulations.exact_model [--spans 20] [--element 0.25] [--stagger 0 0.2] [--models MODEL ...]
"""

import argparse
import sys
import time
from functools import partial

import numpy as np

from verification.formulations.exact_case import ExactCase, build_exact_case, change_pct, print_rows
from verification.formulations.exact_passage import Rest

MODELS = {
    "reference-free": "reference simulator, messenger free",
    "reference-fixed": "reference simulator, messenger fixed",
    "exact-free": "exact, messenger free",
    "exact-fixed": "exact, messenger fixed",
}
"""Names of the models in the tables."""


def print_rest(study: ExactCase, rest: Rest) -> None:
    """Print the static tensions of one span and the distance to the linear static state."""
    geometry, droppers, state = study.case.line.geometry, study.line.catenary.droppers, study.line.state
    start, end = geometry.span(geometry.middle_span)
    inside = [n for n, dropper in enumerate(droppers) if start < dropper.position < end]
    pairs = [f"{rest.bar_tension[n]:.1f} ({state.dropper_tension[n]:.1f})" for n in inside]
    print(f"Dropper tensions of span {geometry.middle_span} [N], linear in brackets: {', '.join(pairs)}")
    if study.line.catenary.has_lateral_field:
        arm, force = len(droppers) + geometry.middle_span - 1, state.arm_force[geometry.middle_span - 1]
        print(f"Arm tension: {rest.bar_tension[arm]:.1f} ({np.hypot(*force):.1f}) N")


def simulate_models(study: ExactCase, models: list[str]) -> dict[str, dict[str, float]]:
    """Quantities of the passage in each model."""
    simulations = {
        "reference-free": partial(study.simulate_reference, "free"),
        "reference-fixed": partial(study.simulate_reference, "fixed"),
    }
    if any(model not in simulations for model in models):
        fixed = study.find_rest()
        print_rest(study, fixed)
        simulations["exact-free"] = partial(study.simulate_exactly, study.release(fixed))
        simulations["exact-fixed"] = partial(study.simulate_exactly, fixed)
    rows = {}
    for model in models:
        rows[model] = simulations[model]()
        print(f"{MODELS[model]}: {rows[model]}; {time.process_time():.0f} s", file=sys.stderr, flush=True)
    return rows


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--spans", type=int, default=20, help="spans of the line")
    options.add_argument("--element", type=float, default=0.25, help="distance of the mass points [m]")
    options.add_argument("--stagger", type=float, nargs="+", default=[0.0, 0.2], help="staggers of the line [m]")
    options.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS), help="models")
    chosen = options.parse_args()
    tables = []
    for stagger in chosen.stagger:
        study = build_exact_case(chosen.spans, chosen.element, stagger)
        first, last = study.section
        print(f"\nStagger {stagger:g} m, spans {first} to {last} of {chosen.spans}\n", flush=True)
        tables.append(simulate_models(study, chosen.models))
        print()
        print_rows({MODELS[model]: row for model, row in tables[-1].items()})
    if len(tables) > 1:
        print(f"\nChange by the stagger of {chosen.stagger[-1]:g} m [%]\n")
        print_rows({MODELS[model]: change_pct(tables[-1][model], row) for model, row in tables[0].items()})
    print(f"\nElements of {chosen.element:g} m; {time.process_time():.0f} s of process time.")


if __name__ == "__main__":
    main()
