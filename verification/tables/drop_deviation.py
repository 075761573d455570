"""Compare the recorded drop T1 with its simulation, and the deviation under another damping with theory.

    python -m verification.tables.drop_deviation FOLDER            # folder with the record T1.h5

First table: RMS ratios and correlations up to 20 Hz under the true damping, with the elements of the suite, and with
those of the simulator of the record, which have no residual flexibility under point forces. Second table: RMS of the
velocity under the initial damping over that of the record, group by group of modes, beside the prediction: every mode
decays with exp(-zeta omega t), so that the ratio of two models is exp(-(zeta_2 - zeta_1) omega t). `theory` weights
this factor with the modes that the release excites at the sensors, through the same filter.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.comparison.drop_comparison import DampingChoice, DropTask, compare_drop
from pantocheck.conformance.comparison.drop_motion import (
    GRAPHIC_BAND,
    DropMotion,
    MotionBand,
    filter_motion,
    simulate_models,
)
from pantocheck.conformance.comparison.drop_statistics import select_window
from pantocheck.conformance.comparison.recorded_drop import locate_drop
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.line.elements.damping import DampingFile
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import discretise
from pantocheck.model.description.catenary import GRAVITY
from pantocheck.model.fem import beams
from pantocheck.model.modal.modes import compute_modes, damping_ratios, deflection_at

Real = NDArray[np.float64]
RATE = 200.0
WINDOWS = ((0.0, 10.0), (60.0, 70.0))
ELEMENT, TIME_STEP = 0.75, 0.0005
GROUPS = 5
"""Groups of modes that are apart in frequency."""


def main() -> None:
    """Print both tables."""
    record = read_drop_records(Path(sys.argv[1]) / "T1.h5")[0]
    line = read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")
    initial = read_model(library_folder() / "vovan2015" / "damping" / "initial.toml", DampingFile, "damping")
    models = {"own": DampingChoice("line", line.damping), "initial": DampingChoice("initial.toml", initial.damping)}
    task = DropTask(line, models, WINDOWS, ELEMENT, TIME_STEP, 0.0)
    print_agreement("elements of the suite", record, task)
    with leave_out_residual_flexibility():
        print_agreement("elements of the record", record, task)
    print_groups(record, task)


@contextmanager
def leave_out_residual_flexibility() -> Iterator[None]:
    """Replace the residual flexibility of the elements by zero."""
    flexibility = beams.element_flexibility
    beams.element_flexibility = lambda length, *_: np.zeros((length.size, 7))
    try:
        yield
    finally:
        beams.element_flexibility = flexibility


def print_agreement(title: str, record: DropRecord, task: DropTask) -> None:
    """RMS ratio and correlation of the own damping at every sensor."""
    comparison = compare_drop(record, task)
    print(f"{title}: release at {comparison.drop.release_s:.4f} s")
    for row in comparison.statistics:
        own = row.models[0]
        if row.band_Hz == GRAPHIC_BAND and own.rms_ratio is not None and own.correlation is not None:
            start, end = row.window_s
            print(
                f"  {row.motion:<13}{start:3g} to {end:2g} s  {row.place}  ratio {own.rms_ratio:.4f}  "
                f"correlation {own.correlation:.4f}"
            )


def print_groups(record: DropRecord, task: DropTask) -> None:
    """Deviation under the initial damping in the late window, measured and predicted."""
    catenaries = task.build_models()
    drop = locate_drop(record, catenaries["own"])
    motion = simulate_models(drop, catenaries, task.settings)
    spans = task.line.geometry.spans
    line = discretise(catenaries["own"], ELEMENT, [position for _, position in drop.places])
    modes = compute_modes(line, spans * (GROUPS + 1))
    omega = 2 * np.pi * modes.frequency
    mass_wire, mass_place = drop.places[-1]
    excited = deflection_at(line, modes, line.mesh.row_of[mass_wire, "z"], mass_place) * drop.mass * GRAVITY / omega
    sensors = [
        excited * deflection_at(line, modes, line.mesh.row_of[wire, "z"], position)
        for wire, position in drop.places[:-1]
    ]
    ratios = {name: damping_ratios(discretise(catenary, ELEMENT), modes) for name, catenary in catenaries.items()}
    velocities = {name: superpose(sensors, omega, ratio) for name, ratio in ratios.items()}
    print(f"{'group':<7}{'zeta own':>10}{'initial':>10}{'exp(..)':>9}{'theory':>9}{'/ record':>10}{'/ own':>8}")
    middle = sum(WINDOWS[1]) / 2
    for group in range(GROUPS):
        inside = slice(group * spans, (group + 1) * spans)
        difference = (ratios["initial"] - ratios["own"])[inside]
        plain = np.exp(-np.median(difference * omega[inside]) * middle)
        band = find_band(modes.frequency, group, spans)
        theory = rms_of_theory(velocities["initial"], band) / rms_of_theory(velocities["own"], band)
        own, initial, measured = (rms_of_group(motion, name, band) for name in ("own", "initial", ""))
        medians = "".join(f"{100 * np.median(ratios[name][inside]):>9.3f}%" for name in ("own", "initial"))
        print(f"{group + 1:<7}{medians}{plain:>9.3f}{theory:>9.3f}{initial / measured:>10.3f}{initial / own:>8.3f}")


def superpose(sensors: list[Real], omega: Real, ratio: Real) -> Real:
    """Velocity of all sensors after the release, as the sum of all modes, (n, c)."""
    time = np.arange(0, WINDOWS[1][1] + 2, 1 / RATE)
    decays = np.exp(-np.outer(time, ratio * omega)) * np.sin(np.outer(time, omega))
    return np.column_stack([decays @ sensor for sensor in sensors])


def rms_of_theory(velocity: Real, band: MotionBand) -> float:
    """RMS of a superposed velocity in a band and the late window; the band leaks as in the measured values."""
    first, last = (round(RATE * limit) for limit in WINDOWS[1])
    return float(np.sqrt(np.mean(filter_motion(velocity, RATE, 0, band)[first:last] ** 2)))


def rms_of_group(motion: DropMotion, name: str, band: MotionBand) -> float:
    """RMS of the velocity of a model, or of the record, in a band and the late window, all sensors together."""
    filtered = motion.filter_model(name, "velocity", band)[:, :-1] if name else motion.filter_record("velocity", band)
    return float(np.sqrt(np.mean(filtered[select_window(motion, WINDOWS[1])] ** 2)))


def find_band(frequency: Real, group: int, spans: int) -> MotionBand:
    """Band of a group, from the middle of the gap below it to that above it."""
    first, last = group * spans, (group + 1) * spans - 1
    low = GRAPHIC_BAND.low if group == 0 else (frequency[first - 1] + frequency[first]) / 2
    return MotionBand(low, (frequency[last] + frequency[last + 1]) / 2)


if __name__ == "__main__":
    main()
