"""Readings of AC simple: the tables of the page are those of the reference simulator, and repeat an earlier study."""

import csv

import pytest

from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from verification.tables.__main__ import TABLES
from verification.tables.readings import EDITIONS, READINGS, Run

EARLIER = {
    "default: order 3 twice, -3 dB in total": (34.99, 234.8, 84.6, 58.20, 323.5, 54.4, 27.29, 22.83, 41.87, 40.28),
    "order 4 twice": (34.66, 232.3, 83.5, 56.99, 312.6, 57.1, 26.93, 21.93, 41.55, 39.18),
    "order 6 twice": (35.00, 233.8, 81.1, 57.23, 311.6, 54.4, 27.1, 22.3, 41.7, 39.3),
}
"""Values of a study with filters of its own: sigma, maximum and minimum, and both bands, at 275 and 320 km/h [N]."""


def read_table(name: str) -> dict[str, list[str]]:
    """Cells of a stored table by the label of their row."""
    with (TABLES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return {row[0]: row[1:] for row in list(csv.reader(file))[1:]}


def select_numbers(cells: list[str]) -> list[float]:
    return [float(cell.rstrip("*")) for cell in cells if "%" not in cell]


@pytest.mark.parametrize("label", EARLIER)
def test_tables_repeat_the_earlier_study(label: str) -> None:
    """Its numbers are rounded to 0.1 N; padding and initial state of its filters change less than 0.02 N."""
    numbers = [
        number for name in ("forces", "bands") for number in select_numbers(read_table(f"readings-{name}")[label])
    ]
    assert numbers == pytest.approx(EARLIER[label], abs=0.07)


def test_one_reading_meets_both_editions() -> None:
    met = [label for label, row in read_table("readings-editions").items() if row[0] == row[2] == "16 of 16"]
    assert met == ["order 4 twice"]


@pytest.mark.thorough
@pytest.mark.parametrize("name", EDITIONS["2018"])
def test_simulator_gives_the_stored_tables(name: str) -> None:
    case = load_case(library_folder() / f"{name}.toml")
    run = Run(case, ReferenceSimulator().run_unrefined(case))
    for label, low_pass in READINGS.items():
        for table, cells in (("forces", run.force_cells(low_pass)), ("bands", run.band_cells(low_pass))):
            stored, columns = read_table(f"readings-{table}")[label], 3 * EDITIONS["2018"].index(name)
            expected = select_numbers(stored[columns : columns + 3])
            assert select_numbers(cells) == pytest.approx(expected, abs=0.02), label
