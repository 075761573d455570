"""Worth of the choice of filter and band: changes of the quantities of a record; prints tables of docs/quantities.md.

python -m verification.tables.filter_and_band

The records are those of the EN 50318:2002 cases by the reference simulator. Each alternative is in use elsewhere: a
causal filter is that of a measuring instrument, and many programs filter a band instead of summing spectral lines.
"""

import argparse

import numpy as np
from scipy.signal import butter, sosfiltfilt

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.bands import BANDS, band_rms
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

CASES = ("en50318-2002/250", "en50318-2002/300")
FILTERS = {
    "causal, order 6": Filter(phase="causal"),
    "zero phase, order 12": Filter(order=12),
}
"""Filters in place of the zero-phase filter of order 6; order 12 is that of order 6, run forwards and backwards."""
BAND_PASS_ORDER = 6
"""Total order of the zero-phase band-pass at each edge, as of the low-pass."""


def load_signals(case: Case) -> PantographSignals:
    """Signals of the first pantograph of a case by the reference simulator."""
    record = ReferenceSimulator().run_unrefined(case).record
    assert record is not None
    return RecordSignals(record, case.file.filter).pantographs[1]


def filter_changes(signals: PantographSignals, low_pass: Filter) -> dict[str, float]:
    """Relative changes of standard deviation, largest and smallest force by another filter [%]."""
    other = low_pass(signals.force.delivered, signals.force.rate)[signals.inside]
    statistics = {"std_force_N": np.std, "max_force_N": np.max, "min_force_N": np.min}
    return {name: float(100 * (f(other) / f(signals.graded) - 1)) for name, f in statistics.items()}


def band_changes(signals: PantographSignals) -> dict[str, tuple[float, float]]:
    """Relative changes of each band [%]: by a band-pass, and by Parseval after the removal of the jump of the ends."""
    force, rate, inside = signals.force.delivered, signals.force.rate, signals.inside
    section = force[inside]
    level = section - np.linspace(0.0, section[-1] - section[0], section.size)
    changes = {}
    for low, high, name in BANDS:
        edges, kind = (high, "lowpass") if low == 0 else ((low, high), "bandpass")
        filtered = sosfiltfilt(butter(BAND_PASS_ORDER // 2, edges, kind, fs=rate, output="sos"), force)[inside]
        parseval = band_rms(section, rate, low, high)
        values = (float(filtered.std()), band_rms(level, rate, low, high))
        changes[name] = (100 * (values[0] / parseval - 1), 100 * (values[1] / parseval - 1))
    return changes


def main() -> None:
    """Print both tables."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    signals = {name: load_signals(load_case(library_folder() / f"{name}.toml")) for name in CASES}
    print("| case | filter | std_force_N | max_force_N | min_force_N |\n| :-- | :-- | --: | --: | --: |")
    for name, pantograph in signals.items():
        for label, low_pass in FILTERS.items():
            cells = " | ".join(f"{change:+.1f} %" for change in filter_changes(pantograph, low_pass).values())
            print(f"| {name} | {label} | {cells} |")
    print("\n| case | band | band-pass | without the jump of the ends |\n| :-- | :-- | --: | --: |")
    for name, pantograph in signals.items():
        for band, changes in band_changes(pantograph).items():
            print(f"| {name} | {band} | {' | '.join(f'{change:+.1f} %' for change in changes)} |")


if __name__ == "__main__":
    main()
