"""Page on the installation: packages, versions and extras are those of the project."""

import csv
import re
import tomllib
from pathlib import Path

from pantocheck.conformance.core.extras import EXTRA_OF_PACKAGE

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "installation.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def read_rows(heading: str) -> list[list[str]]:
    """Cells of the table below a heading."""
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return [[cell.strip() for cell in row[1:-1].split("|")] for row in re.findall(r"^\|.*\|$", section, re.MULTILINE)]


def test_table_of_extras_lists_packages_and_lowest_versions() -> None:
    requirements = {"core": PROJECT["dependencies"]} | {
        name: PROJECT["optional-dependencies"][name] for name in set(EXTRA_OF_PACKAGE.values())
    }
    listed = {row[0].strip("`"): row[1] for row in read_rows("Extras") if row[0].strip("`") in requirements}
    assert listed == {name: ", ".join(items).replace(">=", " ") for name, items in requirements.items()}


def test_size_of_the_core_is_below_380_mb() -> None:
    """Demanded of the record grader with HTML figures; `verification/speed/installation.py` measures it."""
    with (ROOT / "docs" / "tables" / "installation.csv").open(encoding="utf-8", newline="") as file:
        core = next(row for row in csv.DictReader(file) if row["installation"] == "core")
    assert float(core["size [MB]"]) < 380
    assert float(core["`--help` [s]"]) < 0.2
