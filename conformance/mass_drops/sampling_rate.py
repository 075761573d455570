"""Sampling rate of a mass-drop record: sidecar, file and time column must agree."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

LOWEST_RATE, HIGHEST_RATE = 0.1, 1e6  # [Hz]
RATE_TOLERANCE = 1e-3  # relative


def find_sampling_rate(table: MeasuredTable, sidecar: DropSidecar | None) -> float:
    """Sampling rate [Hz].

    Raises
    ------
    InputError
        No source states a rate, the rate is not positive, or two sources disagree.
    """
    sources = {
        "the sidecar": sidecar.record.sampling_rate_hz if sidecar else None,
        "the file": table.rate,
        "the time column": None if table.time is None else _rate_from_time(table.time, table.where),
    }
    rates = [(source, rate) for source, rate in sources.items() if rate is not None]
    if not rates:
        raise InputError(table.where, "states no sampling rate", "Give sampling_rate_hz in a sidecar.")
    first, rate = rates[0]
    for source, other in rates:
        if not LOWEST_RATE <= other <= HIGHEST_RATE:
            found = f"{source} says {other:g} samples per second"
            raise InputError(table.where, found, f"The rate lies between {LOWEST_RATE:g} and {HIGHEST_RATE:g} Hz.")
    for source, other in rates[1:]:
        if abs(other / rate - 1) > RATE_TOLERANCE:
            raise InputError(
                table.where,
                f"{first} says {rate:g} samples per second, {source} says {other:g}",
                "Every frequency is proportional to the rate: correct the one that is wrong.",
            )
    return rate


def _rate_from_time(time: RealArray, where: str) -> float:
    """Rate of a time column that must be evenly spaced."""
    if not np.isfinite(time).all():
        first = int(np.argmin(np.isfinite(time)))
        raise InputError(where, f"time of sample {first + 1} is not a number", "Export the record again.")
    steps = np.diff(time)
    step = (time[-1] - time[0]) / (time.size - 1)
    if step <= 0:
        raise InputError(where, "the time column does not increase", "Export the record again, in order of time.")
    # Printed times are rounded by less than half a step; a missing sample is a whole step.
    worst = int(np.argmax(np.abs(steps - step)))
    if abs(steps[worst] - step) > 0.5 * step:
        raise InputError(
            where,
            f"the time column steps by {steps[worst]:g} s after {time[worst]:g} s, elsewhere by {step:g} s",
            "The record must be sampled evenly and without gaps.",
        )
    return float(1 / step)
