"""The page on the architecture: its paths exist, and the size budget covers every folder and holds."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PATHS = sorted(set(re.findall(r"`((?:model|conformance|reference_cases|templates|tests)/[\w./]*)`", TEXT)))
BUDGET = {
    folder: int(lines.replace(",", ""))
    for folder, lines in re.findall(r"^\| `([\w/]+)/` \| [\d,]+ \| ([\d,]+) \|", TEXT, re.MULTILINE)
}


@pytest.mark.parametrize("path", PATHS)
def test_path_on_the_page_exists(path: str) -> None:
    assert (ROOT / path).exists()


def test_budget_covers_every_folder() -> None:
    folders = {path.name for path in (ROOT / "conformance").iterdir() if (path / "__init__.py").exists()}
    assert set(BUDGET) == {"model", "conformance"} | {f"conformance/{name}" for name in folders}


@pytest.mark.parametrize("folder", BUDGET)
def test_folder_stays_within_its_budget(folder: str) -> None:
    files = (ROOT / folder).rglob("*.py") if folder != "conformance" else (ROOT / folder).glob("*.py")
    assert sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files) <= BUDGET[folder]
