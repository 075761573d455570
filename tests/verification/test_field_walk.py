"""Walk over the fields of results: every change is found, or `walked_fields.toml` names the field with its means."""

import random
from collections.abc import Sequence
from typing import get_args

import pytest

from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.results_format import Results
from verification.attacks.consistent_results import Tree
from verification.attacks.field_walk import (
    ABSENT,
    LISTED,
    Change,
    is_accepted,
    list_changes,
    list_fields,
    list_places,
    read_place,
    try_change,
)

SAMPLE = 4
"""Fields that are drawn of the listed ones, and as many of the others."""
MEANS = {"rerun", "record", "signature", "none"}
"""Means that finds a change; none: no verdict rises by it."""

Changes = dict[str, list[Change]]


@pytest.fixture(scope="module")
def tree(wave_results: Results) -> Tree:
    return wave_results.to_dict()


@pytest.fixture(scope="module")
def changes(wave_results: Results) -> Changes:
    """Changes of one place of every field."""
    found: Changes = {}
    for change in list_changes(wave_results, 1):
        found.setdefault(change.field, []).append(change)
    return found


def find_accepted(tree: Tree, changes: Sequence[Change]) -> Change | None:
    return next((change for change in changes if try_change(tree, change)), None)


def test_sampled_fields_are_found_or_listed(tree: Tree, changes: Changes) -> None:
    """One change of a field that is not listed; of a listed one, all changes until one is accepted."""
    assert is_accepted(tree)
    chance = random.Random(31)
    ways: set[str] = set()
    listed, others = sorted(changes.keys() & LISTED.keys()), sorted(changes.keys() - LISTED.keys())
    for field in (*chance.sample(listed, SAMPLE), *chance.sample(others, SAMPLE)):
        tried = changes[field] if field in LISTED else [chance.choice(changes[field])]
        accepted = find_accepted(tree, tried)
        assert (accepted is not None) == (field in LISTED), accepted or f"{field} is listed, but every change is found"
        ways.update(() if accepted is None else try_change(tree, accepted))
    assert ways == {"alone", "regraded"}


@pytest.mark.thorough
def test_every_field_is_found_or_listed(tree: Tree, changes: Changes) -> None:
    """The list only shrinks: a listed field whose changes are all found fails, too."""
    accepted = {field for field, tried in changes.items() if find_accepted(tree, tried)}
    assert sorted(accepted - LISTED.keys()) == [], "\n".join(sorted(accepted - LISTED.keys()))
    assert sorted(LISTED.keys() - accepted) == [], "\n".join(sorted(LISTED.keys() - accepted))


def test_every_field_of_the_format_is_walked_or_absent(wave_results: Results) -> None:
    walked = {place.field for place in list_places(wave_results, [Results])}
    absent = set(list_fields([Results])) - walked
    inside = {field: [f for f in absent if f == field or f.startswith((f"{field}.", f"{field}["))] for field in ABSENT}
    left = sorted(absent - {field for fields in inside.values() for field in fields})
    assert left == [], "\n".join(left)
    assert [field for field, fields in inside.items() if not fields] == []


def test_every_listed_field_has_a_reason_and_a_means() -> None:
    assert [field for field, entry in LISTED.items() if entry["means"] not in MEANS or not entry["reason"]] == []


def test_every_verdict_is_tried(tree: Tree, changes: Changes) -> None:
    """A field with words of a list is tried with each other one."""
    for field in ("verdict", "cases[].verdict", "cases[].criteria[].verdict", "cases[].verification.verdict"):
        stated = read_place(tree, changes[field][0].path)
        tried = {change.value for change in changes[field]}
        assert tried >= set(get_args(Verdict)) - {stated}
