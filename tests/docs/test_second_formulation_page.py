"""Table of the largest differences between both formulations, from the stored converged values."""

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


def rows(page: str) -> list[list[str]]:
    """Cells of the table rows of a page."""
    text = (ROOT / "docs" / page).read_text("utf-8")
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in re.findall(r"^\|.*\|$", text, re.M)]


def differences(case: dict[str, Any], quantity: str) -> list[float]:
    return [entry["difference_pct"] for entry in case["value"] if entry["quantity"] == quantity]


def test_page_on_verification_shows_the_largest_differences() -> None:
    printed = {cells[0]: cells[1:] for cells in rows("verification.md") if cells[0] in STORED}
    passages = {name: case for name, case in STORED.items() if "uplift_force_N" in case}
    assert set(printed) == set(passages)
    for name, case in passages.items():
        largest = [max(differences(case, quantity), key=abs) for quantity in COLUMNS]
        assert [float(cell) for cell in printed[name]] == [pytest.approx(number, abs=6e-3) for number in largest], name
