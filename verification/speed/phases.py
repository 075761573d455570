"""Time of the phases of a time step on AC simple at 320 km/h with two pantographs; prints a table of docs/speed.md.

python -m verification.speed.phases

The passage of `speed.py` over 14 of 20 spans is simulated by a copy of the time step that reads the clock of the
processor between the phases. The table holds the mean over all steps of the median of five simulations: other work on
the machine that interrupts one of them does not count.
"""

import argparse
import os
import time
from dataclasses import replace
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from pantocheck.model import DiscretisedLine, Passage, discretise, simulate_passage
from pantocheck.model.dynamics.active_window import active_window, build_window_arrays
from pantocheck.model.dynamics.connector_step import accelerate_connectors, load_connectors, predict_connectors
from pantocheck.model.dynamics.contact_step import accelerate_contacts, correct_train, load_contacts, predict_train
from pantocheck.model.dynamics.distributed_step import accelerate_distributed, load_distributed, predict_distributed
from pantocheck.model.dynamics.kernel_arrays import KernelArrays, Workspace, build_kernel_arrays, build_workspace
from pantocheck.model.dynamics.kernel_compilation import kernel as compiled
from pantocheck.model.dynamics.motion import Motion, hold_left_stations
from pantocheck.model.dynamics.newmark import settle_forces
from pantocheck.model.dynamics.panels import solve_wires
from pantocheck.model.dynamics.simulation import start_motion
from pantocheck.model.dynamics.train import Train
from pantocheck.model.dynamics.wire_step import add_lumped_forces, predict_wires
from verification.speed.passage_lines import ac_simple, passage, staggered, vertical
from verification.speed.speed import ELEMENT, KEPT_BEHIND, STEP, WHOLE_RUN

PHASES = ("window", "predictor, wire forces", "connectors", "contacts", "sweeps", "elimination")
SIMULATIONS = 5


@intrinsic
def read_clock(typing: Any) -> Any:
    """Read the clock of the processor [ticks]."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        function = builder.module.declare_intrinsic("llvm.readcyclecounter", fnty=ir.FunctionType(ir.IntType(64), []))
        return builder.call(function, [])

    return types.int64(), generate


@compiled
def simulate(
    kernel: KernelArrays, motion: Motion, train: Train, work: Workspace, ticks: np.ndarray, force: np.ndarray
) -> None:
    """Advance by one step per row of `ticks`, (T, 6), as `newmark.step`, and fill it and the contact forces, (T, P)."""
    dt = kernel.time_step
    for n in range(ticks.shape[0]):
        clock_0 = read_clock()
        window = active_window(kernel.window, train)
        hold_left_stations(dt, motion, window)
        clock_1 = read_clock()
        predict_wires(dt, kernel.wires, motion, window)
        add_lumped_forces(kernel.wires, motion, window)
        clock_2 = read_clock()
        predict_connectors(kernel.connectors, kernel.forces, motion, work.scalar, window)
        predict_distributed(kernel.distributed, kernel.forces, motion, work.scalar)
        clock_3 = read_clock()
        predict_train(kernel.contact, motion, train, work.contact)
        clock_4 = read_clock()
        accelerate_connectors(kernel.connectors, motion, work.node, work.scalar, window)
        accelerate_distributed(kernel.distributed, motion, work.scalar)
        clock_5 = read_clock()
        accelerate_contacts(kernel.contact, kernel.connectors, kernel.distributed, motion, work.contact, window)
        clock_6 = read_clock()
        settle_forces(kernel, motion, train, work, window)
        clock_7 = read_clock()
        load_connectors(kernel.connectors, motion, work.scalar, window)
        load_distributed(kernel.distributed, motion, work.scalar)
        clock_8 = read_clock()
        load_contacts(kernel.contact, motion, train, work.contact)
        correct_train(dt, train)
        clock_9 = read_clock()
        solve_wires(kernel.panels, kernel.wires.extents, window, motion.w, motion.r, work.panels)
        clock_10 = read_clock()
        ticks[n, 0] = clock_1 - clock_0
        ticks[n, 1] = clock_2 - clock_1
        ticks[n, 2] = (clock_3 - clock_2) + (clock_5 - clock_4) + (clock_8 - clock_7)
        ticks[n, 3] = (clock_4 - clock_3) + (clock_6 - clock_5) + (clock_9 - clock_8)
        ticks[n, 4] = clock_7 - clock_6
        ticks[n, 5] = clock_10 - clock_9
        for p in range(train.position.size):
            force[n, p] = 0.0
            for wire in range(train.contact.shape[1]):
                force[n, p] += train.contact[p, wire]


def ticks_per_microsecond() -> float:
    """Rate of the clock of the processor."""
    begin, first = time.perf_counter(), _read()
    time.sleep(0.5)
    return float((_read() - first) / (time.perf_counter() - begin) / 1e6)


@compiled
def _read() -> int:
    return int(read_clock())


def measure_phases(line: DiscretisedLine, way: Passage) -> np.ndarray:
    """Mean time of each phase [us]."""
    steps, kernel = (
        round(way.duration / way.time_step),
        build_kernel_arrays(line, way.time_step, build_window_arrays(line, way)),
    )
    ticks, force = np.zeros((SIMULATIONS, steps, len(PHASES))), np.zeros((steps, len(way.pantographs)))
    _read()
    for simulation in ticks:
        motion, train = start_motion(line, kernel, way)
        simulate(kernel, motion, train, build_workspace(kernel, train), simulation, force)
    if not np.array_equal(force.T, simulate_passage(line, way).force):
        raise SystemExit("the time step of this file is not that of the simulation")
    return np.median(ticks, axis=0).mean(axis=0) / ticks_per_microsecond()


def main() -> None:
    """Measure and print."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    case, columns = ac_simple(20), []
    built = staggered(case)
    for catenary in (vertical(case, discretise(built, ELEMENT).state), built):
        line = discretise(catenary, ELEMENT)
        way = passage(case, line, STEP, 2, 55.0 * (1 + WHOLE_RUN), np.inf)
        columns.append(measure_phases(line, replace(way, kept_behind=KEPT_BEHIND)))
    print("| phase [us per step] | vertical | with stagger |\n| :-- | --: | --: |")
    for name, *values in zip(PHASES, *columns, strict=True):
        print(f"| {name} | {values[0]:.1f} | {values[1]:.1f} |")
    print(f"| step | {columns[0].sum():.1f} | {columns[1].sum():.1f} |")


if __name__ == "__main__":
    main()
