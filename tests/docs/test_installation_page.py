"""Page on the installation: packages, versions and extras are those of the project, commands can reach their extras."""

import csv
import re
import tomllib
from pathlib import Path

import grimp
import pytest

from pantocheck.conformance.command_line.app import COMMANDS
from pantocheck.conformance.input_files.extras import EXTRA_OF_PACKAGE

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "installation.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
READERS = {"massdrop", "tdms", "mdf"}


def read_rows(heading: str) -> list[list[str]]:
    """Cells of the table below a heading."""
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return [[cell.strip() for cell in row[1:-1].split("|")] for row in re.findall(r"^\|.*\|$", section, re.MULTILINE)]


USES = {
    command: (set(re.findall(r"`(\w+)`", needs)), set(re.findall(r"`(\w+)`", uses)) - {"builtin"}, "readers" in uses)
    for names, needs, uses in read_rows("Commands and their extras")
    for command in re.findall(r"`([\w -]+)`", names)
    if command in COMMANDS
}
"""Extras that a command always needs, extras that it can use, and whether it reads measured files."""


def test_table_of_extras_lists_packages_and_lowest_versions() -> None:
    requirements = {"core": PROJECT["dependencies"]} | {
        name: PROJECT["optional-dependencies"][name] for name in set(EXTRA_OF_PACKAGE.values())
    }
    listed = {row[0].strip("`"): row[1] for row in read_rows("Extras") if row[0].strip("`") in requirements}
    assert listed == {name: ", ".join(items).replace(">=", " ") for name, items in requirements.items()}


@pytest.fixture(scope="module")
def imports() -> grimp.ImportGraph:
    """Imports of all files, those by name included."""
    graph = grimp.build_graph(
        "pantocheck.model", "pantocheck.conformance", cache_dir=None, include_external_packages=True
    )
    folder = "pantocheck.conformance.input_files.formats"
    for reader in graph.find_children(folder):
        graph.add_import(importer="pantocheck.conformance.input_files.table_formats", imported=reader)
    graph.add_import(
        importer="pantocheck.conformance.systems.system_choice",
        imported="pantocheck.conformance.systems.reference_simulator",
    )
    return graph


def test_commands_can_reach_the_extras_of_the_page(imports: grimp.ImportGraph) -> None:
    """An extra of the page that no file behind a command imports would be wrong; an unlisted command has none."""
    wrong = []
    for command in COMMANDS:
        name = command.replace("-", "_").replace(" ", "_")
        modules = imports.find_upstream_modules(f"pantocheck.conformance.command_line.{name}_command")
        reached = {EXTRA_OF_PACKAGE[module] for module in modules if module in EXTRA_OF_PACKAGE}
        needs, uses, reads = USES.get(command, (set(), set(), False))
        wrong += [(command, extra) for extra in (needs | uses | (READERS if reads else set())) - reached]
    assert wrong == []


def test_size_of_the_core_is_below_380_mb() -> None:
    """Demanded of the record grader with HTML figures; `verification/speed/installation.py` measures it."""
    with (ROOT / "docs" / "tables" / "installation.csv").open(encoding="utf-8", newline="") as file:
        core = next(row for row in csv.DictReader(file) if row["installation"] == "core")
    assert float(core["size [MB]"]) < 380
    assert float(core["`--help` [s]"]) < 0.2
