"""Worth of the choice of filter and band: the printed numbers are those of the reference simulator."""

import re
from pathlib import Path

import pytest

from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.registry import QUANTITIES
from verification.tables.filter_and_band import CASES, FILTERS, band_changes, filter_changes, load_signals

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[2]
TOLERANCE = 0.3
"""Percentage points: about the discretisation error of a statistic."""


@pytest.fixture(scope="module")
def changes() -> dict[str, list[float]]:
    """Changes by case and filter or band, in the order of the columns [%]."""
    rows: dict[str, list[float]] = {}
    for name in CASES:
        signals = load_signals(load_case(library_folder() / f"{name}.toml"))
        for label, low_pass in FILTERS.items():
            rows[f"{name} | {label}"] = list(filter_changes(signals, low_pass).values())
        for band, pair in band_changes(signals).items():
            rows[f"{name} | {band}"] = list(pair)
    return rows


def test_page_prints_the_changes(changes: dict[str, list[float]]) -> None:
    page = (ROOT / "docs" / "quantities.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (en50318-2002/\d+ \| [^|]+) \| (.+) \|$", page, re.MULTILINE)
    assert len(rows) == len(changes) == 10
    for label, cells in rows:
        printed = [float(cell.removesuffix(" %")) for cell in cells.split(" | ")]
        assert printed == pytest.approx(changes[label], abs=TOLERANCE), label


def test_definitions_print_the_largest_change(changes: dict[str, list[float]]) -> None:
    causal = [changes[f"{case} | causal, order 6"] for case in CASES]
    largest = {
        name: max(abs(row[column]) for row in causal)
        for column, name in enumerate(("std_force_N", "max_force_N", "min_force_N"))
    }
    largest |= {
        band: max(abs(changes[f"{case} | {band}"][0]) for case in CASES)
        for band in ("rms_0_5_N", "rms_5_20_N", "rms_20_50_N")
    }
    assert {name for name, quantity in QUANTITIES.items() if quantity.other_definition} == set(largest)
    for name, value in largest.items():
        (printed,) = re.findall(r"by up to ([\d.]+) %", QUANTITIES[name].other_definition)
        assert float(printed) == pytest.approx(value, abs=TOLERANCE), name
