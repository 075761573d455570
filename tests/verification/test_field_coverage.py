"""Benchmark of records in the field: its truth, its pairs, its smallest widths and its judgement."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.pages.damping_page import NOMINAL_INTERVALS
from pantocheck.conformance.results.identified_modes import Mode
from verification.tables.__main__ import TABLES
from verification.tables.field_bound import compute_smallest_widths
from verification.tables.field_coverage import ROWS, describe_modes, describe_shares, match_true_modes, summarise
from verification.tables.field_records import LINES, Disturbance, FieldRecord, Layout, build_line, make_record
from verification.tables.interval_share import IntervalShare, append_row, read_rows

LAYOUT = Layout(20.0, ("CW", 139.5), (("CW", 99.0), ("MW", 209.25)), 2.0)
HIGHEST = 3.2


@pytest.fixture(scope="module")
def field() -> FieldRecord:
    """Drop of 20 kg with little noise on the first line."""
    line = build_line(next(iter(LINES)), (1.01, 0.99), (LAYOUT.drop[1], *(x for _, x in LAYOUT.sensors)))
    return make_record(np.random.default_rng(1), line, LAYOUT, Disturbance(), noise=1e-5)


def test_true_poles_are_those_of_the_records(field: FieldRecord) -> None:
    """Natural frequencies without the coupling by damping and without the time step differ by up to 3e-6."""
    (found,) = identify_modes((field.record,), HIGHEST)
    certain = [mode for mode in found.modes if mode.certain]
    frequency = np.abs(field.line.poles) / (2 * np.pi)
    pairs = match_true_modes(certain, frequency)
    assert pairs.spurious.size == 0
    assert pairs.reported.size >= 15
    errors = np.array([mode.frequency_Hz for mode in certain])[pairs.reported] / frequency[pairs.true] - 1
    assert np.abs(errors).max() < 5e-7
    ratio = -field.line.poles.real / np.abs(field.line.poles)
    errors = np.array([mode.damping_ratio for mode in certain])[pairs.reported] / ratio[pairs.true] - 1
    assert np.abs(errors).max() < 2e-4


def test_smallest_widths_grow_with_noise_and_ambient_motion(field: FieldRecord) -> None:
    base = compute_smallest_widths(field, HIGHEST)
    double = compute_smallest_widths(replace(field, noise=2 * field.noise), HIGHEST)
    assert double.ratio == pytest.approx(2 * base.ratio, rel=1e-6)
    assert list(double.coefficients.values()) == pytest.approx([2 * x for x in base.coefficients.values()], rel=1e-6)
    driven = compute_smallest_widths(replace(field, ambient=np.full(field.line.poles.size, 1e-6)), HIGHEST)
    seen = base.frequency < 1e-4
    assert np.all(driven.frequency[seen] > base.frequency[seen])


def make_mode(frequency: float, std: float = 1e-5) -> Mode:
    """Mode at a frequency [Hz]."""
    return Mode(
        frequency_Hz=frequency, frequency_std_Hz=std, damping_ratio=0.005, damping_ratio_std=1e-5, sensor_shape=()
    )


def test_the_second_mode_at_a_true_one_and_a_distant_one_are_spurious() -> None:
    modes = [make_mode(1.0), make_mode(1.001), make_mode(2.007), make_mode(3.007, 0.002)]
    pairs = match_true_modes(modes, np.array([1.0, 2.0, 3.0]))
    assert list(zip(pairs.reported, pairs.true, strict=True)) == [(0, 0), (3, 2)]
    assert pairs.spurious.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("share", "outcome"),
    [
        (IntervalShare(1000, 950, 1.2), "95 %"),
        (IntervalShare(1000, 933, 1.2), "93 to 97 %"),
        (IntervalShare(1000, 929, 1.2), "FAIL"),
        (IntervalShare(1000, 971, 1.2), "FAIL"),
        (IntervalShare(1000, 950, 1.6), "shortfall width"),
        (IntervalShare(999, 949, 1.2), "too few"),
        (IntervalShare(100, 89, 1.2), "too few"),
        (IntervalShare(200, 160, 1.2), "FAIL"),
    ],
)
def test_outcome_of_a_row(share: IntervalShare, outcome: str) -> None:
    assert share.outcome == outcome


def test_refused_records_stand_in_their_row(tmp_path: Path) -> None:
    """Two intervals of 10 and 12 contain errors of 9 and 13; the third record is refused."""
    empty = {
        f"{name}_{key}": value for name in ("frequency", "ratio", "coefficient") for key, value in summarise([]).items()
    }
    counts = {
        "observable": 2,
        "observable_found": 1,
        "modes": 2,
        "spurious": 1,
        "certain_spurious": 0,
        "identification_s": 3.0,
    }
    measured = {f"ratio_{key}": value for key, value in summarise([(9.0, 10.0, 5.0), (-13.0, 12.0, 6.0)]).items()}
    name = next(iter(ROWS))
    append_row(tmp_path / "a.csv", {"refused": "", **counts, **empty, **measured})
    append_row(tmp_path / "a.csv", {"refused": "droppers slacken", **dict.fromkeys(counts, 0), **empty})
    rows = read_rows(tmp_path / "a.csv")
    frequency, ratio, _ = describe_shares(rows, name)
    assert frequency == [name, "2", "1", "frequency", "0", "-", "-", "-", "-", "-"]
    assert ratio == [name, "2", "1", "damping ratio", "2 | 50.0 | 9.5 to 90.5 | 2.00", "2.1", "FAIL"]
    assert describe_modes(rows, name) == [name, "1", "50.0", "2", "1", "1", "0", "3.0"]


def test_pages_state_the_range_of_the_measured_coverage() -> None:
    """The rows up to 60 kg: most of the records of 100 kg are refused, and the page says so."""
    with (TABLES / "field-coverage.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["disturbance"] != "100 kg"]
    shares = [float(row["contained [%]"]) for row in rows if row["quantity"] != "coefficients"]
    assert f"{min(shares):.0f} to {max(shares):.0f} % of the intervals of the modes" in NOMINAL_INTERVALS
