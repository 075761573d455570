"""Detection limit of a dropper that is too long: its disturbance of force and height beside the scatter of the spans.

python -m verification.tables.dropper_limit

The disturbance is the difference of two passages over the same rough line, with and without one dropper that is 12 mm
too long, which carries nothing. The scatter is the difference of each span of a line without a defect from its
neighbours, as `runs assess` takes it. The best linear filter for a known disturbance s in stationary noise with the
two-sided spectrum N reaches the ratio d^2 = integral |S(f)|^2 / N(f) df in standard deviations (matched filter).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy

from pantocheck.conformance.cases.catalogue import LIBRARY
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.network.span_comparison import GRID_M, subtract_neighbours
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from verification.tables.network_detection import CASE, DENSITIES_M3, DROPPERS, SPAN_M

FIRST, BEHIND = 10, 5
STEP_M, CUTOFF_HZ = 0.05, 20.0
LINES = ((275.0, 0.003, 1.0), (275.0, 0.003, 0.1), (275.0, 0.001, 1.0), (275.0, 0.001, 0.1), (160.0, 0.003, 1.0))
"""Speed [km/h], scatter of the droppers [m] and share of the roughness."""


class Passage(NamedTuple):
    """Filtered force [N] and height of the contact point [m] on the grid."""

    force: RealArray
    height: RealArray


def pass_line(speed_km_h: float, scatter_m: float, share: float, spans: int, dropper: int | None = None) -> Passage:
    """Passage over a rough line, of which one dropper may be 12 mm too long."""
    count = FIRST + spans + BEHIND
    lengths = np.random.default_rng(spans).uniform(-scatter_m, scatter_m, (count, DROPPERS))
    if dropper is not None:
        lengths[FIRST + 2, dropper] += 0.012
    density = [share * value for value in DENSITIES_M3]
    changes = [
        f"line.geometry.spans={count}",
        f"evaluated_spans=[{FIRST}, {FIRST + spans - 1}]",
        f"compared_spans=[{FIRST - 2}, {FIRST + spans - 1}]",
        f"speed_km_h={speed_km_h}",
        f"line.contact_wire.irregularity={{frequency_1_m=[0.02, 0.1, 0.5], density_m3={density}, seed=77}}",
        f"line.variation.droppers.length_change_m={np.round(lengths, 5).tolist()}",
    ]
    record = ReferenceSimulator().run_unrefined(load_entry(LIBRARY.find_id(CASE), parse_changes(changes))).record
    assert record is not None
    x = (FIRST - 1) * SPAN_M + np.arange(0, spans * SPAN_M, STEP_M)
    cutoff = CUTOFF_HZ / (0.5 * speed_km_h / 3.6 / STEP_M)
    low_pass = scipy.signal.butter(6, cutoff, output="sos")
    force, height = (np.interp(x, record.position[0], y[0]) for y in (record.force, record.contact_height))
    every = round(GRID_M / STEP_M)
    return Passage(scipy.signal.sosfiltfilt(low_pass, force)[::every], height[::every])


def measure_ratio(disturbance: RealArray, scatter: RealArray, highest_1_m: float) -> float:
    """Ratio of the best filter for a disturbance [standard deviations], up to a wave number [1/m]."""
    waves, noise = scipy.signal.welch(scatter, fs=1 / GRID_M, nperseg=256)
    spectrum = GRID_M * np.fft.rfft(disturbance, 4096)
    own = np.fft.rfftfreq(4096, GRID_M)
    density = np.interp(own, waves, noise) / 2
    used = (own < highest_1_m) & (density > 1e-3 * density.max())
    return float(np.sqrt(2 * np.sum(np.abs(spectrum[used]) ** 2 / density[used]) * own[1]))


def list_rows() -> Iterator[str]:
    """Rows of the table, one for each line."""
    spans = SPAN_M * np.column_stack([np.arange(30), np.arange(1, 31)])
    for speed, scatter, share in LINES:
        clean, base = pass_line(speed, scatter, share, 30), pass_line(speed, scatter, share, 6)
        defects = [pass_line(speed, scatter, share, 6, dropper) for dropper in (1, 4, 6)]
        cells = [f"{speed:g}", f"{1e3 * scatter:g}", f"{share:g}"]
        for index, factor in ((0, 1.0), (1, 1e3)):
            rest = subtract_neighbours(clean[index], spans)
            rest = rest[np.isfinite(rest)]
            signals = [defect[index] - base[index] for defect in defects]
            ratios = [measure_ratio(signal, rest, CUTOFF_HZ * 3.6 / speed) for signal in signals]
            peaks = [factor * np.abs(signal).max() for signal in signals]
            cells += [f"{factor * rest.std():.1f}", f"{min(peaks):.1f} to {max(peaks):.1f}"]
            cells += [f"{min(ratios):.1f} to {max(ratios):.1f}"]
        yield f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    scatter = "scatter of the droppers [mm] | roughness"
    force = "spans differ [N] | a slack dropper adds [N] | best filter [standard deviations]"
    print(f"| km/h | {scatter} | {force} | height: spans differ [mm] | adds [mm] | best filter |")
    print("| --: | --: | --: | --: | --: | --: | --: | --: | --: |")
    for row in list_rows():
        print(row, flush=True)
