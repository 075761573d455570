"""Lowest versions: every dependency has a lower bound, and an extra that names others brings theirs."""

import tomllib
from pathlib import Path

import pytest

from verification.packaging import lowest_versions


def test_every_extra_has_lower_bounds_and_all_contains_the_others() -> None:
    path = Path(lowest_versions.__file__).parents[2] / "pyproject.toml"
    extras = tomllib.loads(path.read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    constraints = {extra: set(lowest_versions.build_constraints([extra])) for extra in extras}
    core = set(lowest_versions.build_constraints([]))
    assert any(line.startswith("numpy==") for line in core)
    (compiler,) = constraints["simulator"] - core
    assert compiler.startswith("numba==")
    assert constraints["all"] >= set.union(*(constraints[name] for name in ("simulator", "pdf", "massdrop", "cluster")))
    assert constraints["test"] > constraints["simulator"]
    with pytest.raises(ValueError, match="'numpy' has no lower bound"):
        lowest_versions.pin_lowest("numpy")
