"""The page on the architecture: it is short, its files exist, and its drawing has the layers of the import rules."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
MOST_WORDS = 1500
"""Three printed pages."""


def test_page_is_short_and_its_files_and_layers_exist() -> None:
    assert len(TEXT.split()) <= MOST_WORDS
    paths = re.findall(r"`((?:model|conformance|tests|docs|verification)/[\w./]*)`", TEXT)
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    drawing = TEXT.split("```")[1]
    places = [drawing.index(f" {name}  ") for layer in layers for name in layer.split(" | ")]
    assert places == sorted(places)
