"""Tables of both formulations: every number is that of the stored converged values."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "reference_cases" / "converged"
STORED = {values["case"]: values for values in (tomllib.loads(p.read_text("utf-8")) for p in FOLDER.rglob("*.toml"))}
COLUMNS = ("std_force_N", "rms_0_5_N", "rms_5_20_N", "rms_20_50_N", "max_force_N", "min_force_N",
           "max_uplift_at_support_mm")  # fmt: skip
"""Columns of the table of docs/verification.md."""


def rows(page: str, heading: str = "") -> list[list[str]]:
    """Cells of the table rows below a heading, up to the next one; of the whole page without a heading."""
    text = (ROOT / "docs" / page).read_text("utf-8")
    below = text.partition(f"{heading}\n")[2].partition("\n#")[0] if heading else text
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in re.findall(r"^\|.*\|$", below, re.M)]


def differences(case: dict[str, Any], quantity: str) -> list[float]:
    return [entry["difference_pct"] for entry in case["value"] if entry["quantity"] == quantity]


@pytest.mark.parametrize("name", STORED)
def test_table_of_a_case_shows_the_stored_values(name: str) -> None:
    """Half a unit of the last printed digit, and as much of the stored one (six significant digits, 0.001 %)."""
    case = STORED[name]
    printed = {
        (cells[0], cells[1]): [float(cells[i]) for i in (5, -2, -1)]
        for cells in rows("second-formulation.md", f"### {name}")
        if len(cells) == 11 and cells[0] in {"1", "2", "line"}
    }
    stored = {(str(entry.get("pantograph", "line")), entry["quantity"]): entry for entry in case["value"]}
    assert set(printed) == set(stored) | {
        (str(entry.get("pantograph", "line")), entry["quantity"]) for entry in case.get("omitted", ())
    }
    for key, entry in stored.items():
        half = 6e-5 if entry["quantity"] == "elasticity_mm_N" else 6e-3
        assert printed[key][:2] == [pytest.approx(entry[part], abs=half) for part in ("value", "second_value")], key
        assert printed[key][2] == pytest.approx(entry["difference_pct"], abs=6e-3), key


def test_page_on_verification_shows_the_largest_differences() -> None:
    printed = {cells[0]: cells[1:] for cells in rows("verification.md") if cells[0] in STORED}
    passages = {name: case for name, case in STORED.items() if "uplift_force_N" in case}
    assert set(printed) == set(passages)
    for name, case in passages.items():
        largest = [max(differences(case, quantity), key=abs) for quantity in COLUMNS]
        assert [float(cell) for cell in printed[name]] == [pytest.approx(number, abs=6e-3) for number in largest], name
