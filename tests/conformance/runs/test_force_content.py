"""Content of the force at 30-50 Hz: the same filter of force and contact height is found, a stated one is accepted."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from helpers.extreme_runs import build_case, simulate
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.force_content import CONTENT, bending_length, force_content, kink_content
from pantocheck.conformance.runs.record_checks import check_record

Series = NDArray[np.float64]


@pytest.fixture(scope="module")
def run() -> tuple[Case, Record]:
    """Two pantographs 100 m apart at 250 km/h on the AC simple line."""
    case = build_case()
    return case, simulate(case)


def read_signals(case: Case, record: Record) -> RecordSignals:
    return RecordSignals(record, case.file.filter, case.line.geometry.supports)


def doubts(case: Case, record: Record) -> dict[str, str]:
    return {name: finding.kind for name, finding in check_record(case, read_signals(case, record)).items()}


def smooth(record: Record, rows: tuple[int, ...], low_pass: Callable[[Series, float], Series]) -> Record:
    """Force and contact height of some pantographs after the same filter."""
    force, height = record.force.copy(), np.array(record.contact_height)
    for row in rows:
        force[row], height[row] = (low_pass(channel[row], record.rate) for channel in (force, height))
    return replace(record, force=force, contact_height=height)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_same_filter_of_force_and_height_is_found(run: tuple[Case, Record], row: int, phase: str) -> None:
    """At 10 Hz; the equations of the pantograph hold for the filtered channels too."""
    case, record = run
    filtered = smooth(record, (row,), Filter(cutoff_Hz=10.0, phase=phase))
    finding = check_record(case, read_signals(case, filtered))["content"]
    assert finding.kind == "doubt"
    assert finding.text.startswith(f"pantograph {row + 1}: the force has 0.0")


@pytest.mark.parametrize("row", [0, 1])
def test_no_other_check_finds_the_same_filter(run: tuple[Case, Record], row: int) -> None:
    case, record = run
    assert doubts(case, smooth(record, (row,), Filter(cutoff_Hz=10.0))) == {"content": "doubt"}


def test_filter_at_10_Hz_stated_as_the_filter_of_the_case_is_found(run: tuple[Case, Record]) -> None:
    """The stated filter is divided out: the filter at 10 Hz still leaves 64 times less content at 30-50 Hz."""
    case, record = run
    filtered = replace(smooth(record, (0, 1), Filter(cutoff_Hz=10.0)), filter_applied_Hz=20.0)
    assert doubts(case, filtered)["content"] == "doubt"


@pytest.mark.parametrize("phase", ["zero", "causal"])
@pytest.mark.parametrize(("cutoff", "stated"), [(20.0, 20.0), (40.0, 40.0), (100.0, None)])
def test_stated_filter_is_accepted(run: tuple[Case, Record], phase: str, cutoff: float, stated: float | None) -> None:
    """A filter at 100 Hz, as against aliasing, need not be stated."""
    case, record = run
    filtered = replace(smooth(record, (0, 1), Filter(cutoff_Hz=cutoff, phase=phase)), filter_applied_Hz=stated)
    assert "content" not in doubts(case, filtered)


def test_slow_train_and_low_rate(run: tuple[Case, Record]) -> None:
    """Bending of the wire, over 0.094 m, rounds kinks at 50 Hz below 29.6 m/s; 80 samples per second end at 32 Hz."""
    case, record = run
    filtered = smooth(record, (0, 1), Filter(cutoff_Hz=10.0))
    assert_allclose(bending_length(case), np.sqrt(195.0 / 22e3))
    for speed, found in ((29.0, False), (30.0, True)):
        assert (CONTENT.run(case, read_signals(case, replace(filtered, speed=speed))) is not None) == found
    slow = {name: getattr(record, name)[:, ::6] for name in ("position", "force", "contact_height", "support_uplift")}
    finding = CONTENT.run(case, read_signals(case, replace(record, time=record.time[::6], **slow)))
    assert finding.kind == "unchecked"


def test_content_of_a_rigid_head_on_a_rigid_wire(run: tuple[Case, Record]) -> None:
    """A stiff contact on a heavy wire: F ~ w^2 m / f^2 of the head of 7.51 kg, which vibrates freely above 5 Hz."""
    case, _ = run
    wire = case.line.contact_wire.model_copy(update={"mass_kg_m": 1e12})
    (pantograph, *_) = case.pantographs
    chain = pantograph.chain.model_copy(update={"stiffness_N_m": (0.0, 0.0, 0.0), "damping_N_s_m": (0.0, 0.0, 0.0)})
    contact = pantograph.contact.model_copy(update={"stiffness_N_m": 1e12})
    rigid = pantograph.model_copy(update={"chain": chain, "contact": contact})
    changed = replace(
        case, line=case.line.model_copy(update={"contact_wire": wire}), pantographs=(rigid, case.pantographs[1])
    )
    # A spectrum that is constant: the bands of 20 and 15 Hz have the ratio of the roots of their widths.
    assert_allclose(kink_content(changed, 1, 50.0), np.sqrt(20 / 15), rtol=5e-3)


def test_content_of_two_sines(run: tuple[Case, Record]) -> None:
    """Sines of 10 and 40 Hz with amplitudes 20 and 3 N: 0.15, up to leakage of the window."""
    case, record = run
    time = record.time
    sines = 20.0 * np.sin(2 * np.pi * 10.0 * time) + 3.0 * np.sin(2 * np.pi * 40.0 * time)
    signals = read_signals(case, replace(record, force=np.array([sines, sines])))
    for number in (1, 2):
        assert_allclose(force_content(signals, number, 50.0), 0.15, rtol=1e-3)
