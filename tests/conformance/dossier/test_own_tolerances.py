"""Forty dossiers with tolerances of their own that claim a standard: none passes by a width that judges nothing."""

from itertools import product
from pathlib import Path

import pytest

from helpers.example_dossier import CachedSimulator, copy_example, validate_example
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.dossier.dossier_file import LineTestTable
from pantocheck.conformance.dossier.line_test_step import build_line_test_profile
from pantocheck.conformance.results.results_format import Results

TOLERANCES = {
    "line.0.tolerance": ("elasticity_pct", "height_mm"),
    **{f"line_test.tolerance.{i}": ("tolerance",) for i in (0, 3, 4)},
    **{f"line_test.tolerance.{i}": ("tolerance_pct",) for i in (1, 2, 5)},
    **{f"pantograph.0.limit.{i}": ("upper",) for i in (0, 1)},
}
"""Ten tolerances of the example, by table and key."""

CLAIMS = tuple(product(("primary", "secondary"), ("EN 50318:2018, table 7", "EN 50318:2002, table 4")))
"""Trust and source that the author of a dossier states."""

ONE_PAIR = {
    "line.0.element_m": 1.0,
    "pair.2": None,
    "pair.1": None,
    "validity.speed_km_h": [160.0, 160.0],
    "validity.spacing_m": None,
}
"""The example with one pair, and claims that it verifies."""


def list_criteria(results: Results) -> list[Criterion]:
    """Criteria of all cases and steps."""
    of_steps = [row for step in results.procedure.steps for row in getattr(step, "criteria", ())]
    return [*(row for case in results.cases for row in case.criteria), *of_steps]


def test_tolerances_of_a_line_test_are_own() -> None:
    published = load_profile("line-test").rule
    wide = published[0].model_copy(update={"tolerance": 1e6, "trust": "primary", "source": "EN 50318:2018, table 7"})
    rules = build_line_test_profile(LineTestTable(tolerance=(wide, published[1]))).rule
    assert [rule.trust for rule in rules] == ["own", published[1].trust]
    assert rules[0].source != wide.source
    assert build_line_test_profile(LineTestTable()).rule == published


@pytest.mark.thorough
def test_no_tolerance_without_a_bound_passes(system: CachedSimulator, tmp_path: Path) -> None:
    wrong, count = [], 0
    for (table, keys), (trust, source) in product(TOLERANCES.items(), CLAIMS):
        for key in keys:
            count += 1
            name = f"{table}.{key} as {trust}, {source}"
            changes = ONE_PAIR | {f"{table}.{key}": 1e4, f"{table}.source": source}
            owner = table.removesuffix(".limit.0").removesuffix(".limit.1")
            changes[f"{owner}.trust"] = trust
            folder = tmp_path / str(count)
            results = validate_example(copy_example(folder / "in", changes), system, folder / "out")
            if results.verdict == "pass":
                wrong.append(f"{name}: {results.verdict}")
            wrong += [
                f"{name}: {row.quantity} {row.trust}"
                for row in list_criteria(results)
                if row.source == source and row.trust != "own" and row.verdict == "pass"
            ]
    assert (count, wrong) == (40, [])
