"""Model uncertainty of the reference simulator: the library holds the table of the page, a case names its effects."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.resolution import Effect, list_model_uncertainty, read_effects

PAGE = Path(__file__).parents[3] / "docs" / "exact-model.md"


def cells(effect: Effect) -> dict[str, str]:
    """Sizes as the page prints them, by quantity."""
    units = {"min_force_N": "N"}
    relative = {name: f"{size:.1f} %" for name, size in effect.relative_pct.items()}
    return relative | {name: f"{size:.1f} {units[name]}" for name, size in effect.absolute.items()}


def test_page_has_the_sizes_of_the_library() -> None:
    section = PAGE.read_text(encoding="utf-8").split("## Model uncertainty")[1].split("\n## ")[0]
    rows = [re.split(r" *\| *", line.strip("| ")) for line in section.splitlines() if line.startswith("|")]
    table = {row[0]: dict(zip(rows[0][1:], row[1:], strict=True)) for row in rows[2:]}
    assert {effect.along_track: cells(effect) for effect in read_effects()} == table


@pytest.mark.parametrize(
    ("along_track", "start"), [("free", "Messenger wire of constant tension"), ("fixed", "Messenger wire whose")]
)
def test_case_names_the_effects_of_its_supports(along_track: str, start: str) -> None:
    case = select_cases(["en50318-2002/250"])[0]
    support = case.line.messenger_support.model_copy(update={"along_track": along_track})
    changed = case.line.model_copy(update={"messenger_support": support})
    (sentence,) = list_model_uncertainty(replace(case, line=changed))
    assert sentence.startswith(start)
    assert sentence.endswith("docs/exact-model.md.")
