"""Combination of the components of an uncertainty."""

import math

import pytest

from pantocheck.conformance.grading.results_building import list_components
from pantocheck.conformance.quantities.uncertainty import Component, Uncertainty, map_items

BOTH = Uncertainty(
    {
        "discretisation": Component("meshes", {0: {"presag_mm": (3.0, 0.0)}, 2: {"std_force_N": 0.3}}),
        "start": Component("not known: one start"),
        "length": Component("bootstrap", {2: {"std_force_N": 0.4, "mean_force_N": 1.5}, 1: {"cov_20": math.nan}}),
    }
)


def test_components_combine_and_an_unknown_one_has_no_number() -> None:
    """3-4-5; each item of a quantity with several values on its own; a half-width that is not finite is unknown."""
    combined = BOTH.combined
    assert combined[2] == {"std_force_N": pytest.approx(0.5, rel=1e-12), "mean_force_N": 1.5}
    assert combined[0] == {"presag_mm": (3.0, 0.0)}
    assert combined[1] == {}
    assert BOTH.list_components(2, "std_force_N") == {"discretisation": 0.3, "length": 0.4}
    assert BOTH.list_components(3, "std_force_N") == {}
    assert BOTH.basis["start"] == "not known: one start"
    parts = list_components(BOTH)
    assert parts["2"]["std_force_N"] == {"discretisation": 0.3, "length": 0.4}
    assert parts["0"] == {"presag_mm": {"discretisation": [3.0, 0.0]}}
    assert BOTH.combined[0]["presag_mm"] == (3.0, 0.0)
    assert not BOTH.combined[1]


def test_items_are_combined_one_by_one_and_never_narrow_the_interval() -> None:
    assert map_items(math.hypot, 2.0, 0.0) == 2.0
    assert map_items(math.hypot, (2.0, 1.0), (0.0, 1.0)) == (2.0, math.sqrt(2))
    assert map_items(lambda a, b: a - b, (3.0, 5.0), (1.0, 2.0)) == (2.0, 3.0)
    assert map_items(lambda a: -a, 3.0) == -3.0
    with pytest.raises(ValueError, match="zip"):
        map_items(lambda a, b: a + b, (3.0, 5.0), (1.0,))


def test_selection_keeps_the_named_components() -> None:
    """Against converged values only some components count; the others, larger here, must not."""
    parts = Uncertainty(
        {
            "discretisation": Component("meshes", {1: {"std_force_N": 0.3}, 2: {"std_force_N": 0.5}}),
            "start": Component("starts", {1: {"std_force_N": 0.4}, 2: {"std_force_N": 1.2}}),
        }
    )
    assert parts.select(("discretisation",)).combined == {1: {"std_force_N": 0.3}, 2: {"std_force_N": 0.5}}
    assert parts.select(("discretisation", "start")).combined == {1: {"std_force_N": 0.5}, 2: {"std_force_N": 1.3}}
