"""pyOMA-2: modes from a synthetic mass drop with known poles, by covariance-driven subspace identification."""

import io
import logging
import warnings
from collections.abc import Iterator
from contextlib import redirect_stderr
from typing import Any

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identify import Identification, identify_modes
from pantocheck.conformance.results.identified_modes import MeasuredLine
from verification.guide.comparisons import compare_relative
from verification.guide.guide_format import CheckedValue

KNOWN_MODES = {0.95: 0.012, 1.05: 0.011, 1.2: 0.010, 2.1: 0.008, 2.4: 0.007, 3.3: 0.007}
"""Frequencies [Hz] and damping ratios of the synthetic record, as those of the first span modes of a line."""

DROP_RATE, DROP_DURATION, RELEASE_S, NOISE = 200.0, 130.0, 5.0, 0.003
"""Sampling rate [Hz], duration [s], time of the release [s] and noise of the record [m/s2]."""

SSI_ROWS, SSI_ORDER, SSI_RATE = 60, 40, 25.0
"""Block rows, largest model order, and rate of the record given to pyOMA-2 [Hz]."""


def compare_identified_modes() -> list[CheckedValue]:
    """Frequencies and damping ratios of the suite and of pyOMA-2 beside the known ones."""
    record = build_known_drop()
    (found,) = identify_modes((record,))
    ours = np.array([(mode.frequency_Hz, mode.damping_ratio) for mode in found.modes])
    return [
        *_list_rows("suite", ours, (1e-5, 1e-3), "Twice the measured deviations: noise of 0.003 m/s2 over 125 s."),
        *_list_rows(
            "pyOMA-2",
            identify_by_subspace(found),
            (2e-5, 5e-3),
            "Four times the measured deviations, which depend on order and block rows.",
        ),
    ]


def _list_rows(program: str, modes: RealArray, limits: tuple[float, float], reason: str) -> Iterator[CheckedValue]:
    """Frequency and damping ratio of each known mode by a program, with their relative tolerances."""
    for number, (frequency, damping) in enumerate(KNOWN_MODES.items(), 1):
        near = modes[np.argmin(np.abs(modes[:, 0] - frequency))]
        for name, unit, computed, expected, limit in (
            ("frequency", "Hz", near[0], frequency, limits[0]),
            ("damping ratio", "-", near[1], damping, limits[1]),
        ):
            key, words = f"{program}-{name.split()[0]}-{number}", f"{program}: {name} of mode {number}"
            yield compare_relative(key, words, unit, (computed, expected), limit, reason)


def build_known_drop() -> DropRecord:
    """Mass-drop record of four sensors: rest, release, decay of the known modes, noise of a fixed seed."""
    random = np.random.default_rng(5)
    frequency, damping = np.array(list(KNOWN_MODES)), np.array(list(KNOWN_MODES.values()))
    omega = 2 * np.pi * frequency
    poles = -damping * omega + 1j * omega * np.sqrt(1 - damping**2)
    residues = random.uniform(0.2, 0.6, (poles.size, 4)) * random.choice([-1.0, 1.0], (poles.size, 4))
    time = np.arange(round(DROP_DURATION * DROP_RATE)) / DROP_RATE - RELEASE_S
    samples = NOISE * random.standard_normal((time.size, 4))
    after = time >= 0
    samples[after] += (2 * np.exp(np.outer(time[after], poles)) @ residues).real
    channels = tuple(DropChannel(f"S{i}_z", i, "z", "CW", 20.0 * i) for i in range(4))
    drop = DropDescription(20, "CW", 0.0, RELEASE_S)
    return DropRecord("known", "known", DROP_RATE, samples, channels, drop=drop, line=MeasuredLine(spans_m=(60.0,) * 6))


def identify_by_subspace(found: Identification, order: int = SSI_ORDER) -> RealArray:
    """Modes of pyOMA-2 on the same linear decay: stable poles of the largest order, frequency [Hz] and damping ratio.

    Stable poles also appear five orders below, within 0.5 % in frequency and 10 % in damping.
    """
    from pyoma2.algorithms import SSI
    from pyoma2.setup import SingleSetup

    decay = max((record.decay.linear for record in found.fit.records), key=lambda decay: decay.duration)
    step = max(1, round(1 / (decay.dt * SSI_RATE)))
    setup = SingleSetup(decay.samples[::step], fs=1 / (decay.dt * step))
    algorithm = SSI(name="ssi", br=SSI_ROWS, ordmax=order, method="cov", calc_unc=False)
    setup.add_algorithms(algorithm)
    logging.getLogger("pyoma2").setLevel(logging.WARNING)
    with warnings.catch_warnings(), redirect_stderr(io.StringIO()):  # progress bars
        warnings.simplefilter("ignore")
        setup.run_by_name("ssi")
    last, before = (_poles_of_order(algorithm.result, order) for order in (-1, -6))
    stable = [
        pole
        for pole in last
        if len(before) and np.any((abs(before[:, 0] / pole[0] - 1) < 0.005) & (abs(before[:, 1] / pole[1] - 1) < 0.1))
    ]
    return np.array(stable) if stable else np.full((1, 2), np.nan)


def _poles_of_order(result: Any, order: int) -> RealArray:
    """Frequencies and damping ratios of one model order, (n, 2)."""
    frequency, damping = result.Fn_poles[:, order], result.Xi_poles[:, order]
    known = np.isfinite(frequency) & np.isfinite(damping) & (damping > 0)
    return np.unique(np.column_stack([frequency[known], damping[known]]), axis=0)
