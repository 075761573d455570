"""Differences of all recorded quantities between two cores or installations, at fixed uplift forces.

    python -m verification.formulations.kernel_differences cores            core in C and numba
    python -m verification.formulations.kernel_differences write FILE.npz   simulate with this Python
    python -m verification.formulations.kernel_differences compare OLD.npz NEW.npz

Write both files, each with its own installation, for example in two virtual environments. The simulations are all
passages and mass drops of the library, and lines of what these do not have: tension sections with overlaps, an
irregularity with point masses, two contact wires (an odd number of rows), modal damping and held stretches under a
train, a coarse line with a long time step, the other contact laws, heads with structure, and lost contact. The command
fails if a quantity differs by more than 1e-9 (cores) or 1e-8 (installations) of its largest value, or is known at other
times.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.drop_simulation import simulate_drop
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.tension_section import OverlapTable, SectionTable
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.model import Catenary, Kind, ModalBand, Pantograph, discretise, simulate_passage
from pantocheck.model.description.head_structure import (
    MountedStrip,
    Rotation,
    add_bending_mode,
    add_friction,
    add_roll,
    add_stop,
    mount_strips,
)
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.dynamics import core_choice
from verification.formulations.library_passages import PASSAGES
from verification.speed.passage_lines import ac_simple, passage, staggered, vertical

UPLIFT_FORCE = 160.0
"""Constant uplift force of every pantograph [N]."""
DROPS = ("vovan2015/mass-drop/printed", "vovan2015/mass-drop/stand-in")
TOLERANCE, TOLERANCE_OF_CORES = 1e-8, 1e-9
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


def short_passage(
    catenary: Catenary,
    element: float = 0.5,
    step: float = 1e-3,
    change: Callable[[Pantograph], Pantograph] | None = None,
) -> Quantities:
    """Two pantographs, changed by a function, over seven spans of a line like AC simple."""
    case = ac_simple(20)
    line = discretise(catenary, element)
    way = passage(case, line, step, 2, 55.0 * 8, np.inf)
    supports = [position for _, position in way.watched]
    watched = tuple((wire.name, x) for wire in catenary.contact_wires for x in supports if wire.start <= x <= wire.end)
    way = replace(way, kept_behind=82.5, watched=watched)
    if change is not None:
        way = replace(way, pantographs=tuple(map(change, way.pantographs)))
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


def build_head(pantograph: Pantograph) -> Pantograph:
    """Two strips, roll and a bending mode, friction and a stop in the suspension of the head."""
    strips = (MountedStrip(0.3, 3.0, 5000.0, 20.0), MountedStrip(-0.28, 3.0, 6000.0, 15.0))
    model = add_roll(mount_strips(pantograph, strips, Rotation(0.8, 40.0, 3.0)), Rotation(2.0, 300.0, 5.0))
    model = add_bending_mode(model, 31.0, 0.02, [(0.3, 0.0, -0.8), (0.3, 0.1)])
    suspension = np.eye(model.head.size)[1] - np.eye(model.head.size)[0]
    return add_stop(add_friction(model, suspension, 12.0, 2e-3), suspension, 0.01, 2e4, 30.0)


CHANGES: dict[str, Callable[[Pantograph], Pantograph]] = {
    "damped contact": lambda pantograph: replace(pantograph, contact_damping=60.0),
    "constraint": lambda pantograph: replace(pantograph, contact_stiffness=np.inf),
    "Hertz's law": lambda pantograph: replace(pantograph, contact_stiffness=np.inf, hertz_coefficient=1.2e7),
    "heads with structure": build_head,
    "lost contact": lambda pantograph: replace(pantograph, force=0.3 * pantograph.force),
}
"""Changes of the pantographs of a short passage."""

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
    for name, change in CHANGES.items():
        yield name, short_passage(staggered(ac_simple(20)), change=change)


def collect() -> Quantities:
    """Quantities of every simulation by its name."""
    return {f"{name}: {key}": values for name, found in simulate_all() for key, values in found.items()}


def compare(before: Mapping[str, np.ndarray], after: Mapping[str, np.ndarray], tolerance: float) -> bool:
    """Print the largest difference of every quantity; true if none exceeds the tolerance."""
    alone = sorted(set(before) ^ set(after))
    agreed = not alone
    print("| simulation | quantity | largest value | largest difference | share |\n| :-- | :-- | --: | --: | --: |")
    for key in (key for key in before if key not in alone):
        first, second = before[key], after[key]
        largest = float(np.nanmax(np.abs(first)))
        difference = float(np.nanmax(np.abs(first - second)))
        share = difference / largest
        agreed &= share <= tolerance and bool((np.isnan(first) == np.isnan(second)).all())
        name, quantity = key.split(": ")
        print(f"| {name} | {quantity} | {largest:.4g} | {difference:.1e} | {share:.1e} |")
    for key in alone:
        print(f"on one side only: {key}")
    return agreed


def compare_cores() -> bool:
    """Compare the core in C with that of numba."""
    found = []
    for core in ("numba", "c"):
        os.environ[core_choice.CORE_VARIABLE] = core
        print(core_choice.choose_core().name, flush=True)
        found.append(collect())
    return compare(*found, TOLERANCE_OF_CORES)


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("cores", "write", "compare"))
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    if options.action == "cores":
        sys.exit(not compare_cores())
    if options.action == "compare":
        with np.load(options.files[0]) as before, np.load(options.files[1]) as after:
            sys.exit(not compare(before, after, TOLERANCE))
    np.savez_compressed(options.files[0], **collect())


if __name__ == "__main__":
    main()
