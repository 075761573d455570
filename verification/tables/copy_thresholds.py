"""Thresholds that show a copied record: likeness of independent passages, and of copies with small changes.

python -m verification.tables.copy_thresholds [--passages 30]

Line and train as in verification/tables/coverage_simulated.py, with 10 evaluated spans after a run-in of three: the
forces of two pantographs at 320 km/h over an irregularity. Each passage is compared with the next one, which has
another irregularity; with passages over the same irregularity that have another start, speed or mesh; and with copies
of itself. A noise is white, and its RMS up to 50 Hz is stated. The seed of passage p is (50320, p).
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.comparison.force_difference import (
    BAND_HZ,
    COPY_CORRELATION,
    REPEATED_CORRELATION,
    ForceLikeness,
    measure_likeness,
)
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.model import discretise, simulate_passage
from verification.speed.passage_lines import ac_simple, passage, staggered
from verification.tables.coverage_simulated import (
    BEFORE,
    ELEMENT_M,
    REACH_M,
    RESERVE,
    RUN_IN,
    STEP_S,
    add_irregularity,
    make_irregularity,
)

SEED, SPANS = 50320, 10
SPEEDS, LATER_M, NOISES_N = (1.001, 1.005), 25.0, (2.0, 5.0)
"""Factors of the speed; shift of the start [m]; noises of an independent record [N]."""
COPY_NOISES_N, GAIN, SHIFT_M, RESAMPLING = (0.5, 2.0, 5.0), 1.02, 2.0, 0.8
"""Changes of a copy: noises [N], factor of the force, shift of the positions [m], factor of the sampling rate."""

INDEPENDENT = "other irregularity", "same irregularity"
"""Kinds of independent pairs: a simulated and a measured run; two runs of one kind."""

Signals = tuple[PantographSignals, ...]


class Variant(NamedTuple):
    """Passage beside that of the case."""

    coarsening: float = 1.0
    """Factor of element length and time step."""
    faster: float = 1.0
    """Factor of the speed."""
    later_m: float = 0.0
    """Shift of the start [m]."""


VARIANTS = {
    "other start": Variant(later_m=LATER_M),
    **{f"{100 * (factor - 1):.1f} % faster": Variant(faster=factor) for factor in SPEEDS},
    "mesh of twice the size": Variant(coarsening=2.0),
}


def run_variant(variant: Variant, passages: int) -> list[Signals]:
    """Signals of both pantographs in each passage of a variant."""
    last = BEFORE + RUN_IN["short"] + SPANS
    case = ac_simple(last + RESERVE, stagger=0.0)
    supports = np.array(case.line.geometry.supports)
    line, step = discretise(staggered(case), variant.coarsening * ELEMENT_M), variant.coarsening * STEP_S
    way = passage(case, line, step, 2, supports[last + 1], REACH_M)
    start = tuple(place + variant.later_m for place in way.start)
    duration = (way.duration - variant.later_m / way.speed) / variant.faster
    way = replace(way, start=start, speed=variant.faster * way.speed, duration=duration, watched=())
    section = (float(supports[last - SPANS]), float(supports[last]))
    found = []
    for number in range(passages):
        history = simulate_passage(add_irregularity(line, make_irregularity((SEED, number), supports, 0.0)), way)
        rows = zip(history.position, history.force, strict=True)
        found.append(tuple(PantographSignals(x, ForceChannel(f, 1 / step, Filter()), section) for x, f in rows))
    return found


def change_force(signals: PantographSignals, noise_N: float, gain: float, seed: tuple[int, ...]) -> PantographSignals:
    """Signals with another force: scaled, and with white noise of an RMS up to 50 Hz."""
    force = signals.force
    noise = np.random.default_rng(seed).standard_normal(force.delivered.size) * np.sqrt(force.rate / (2 * BAND_HZ[1]))
    return replace(signals, force=replace(force, delivered=gain * force.delivered + noise_N * noise))


def resample(signals: PantographSignals) -> PantographSignals:
    """Signals at a lower rate, by straight lines between the samples."""
    size, force = signals.position.size, signals.force
    places = np.arange(0, size - 1, 1 / RESAMPLING)
    position, delivered = (np.interp(places, np.arange(size), x) for x in (signals.position, force.delivered))
    return replace(signals, position=position, force=replace(force, delivered=delivered, rate=RESAMPLING * force.rate))


def make_copies(signals: PantographSignals, seed: tuple[int, ...]) -> Iterator[tuple[str, PantographSignals]]:
    """Copies of signals by their change."""
    moved = replace(signals, position=signals.position + SHIFT_M)
    for noise in COPY_NOISES_N:
        yield f"noise of {noise:g} N", change_force(signals, noise, 1.0, seed)
    yield f"{100 * (GAIN - 1):.0f} % more force", change_force(signals, 0.0, GAIN, seed)
    yield f"{SHIFT_M:g} m shifted", moved
    yield f"resampled at {RESAMPLING:g} of the rate", resample(signals)
    yield f"all of them, noise of {COPY_NOISES_N[0]:g} N", resample(change_force(moved, COPY_NOISES_N[0], GAIN, seed))


def compare_passages(passages: int) -> Iterator[tuple[str, str, ForceLikeness]]:
    """Likeness of all pairs, with the kind of the pair and the change."""
    base, others = run_variant(Variant(), passages), {k: run_variant(v, passages) for k, v in VARIANTS.items()}
    for p, i in ((p, i) for p in range(passages) for i in range(2)):
        first, seed = base[p][i], (SEED, p, i)
        pairs = [(INDEPENDENT[0], "another passage", base[(p + 1) % passages][i])]
        pairs += [
            (INDEPENDENT[1], f"{name}, noise of {noise:g} N", change_force(runs[p][i], noise, 1.0, seed))
            for name, runs in others.items()
            for noise in NOISES_N
        ]
        pairs += [("copy", name, signals) for name, signals in make_copies(first, seed)]
        for kind, name, second in pairs:
            likeness = measure_likeness(i + 1, first, second)
            if likeness is not None:
                yield kind, name, likeness


def main() -> None:
    """Print the likeness of all kinds of pairs, and how many are called a copy."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--passages", type=int, default=30, help="passages of two pantographs; default: %(default)s")
    found: dict[tuple[str, str], list[ForceLikeness]] = {}
    for kind, name, likeness in compare_passages(parser.parse_args().passages):
        found.setdefault((kind, name), []).append(likeness)
    limits = f"copies by {COPY_CORRELATION:g}", f"copies by {REPEATED_CORRELATION:g}"
    print(f"| pair | second record | pairs | correlation, 20-50 Hz | residual [N] | {' | '.join(limits)} |")
    print("|---|---|--:|--:|--:|--:|--:|")
    for (kind, name), rows in found.items():
        correlation, residual = (np.array([getattr(row, key) for row in rows]) for key in ("correlation", "residual_N"))
        copies = (str(sum(row.exceeds(limit) for row in rows)) for limit in (COPY_CORRELATION, REPEATED_CORRELATION))
        print(
            f"| {kind} | {name} | {len(rows)} | {correlation.min():.5f} to {correlation.max():.5f} "
            f"| {residual.min():.2f} to {residual.max():.2f} | {' | '.join(copies)} |"
        )


if __name__ == "__main__":
    main()
