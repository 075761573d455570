"""Sampling rate of a mass-drop record, which must be the same in sidecar, file and time column."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

LOWEST_RATE, HIGHEST_RATE = 0.1, 1e6
"""Range of sampling rates [Hz]."""
RATE_TOLERANCE = 1e-3
"""Relative difference up to which two rates are the same."""


def find_sampling_rate(table: MeasuredTable, sidecar: DropSidecar | None) -> float:
    """Find the sampling rate [Hz] of a table with or without a sidecar.

    Raises:
        InputError: The rate is not stated, not possible, or differs between sidecar, file and time column.
    """
    sources = {
        "the sidecar": sidecar.record.sampling_rate_hz if sidecar else None,
        "the file": table.rate,
        "the time column": None if table.time is None else _rate_from_time(table.time, table.where),
    }
    rates = [(source, rate) for source, rate in sources.items() if rate is not None]
    if not rates:
        raise InputError(table.where, "states no sampling rate", "Give record.sampling_rate_hz in a sidecar.")
    first, rate = rates[0]
    for source, other in rates:
        if not LOWEST_RATE <= other <= HIGHEST_RATE:
            found = f"{source} states a sampling rate of {other:g} Hz"
            raise InputError(table.where, found, f"Give a rate from {LOWEST_RATE:g} to {HIGHEST_RATE:g} Hz.")
    for source, other in rates[1:]:
        if abs(other / rate - 1) > RATE_TOLERANCE:
            raise InputError(
                table.where,
                f"{first} states a sampling rate of {rate:g} Hz, but {source} {other:g} Hz",
                "Correct the wrong rate; all frequencies are proportional to it.",
            )
    return rate


def _rate_from_time(time: RealArray, where: str) -> float:
    """Sampling rate of a time column, whose values must be evenly spaced [Hz]."""
    if not np.isfinite(time).all():
        first = int(np.argmin(np.isfinite(time)))
        raise InputError(where, f"the time of sample {first + 1} is not finite", "Export the record again.")
    steps = np.diff(time)
    step = (time[-1] - time[0]) / (time.size - 1)
    if step <= 0:
        raise InputError(where, "the time column does not increase", "Export the samples in the order of time.")
    # Printed times are rounded by less than half a step; a missing sample adds a whole step.
    worst = int(np.argmax(np.abs(steps - step)))
    if abs(steps[worst] - step) > 0.5 * step:
        raise InputError(
            where,
            f"the time increases by {steps[worst]:g} s after {time[worst]:g} s, but by {step:g} s on average",
            "Export an evenly sampled record without gaps.",
        )
    return float(1 / step)
