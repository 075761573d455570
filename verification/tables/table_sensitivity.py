"""Sensitivity of Table 1 of Vo Van, Balmes and Lorang (2015) to every assumption, also the initial damping and contact.

python -m verification.tables.table_sensitivity

Prints the table of docs/damping-study.md: one assumption at a time differs from the scenario of the case.
"""

import argparse
from collections.abc import Iterator
from typing import NamedTuple

from pantocheck.conformance.studies.vovan2015.damping_change import CHANGES, EARLIER_LEVEL
from verification.tables.table_scenarios import (
    CHOSEN,
    MEAN_FORCES,
    CaseChange,
    Scenario,
    change_contact,
    change_head,
    change_initial_damping,
    keep_case,
    run_initial,
    run_settled_changes,
)
from verification.tables.table_search import count_reproduced

SPEEDS_KM_H = (270.0, 285.0)
SPACINGS_M = (85.0, 105.0, 125.0, 150.0, 175.0, 195.0, 205.0, 215.0)
SPANS_M = (50.0, 63.0)
SHARES_OF_MEAN_FORCES = (0.9, 1.1)
OTHER = Scenario(50.0, "20/16", 1e-3, 285.0, "EN 50318:2018", 85.0)
"""Scenario that reproduces most findings. It was found by trials, so its findings would be imposed."""


CONTACT_STIFFNESSES_N_M = (20e3, 25e3, 100e3, 200e3)
"""Contact springs beside the 50 kN/m of the case: a convention of reference models."""
HEAD_SHARES = (0.75, 1.25)
PARTS = ("contact_wire", "messenger_wire", "stitch_wire", "droppers", "steady_arms")
INITIAL_PAIRS = {
    "no mass term": (0.0, 2.35e-4),
    "no stiffness term": (0.0116, 0.0),
    "benchmark": (0.0125, 1e-4),
    "stiffness times 3": (0.0116, 7e-4),
    "Massat, first": (0.0, 3.3e-3),
}
"""Other initial models with one pair of coefficients for all parts; two of them are published."""
INITIAL_PARTS: dict[str, dict[str, tuple[float, float]]] = {
    "droppers 1e-5 s, arms none": {"droppers": (0.0, 1e-5), "steady_arms": (0.0, 0.0)},
    "droppers 3e-3 s": {"droppers": (0.0, 3e-3)},
    "arms 1e-2 s": {"steady_arms": (0.0, 1e-2)},
    "contact wire 7e-4 s, messenger wire 1e-4 s": {"contact_wire": (0.0116, 7e-4), "messenger_wire": (0.0116, 1e-4)},
    "contact wire 1e-4 s, messenger wire 1e-3 s": {"contact_wire": (0.0116, 1e-4), "messenger_wire": (0.0116, 1e-3)},
}
"""Other initial models by the parts that differ from the case."""


class Variant(NamedTuple):
    """One assumption that differs from the case."""

    name: str
    scenario: Scenario = CHOSEN
    mean_forces: tuple[float, ...] = MEAN_FORCES
    """Mean contact forces [N]."""
    change: CaseChange = keep_case


def list_variants() -> Iterator[Variant]:
    """Every variant, the scenario of the case first."""
    yield Variant("case")
    for speed in SPEEDS_KM_H:
        yield Variant(f"{speed:g} km/h", CHOSEN._replace(speed_km_h=speed))
    for spacing in SPACINGS_M:
        yield Variant(f"{spacing:g} m apart", CHOSEN._replace(spacing_m=spacing))
    for span in SPANS_M:
        yield Variant(f"spans of {span:g} m", CHOSEN._replace(span_m=span))
    yield Variant("tensions of 22 and 16 kN", CHOSEN._replace(tensions="22/16"))
    yield Variant("no pre-sag", CHOSEN._replace(presag_share=0.0))
    for pantograph in ("DSA250", "DSA380"):
        yield Variant(pantograph, CHOSEN._replace(pantograph=pantograph))
    for share in SHARES_OF_MEAN_FORCES:
        yield Variant(f"mean forces times {share:g}", mean_forces=tuple(share * force for force in MEAN_FORCES))
    yield Variant("spans of 50 m, 285 km/h, 85 m apart", OTHER)
    for stiffness in CONTACT_STIFFNESSES_N_M:
        yield Variant(f"contact of {stiffness / 1e3:g} kN/m", change=change_contact(stiffness))
    for share in HEAD_SHARES:
        yield Variant(f"head mass times {share:g}", change=change_head(share))
    for name, pair in INITIAL_PAIRS.items():
        yield Variant(f"initial damping: {name}", change=change_initial_damping(**dict.fromkeys(PARTS, pair)))
    for name, parts in INITIAL_PARTS.items():
        yield Variant(f"initial damping: {name}", change=change_initial_damping(**parts))


def main() -> None:
    """Run the named variants, by default all, with both damping models and print the changes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="beginnings of the names of variants")
    names = tuple(parser.parse_args().names) or ("",)
    heads = [
        "variant",
        "front: changes [%]",
        "rear: changes [%]",
        "spread",
        "20-50 Hz [N]",
        "loss [%]",
        "uplift [mm]",
    ]
    print(f"| {' | '.join([*heads, 'findings'])} |\n|---|---|---|--:|---|{'--:|' * 3}")
    for variant in list_variants():
        if not variant.name.startswith(names):
            continue
        run = run_initial(variant.scenario, variant.mean_forces, variant.change)
        if run is None:
            print(f"| {variant.name} | no solution |{' |' * 6}", flush=True)
            continue
        changes = run_settled_changes(run, variant.change)
        cells = [", ".join(f"{changes.values[p][change]:+.1f}" for change in CHANGES.values()) for p in run.pantographs]
        spread = max(changes.spread[p][change] for p in run.pantographs for change in CHANGES.values())
        levels = ", ".join(f"{changes.values[p][EARLIER_LEVEL]:.1f}" for p in run.pantographs)
        count = count_reproduced(changes.values)
        facts = f"{spread:.1f} | {levels} | {run.contact_loss_pct:.1f} | {run.uplift_mm:.0f} | {count}"
        print(f"| {variant.name} | {' | '.join(cells)} | {facts} |", flush=True)


if __name__ == "__main__":
    main()
