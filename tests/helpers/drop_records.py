"""A mass-drop record of noise at three sensors, and the comparison of records that were read back."""

import numpy as np
import pytest

from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.results.identified_modes import MeasuredLine

RATE, N = 100.0, 400


def build_drop_record() -> DropRecord:
    """Record of 4 s at 100 Hz with a fixed seed."""
    channels = (
        DropChannel("S1_z", 1, "z", "CW", 12.0),
        DropChannel("S1_y", 1, "y", "CW", 12.0),
        DropChannel("S2_z", 2, "z", "MW", 40.5),
    )
    signals = np.random.default_rng(0).standard_normal((N, 3))
    drop, line = (
        DropDescription(30, "CW", 33, 1.5),
        MeasuredLine(spans_m=(60.0, 54.0), contact_wire_tension_N=20e3, messenger_wire_tension_N=15e3),
    )
    return DropRecord("T", "made", RATE, signals, channels, "acceleration", drop, line)


def assert_same_record(read: DropRecord, record: DropRecord, tolerance: float) -> None:
    """Compare a record that was read back with the one that was written."""
    assert read.signals == pytest.approx(record.signals, abs=tolerance)
    assert (read.channels, read.drop, read.line, read.rate) == (record.channels, record.drop, record.line, record.rate)
    assert read.quantity == record.quantity
