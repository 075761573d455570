"""Share of the 95 % intervals of a damping fit that contain the true coefficients, on a line of equal spans.

python -m verification.tables.fit_coverage [--seeds 6] [--spans 6]

Two mass drops on the line of Vo Van et al. (2015) are simulated once, without noise, at all places of sensors. Every
fit takes the sensors of one set of places, with other noise. Spans of equal length have modes within a few thousandths
of a hertz, which a few sensors do not separate.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pantocheck.conformance import FittedDamping, OpenedCase, OpenedDrop, identify_line, open_case
from verification.tables.interval_share import SHARE_COLUMNS, IntervalShare, print_table

NOISE_RMS = 0.003  # [m/s2], as in the cases of mass drops
HIGHEST_HZ = 4.0  # first four groups of modes
SENSORS = (
    ("contact_wire", 153.0),
    ("messenger_wire", 216.0),
    ("contact_wire", 94.5),
    ("messenger_wire", 36.0),
    ("contact_wire", 279.0),
    ("messenger_wire", 315.0),
)
PLACES = ((0, 1), (0, 3), (2, 1), (4, 5), (0, 1, 2, 3), (0, 1, 4, 5), (0, 1, 2, 3, 4, 5))
"""Sensors of each set of places."""


def main() -> None:
    """Print a line per fit, and the share of the intervals that contain the truth."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=6, help="number of fits per set of places")
    parser.add_argument("--spans", type=int, default=6)
    options = parser.parse_args()
    case = build_drops(options.spans)
    drops = [case.simulate_drop(number) for number in (1, 2)]
    found: list[tuple[float, float, float]] = []
    for place, sensors in enumerate(PLACES):
        for seed in range(options.seeds):
            noisy = [add_noise(drop, sensors, (seed, place, number)) for number, drop in enumerate(drops)]
            fit = identify_line(*noisy, highest_Hz=HIGHEST_HZ).fit_damping(case, element_m=0.75)
            rows = list(compare_with_truth(case, fit))
            found += rows
            print(f"{len(sensors)} sensors, seed {seed}:", ", ".join(describe_row(*row) for row in rows), flush=True)
    width = np.median([(high - low) / 2 for low, _, high in found])
    needed = np.quantile([abs(value) / (high - low) * 2 for low, value, high in found], 0.95)
    share = IntervalShare(len(found), sum(low <= 0 <= high for low, _, high in found), 1 / float(needed))
    print_table(
        [SHARE_COLUMNS, "median half-width [%]", "outcome"], [[share.text, f"{100 * width:.1f}", share.outcome]]
    )


def build_drops(spans: int) -> OpenedCase:
    """Two drops on equal spans, at all sensors, without noise."""
    return open_case("vovan2015/mass-drop/printed").with_(
        {
            "line.geometry.spans": spans,
            "mass_drop.noise_rms": 0.0,
            "mass_drop.drop": [
                {"mass_kg": 40.0, "wire": "contact_wire", "x_m": 152.25},
                {"mass_kg": 30.0, "wire": "messenger_wire", "x_m": 87.75},
            ],
            "mass_drop.sensor": [{"wire": wire, "x_m": x} for wire, x in SENSORS],
        }
    )


def add_noise(drop: OpenedDrop, sensors: tuple[int, ...], seed: tuple[int, ...]) -> OpenedDrop:
    """Record of some sensors with noise."""
    record = drop.record
    signals = record.signals[:, list(sensors)]
    noise = NOISE_RMS * np.random.default_rng(seed).standard_normal(signals.shape)
    channels = tuple(record.channels[number] for number in sensors)
    return OpenedDrop(replace(record, signals=signals + noise, channels=channels))


def compare_with_truth(case: OpenedCase, fit: FittedDamping) -> Iterator[tuple[float, float, float]]:
    """Lower end, value and upper end of each coefficient, over its true value, minus one."""
    truth = case.inputs["line"]["damping"]
    for row in fit.results.coefficients:
        true = truth[row.kind][f"{row.matrix}_coefficient_{'1_s' if row.matrix == 'mass' else 's'}"]
        yield row.low_95 / true - 1, row.value / true - 1, row.high_95 / true - 1


def describe_row(low: float, value: float, high: float) -> str:
    """Error of a coefficient with its interval; an interval without the truth is marked."""
    return f"{value:+.1%} ({low:+.1%} to {high:+.1%}){'' if low <= 0 <= high else ' MISSED'}"


if __name__ == "__main__":
    main()
