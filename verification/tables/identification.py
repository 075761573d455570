"""Score the identification on records with known modes, and for comparison the SSI of pyOMA-2 if it is installed.

    python -m verification.tables.identification FOLDER            # folder with records and truth.json
    python -m verification.tables.identification --made-up 20      # random records from the generator of the tests

A mode is observable if truth.json says so, or if its Cramer-Rao bound on damping is below 0.5 %. Results per method:
modes within the tolerances (2 mHz; damping 5 %, from group 4 on 10 %), largest and 90th percentile of the damping
error.
"""

import argparse
import importlib.util
import json
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identify import Identification, identify_modes
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.projection import whiten
from pantocheck.conformance.results.identified_modes import MeasuredLine
from verification.guide.peers.subspace_modes import identify_by_subspace

Real = NDArray[np.float64]
SSI_ORDER = 160  # largest model order of pyOMA-2, 2.5 times the number of modes


def main() -> None:
    """Print one line per record and method."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", help="folder with records and truth.json")
    parser.add_argument("--made-up", type=int, default=0, help="number of random records")
    parser.add_argument("--no-peers", action="store_true", help="leave pyOMA-2 out")
    options = parser.parse_args()
    peers = not options.no_peers and importlib.util.find_spec("pyoma2") is not None
    print("| record | method | modes found | inside | 90 % [%] | worst [%] | x bound | time [s] |")
    print(f"|---|---|{'--:|' * 6}")
    if options.folder:
        tests = json.loads((options.folder / "truth.json").read_text())["tests"]
        for path in sorted(p for p in options.folder.iterdir() if p.suffix in (".h5", ".csv", ".uff")):
            modes = [mode for mode in tests[path.stem]["vertical_modes"] if mode["observable"]]
            records = read_drop_records(path)
            bound = np.array([mode["crlb_zeta_rel"] for mode in modes]) / np.sqrt(len(records))
            truth = np.array([(mode["f_record_hz"], mode["zeta"], mode["group"]) for mode in modes])
            score(path.stem, records, truth, bound, peers)
    for seed in range(options.made_up):
        made_up(seed, peers)


def made_up(seed: int, peers: bool) -> None:
    """Score one random record."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
    from helpers.synthetic_drops import drop, span_modes

    random = np.random.default_rng(1000 + seed)
    poles = span_modes(random, int(random.integers(40, 80)), pairs=int(random.integers(0, 8)))
    duration, noise = float(random.choice([100.0, 130.0, 180.0, 240.0])), float(10 ** random.uniform(-3, -2))
    made = drop(random, poles, duration=duration, noise=noise, nonlinear=float(random.uniform(0, 2.0)))
    channels = tuple(DropChannel(f"S{i}_z", i, "z", "CW", 20.0 * i) for i in range(made.samples.shape[1]))
    name = f"made up {seed}"
    record = DropRecord(
        name,
        name,
        made.rate,
        made.samples,
        channels,
        drop=DropDescription(20, "CW", 0.0, 5.0),
        line=MeasuredLine(spans_m=(60.0,) * 6),
    )
    (found,) = identify_modes((record,))
    # The bound includes the modes in the fitted band that are not reported, or their leakage would count as signal.
    poles = poles[poles.imag < 2 * np.pi * found.fit.band.fitted]
    bound = bounds(found, poles)
    seen = (bound < 0.005) & (poles.imag < 2 * np.pi * 9.9)
    truth = np.column_stack([made.frequency, made.damping_ratio, np.ones(made.poles.size)])[: poles.size][seen]
    score(name, (record,), truth, bound[seen], peers)


def bounds(found: Identification, poles: NDArray[np.complex128]) -> Real:
    """Cramer-Rao bounds on the damping ratios, relative, with the noise of an identification, (m,)."""
    white = whiten([block.data for block in found.fit.blocks], [block.noise for block in found.fit.blocks])
    covariance = refine_poles(poles, white, iterations=0).covariance
    return np.asarray(np.sqrt(np.diag(covariance)[: poles.size]) / -poles.real)


def score(name: str, records: tuple[DropRecord, ...], truth: Real, bound: Real, peers: bool) -> None:
    """Print the lines of one record; truth (m, 3): frequency [Hz], damping ratio, group."""
    begin = time.perf_counter()
    (found,) = identify_modes(records)
    ours = np.array([(mode.frequency_Hz, mode.damping_ratio) for mode in found.modes])
    line(name, "pantocheck", ours, truth, bound, time.perf_counter() - begin)
    if peers:
        begin = time.perf_counter()
        theirs = identify_by_subspace(found, SSI_ORDER)
        theirs = theirs[np.isfinite(theirs[:, 0])]
        line(name, "pyOMA-2", theirs, truth, bound, time.perf_counter() - begin)


def line(name: str, method: str, found: Real, truth: Real, bound: Real, seconds: float) -> None:
    """Print one line; found (n, 2): frequency [Hz], damping ratio."""
    distance = np.abs(truth[:, :1] - found[None, :, 0])
    likeness = np.abs(np.log(truth[:, 1:2] / found[None, :, 1]))
    rows, columns = linear_sum_assignment(np.minimum(distance, 0.05) / 0.002 + np.minimum(likeness, 3.0))
    error = np.full(len(truth), np.inf)
    inside = 0
    for i, j in zip(rows, columns, strict=True):
        error[i] = abs(found[j, 1] / truth[i, 1] - 1)
        inside += bool(distance[i, j] < 0.002 and error[i] < (0.05 if truth[i, 2] < 4 else 0.10))
    ninety, worst = np.percentile(error, 90), error.max()
    times = np.percentile(error / bound, 90) / 1.645  # 1 for an unbiased method that reaches the bound
    print(
        f"| {name} | {method} | {len(found)} | {inside}/{len(truth)} | {100 * ninety:.3f} | {100 * worst:.3f} "
        f"| {times:.2f} | {seconds:.1f} |",
        flush=True,
    )


if __name__ == "__main__":
    main()
