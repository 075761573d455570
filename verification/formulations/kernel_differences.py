"""Differences of all recorded quantities between the time steps of two installations, at fixed uplift forces.

    python -m verification.formulations.kernel_differences write FILE.npz   simulate with this Python
    python -m verification.formulations.kernel_differences compare OLD.npz NEW.npz

Write both files, each with its own installation, for example in two virtual environments. The simulations are all
passages and mass drops of the library, and lines of what these do not have: tension sections with overlaps, an
irregularity with point masses, two contact wires (an odd number of rows), modal damping and held stretches under a
train, and a coarse line with a long time step. The command fails if a quantity differs by more than 1e-8 of its largest
value, or is known at other times.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.drop_simulation import simulate_drop
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.tension_section import OverlapTable, SectionTable
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.model import Catenary, Kind, ModalBand, discretise, simulate_passage
from pantocheck.model.description.irregularity import Irregularity
from verification.formulations.library_passages import PASSAGES
from verification.speed.passage_lines import ac_simple, passage, staggered, vertical

UPLIFT_FORCE = 160.0
"""Constant uplift force of every pantograph [N]."""
DROPS = ("vovan2015/mass-drop/printed", "vovan2015/mass-drop/stand-in")
TOLERANCE = 1e-8
"""Largest difference as a share of the largest value: sweeps leave 1e-9 N of a few hundred newtons in every step."""
MOTION = ("displacement", "velocity", "acceleration")

Quantities = dict[str, np.ndarray]


def library_passage(name: str) -> Quantities:
    """A passage of the library."""
    case = next(case for case in select_cases([name]) if case.id == name)
    line = discretise(build_catenary(case.line), case.file.discretisation.element_m)
    way = build_passage(case, line, case.file.discretisation, (UPLIFT_FORCE,) * len(case.pantographs))
    history = simulate_passage(line, way)
    return {"force": history.force, "height": history.height, **moved(history.motion)}


def library_drop(name: str) -> Quantities:
    """The first drop of a case with mass drops."""
    case = next(case for case in select_cases([name]) if case.id == name)
    return moved(simulate_drop(case, 1).decay.motion)


def short_passage(catenary: Catenary, element: float = 0.5, step: float = 1e-3) -> Quantities:
    """Two pantographs over seven spans of a line like AC simple."""
    case = ac_simple(20)
    line = discretise(catenary, element)
    way = passage(case, line, step, 2, 55.0 * 8, np.inf)
    supports = [position for _, position in way.watched]
    watched = tuple((wire.name, x) for wire in catenary.contact_wires for x in supports if wire.start <= x <= wire.end)
    way = replace(way, kept_behind=82.5, watched=watched)
    history = simulate_passage(line, way)
    return {"force": history.force, "height": history.height, **moved(history.motion)}


def moved(motion: np.ndarray) -> Quantities:
    """Displacement, velocity and acceleration of recorded motion."""
    return {name: motion[..., i] for i, name in enumerate(MOTION)}


def overlapping_sections() -> Catenary:
    """Three tension sections of eight spans, overlaps of two spans."""
    case = ac_simple(20)
    update = {"section": (SectionTable(spans=8),) * 3, "overlap": OverlapTable(spans=2, anchor_rise_m=0.3)}
    return staggered(replace(case, line=case.line.shorten(20).model_copy(update=update)))


def rough_line() -> Catenary:
    """AC simple with an irregularity of its contact wire and heavy clamps at every second dropper."""
    catenary = staggered(ac_simple(20))
    x = np.arange(0.0, 20 * 55.0, 2.5)
    height = 1e-3 * np.random.default_rng(0).normal(size=x.size)
    wires = tuple(
        replace(wire, irregularity=Irregularity(tuple(x.tolist()), tuple(height.tolist())))
        if wire.kind is Kind.CONTACT_WIRE
        else wire
        for wire in catenary.wires
    )
    droppers = tuple(
        replace(dropper, lower_clamp_mass=0.8 if n % 2 else dropper.lower_clamp_mass)
        for n, dropper in enumerate(catenary.droppers)
    )
    return replace(catenary, wires=wires, droppers=droppers)


def two_contact_wires() -> Catenary:
    """AC simple in the vertical plane with a second contact wire beside the first: three rows."""
    case = ac_simple(20)
    catenary = vertical(case, discretise(staggered(case), 0.5).state)
    first = next(wire for wire in catenary.wires if wire.kind is Kind.CONTACT_WIRE)
    second = replace(first, name="second contact wire", tension=0.8 * first.tension)
    return replace(
        catenary,
        wires=(*catenary.wires, second),
        droppers=catenary.droppers + tuple(replace(d, lower=second.name) for d in catenary.droppers),
        steady_arms=catenary.steady_arms + tuple(replace(arm, wire=second.name) for arm in catenary.steady_arms),
    )


def held_line() -> Catenary:
    """AC simple with a messenger wire that is fixed along the track at every support."""
    catenary = staggered(ac_simple(20))
    wires = tuple(
        replace(wire, axial_stiffness=1e7) if wire.kind is Kind.MESSENGER_WIRE else wire for wire in catenary.wires
    )
    supports = tuple(replace(support, along_track="fixed") for support in catenary.messenger_supports)
    return replace(catenary, wires=wires, messenger_supports=supports)


def modal_line() -> Catenary:
    """AC simple with modal damping of all modes between 0.8 and 1.1 Hz."""
    return replace(staggered(ac_simple(14)), modal_damping=(ModalBand(0.8, 1.1, 0.02),))


LINES: dict[str, Callable[[], Quantities]] = {
    "three sections": lambda: short_passage(overlapping_sections()),
    "irregularity and masses": lambda: short_passage(rough_line()),
    "two contact wires": lambda: short_passage(two_contact_wires()),
    "held stretches": lambda: short_passage(held_line()),
    "modal damping": lambda: short_passage(modal_line()),
    "coarse": lambda: short_passage(staggered(ac_simple(20)), 2.2, 4e-3),
    "fine": lambda: short_passage(staggered(ac_simple(20)), 0.2, 2e-3),
}


def simulate_all() -> Iterator[tuple[str, Quantities]]:
    """Name and quantities of every simulation."""
    for name in PASSAGES:
        yield name, library_passage(name)
    for name in DROPS:
        yield name, library_drop(name)
    for name, simulate in LINES.items():
        yield name, simulate()


def compare(old: str, new: str) -> bool:
    """Print the largest difference of every quantity; true if none exceeds the tolerance."""
    agreed = True
    with np.load(old) as before, np.load(new) as after:
        alone = sorted(set(before.files) ^ set(after.files))
        agreed &= not alone
        print("| simulation | quantity | largest value | largest difference | share |\n| :-- | :-- | --: | --: | --: |")
        for key in (key for key in before.files if key not in alone):
            first, second = before[key], after[key]
            largest = float(np.nanmax(np.abs(first)))
            difference = float(np.nanmax(np.abs(first - second)))
            share = difference / largest
            agreed &= share <= TOLERANCE and bool((np.isnan(first) == np.isnan(second)).all())
            name, quantity = key.split(": ")
            print(f"| {name} | {quantity} | {largest:.4g} | {difference:.1e} | {share:.1e} |")
    for key in alone:
        print(f"in one file only: {key}")
    return agreed


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("write", "compare"))
    parser.add_argument("files", nargs="+")
    options = parser.parse_args()
    if options.action == "compare":
        sys.exit(not compare(*options.files))
    arrays: Quantities = {}
    for name, quantities in simulate_all():
        print(name, flush=True)
        arrays |= {f"{name}: {quantity}": values for quantity, values in quantities.items()}
    np.savez_compressed(options.files[0], **arrays)


if __name__ == "__main__":
    main()
