"""Numbers of the guide on the README: `docs/guide-values.json` has them."""

import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
COUNTS = {"closed_forms": r"(\d+) of (\d+) agree", "formulations": r"(\d+) of (\d+) values agree"}
COUNTS |= {"published": r"(\d+) of (\d+) lie inside"}


def test_counts_of_the_readme_are_those_of_the_guide() -> None:
    values = json.loads((ROOT / "docs" / "guide-values.json").read_text("utf-8"))["values"]
    text = (ROOT / "README.md").read_text("utf-8")
    for name, pattern in COUNTS.items():
        [(agreeing, total)] = re.findall(pattern, text)
        assert (int(agreeing), int(total)) == (values[f"counts/{name}_agreeing"], values[f"counts/{name}"]), name
