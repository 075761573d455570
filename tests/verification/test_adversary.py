"""Adversary: it finds a planted hole, its steps reach every field and signal, and its table belongs to its code."""

import copy
import csv
import random

import pytest

from pantocheck.conformance.core.packed_samples import PackedSamples
from pantocheck.conformance.documents import verification
from pantocheck.conformance.results.results_format import Results
from verification.attacks.adversary import (
    REFUSED,
    STEPS,
    _replace,
    adopt_widths,
    case_of,
    change_field,
    change_samples,
    code_digest,
    follow_checks,
    follow_signals,
    list_signals,
    measure_distance,
    optimise,
    read_place,
    regrade,
)
from verification.attacks.consistent_results import Tree
from verification.attacks.field_walk import list_places
from verification.tables.__main__ import TABLES


@pytest.fixture(scope="module")
def tree(wave_results: Results) -> Tree:
    return wave_results.to_dict()


def test_table_belongs_to_the_code_and_shows_no_hole() -> None:
    """Every kind of step, with the code of today; a PASS of `record` is found by its record."""
    with (TABLES / "adversary.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["steps"] for row in rows} == set(STEPS)
    assert {row["code"] for row in rows} == {code_digest()}
    assert all(float(row["smallest distance"]) > 0 or row["steps"] == "record" for row in rows)
    assert all(row["`--record`"] == "found" for row in rows)


def test_distance_is_zero_only_for_a_consistent_pass(tree: Tree, accepted_wave: Results) -> None:
    """The wave fails two criteria; a PASS with limits of a user is none."""
    distance, found = measure_distance(tree)
    assert found is not None
    assert distance > 1.0
    assert measure_distance(accepted_wave.to_dict())[0] == REFUSED
    forged = copy.deepcopy(tree)
    forged["verdict"] = "pass"  # one contradiction, but no other verdict
    assert measure_distance(forged)[0] == pytest.approx(distance + 0.1)


def test_planted_hole_is_found(tree: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    """Words alone make no PASS; without the check of the numbers, they do at the first step."""

    def shift(results: Tree, _: random.Random) -> Tree:
        forged: Tree = _replace(results, "fail", "pass")
        return forged

    assert optimise(tree, shift, 1, 0.5)[1] > 0
    monkeypatch.setattr(verification, "find_discrepancies", lambda _: [])
    trials, distance, _, found = optimise(tree, shift, 1, 60.0)
    assert (trials, distance, found.verdict, found.state) == (1, 0.0, "pass", "consistent")


@pytest.mark.parametrize("share", [0.1, pytest.param(1.0, marks=pytest.mark.thorough)])
def test_steps_change_any_field_and_any_signal(tree: Tree, share: float) -> None:
    """Every part of the results is drawn, and every channel of the signals, at single samples and as a whole."""
    results = Results.model_validate(tree)
    fields = {place.field: place.path for place in list_places(results, [Results])}
    chance, changed = random.Random(1), set()
    for _ in range(round(40 * share)):
        try:
            forged = change_field(tree, chance)
        except (ValueError, TypeError, KeyError, ArithmeticError):
            continue
        changed |= {field for field, path in fields.items() if _differs(forged, tree, path)}
    assert len(changed) >= 40 * share
    signals = list(list_signals(case_of(tree)["signals"]))
    assert {path[-1] for path in signals} >= {"position_m", "force_N", "contact_height_m", "uplift_m", "time_s"}
    moved = set()
    for _ in range(round(60 * share)):
        try:
            other = case_of(change_samples(tree, chance))
        except (ValueError, TypeError, KeyError, ArithmeticError, IndexError):
            continue  # results that the format refuses
        parts = other.get("signals") or {}
        moved |= {path for path in signals if parts and _differs(parts, case_of(tree)["signals"], path)}
    assert len(moved) >= share * (len(signals) - 2)


def _differs(tree: Tree, other: Tree, path: tuple[str | int, ...]) -> bool:
    try:
        return bool(read_place(tree, path) != read_place(other, path))
    except (KeyError, IndexError, AttributeError, TypeError):
        return True


def test_results_that_follow_from_unchanged_signals_are_the_same(tree: Tree) -> None:
    """The strongest forger makes everything again: without a change, nothing differs but the drawn uplift."""
    forged = copy.deepcopy(tree)
    follow_signals(case_of(forged))
    follow_checks(case_of(forged))
    regrade(forged)
    adopt_widths(case_of(forged))
    assert measure_distance(forged)[0] == pytest.approx(measure_distance(tree)[0])
    force = PackedSamples.model_validate(case_of(forged)["signals"]["pantographs"]["1"]["force_N"]).unpack()
    assert force.size > 1000
