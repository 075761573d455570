"""Forces of the strips of a head: in records, in the embedded signals, and in the curves of a page."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.evaluated_signals import pack_signals, unpack_signals
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.traces import build_pantograph_traces


@pytest.fixture
def record(two_pantograph_record: Record) -> Record:
    """The front strips carry 60 % of the force, and a sine of their own."""
    plain = replace(two_pantograph_record, evaluated=(155.0, 165.0))
    front = 0.6 * plain.force + 5 * np.sin(40 * plain.time)
    return replace(plain, front_strip=front, rear_strip=plain.force - front)


@pytest.mark.parametrize("suffix", [".csv", ".h5"])
def test_forces_of_strips_survive_a_file(record: Record, tmp_path: Path, suffix: str) -> None:
    """Twelve digits are written."""
    found = read_record(write_record(tmp_path / f"record{suffix}", record))[0]
    for name in ("front_strip", "rear_strip"):
        np.testing.assert_allclose(getattr(found, name), getattr(record, name), rtol=1e-11, atol=1e-9)


def test_forces_that_do_not_add_up_are_refused(record: Record) -> None:
    """The graded force is the sum of both: 0.1 N is rounding, 0.2 N is not."""
    replace(record, rear_strip=record.rear_strip + 0.09)
    for changes in ({"rear_strip": record.rear_strip + 0.2}, {"rear_strip": None}):
        with pytest.raises(RecordInvalid, match="do not add up"):
            replace(record, **changes)


def test_curves_and_embedded_signals_have_the_forces_of_both_strips(record: Record) -> None:
    signals = RecordSignals(record, Filter())
    packed = pack_signals(signals.pantographs, signals.line, record.time)
    assert packed is not None
    unpacked = unpack_signals(packed, Filter()).pantographs
    for pantographs in (signals.pantographs, unpacked):
        trace = build_pantograph_traces(pantographs, [])["1"]
        assert trace.strip_forces_N is not None
        np.testing.assert_allclose(np.sum(trace.strip_forces_N, axis=0), trace.force_N, rtol=1e-4, atol=1e-2)
        front = record.front_strip[0][signals.pantographs[1].inside]
        assert np.ptp(trace.strip_forces_N[0]) == pytest.approx(np.ptp(front), rel=1e-2)
    plain = RecordSignals(replace(record, front_strip=None, rear_strip=None), Filter())
    assert "strip_forces_N" not in build_pantograph_traces(plain.pantographs, [])["1"].model_dump()
