"""Fixture with converged values for a case, in place of those of the library."""

from collections.abc import Callable, Mapping
from typing import Any

import pytest

from pantocheck.conformance.app.pytest_plugin import collection
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import ConvergedFile
from pantocheck.conformance.documents import library_check
from pantocheck.conformance.grading import case_selection, case_verification
from pantocheck.conformance.quantities.evaluation import Value

StateConverged = Callable[..., ConvergedFile]
"""Function that states converged values of a case by pantograph and quantity."""


def build_converged(case: Case, values: Mapping[int, Mapping[str, Value]], **changes: Any) -> ConvergedFile:
    """Converged values of a case with a half-width of a thousandth of each value."""
    formulation = {"name": "finite differences", "spacing_m": [0.25, 0.125], "time_step_s": [1e-3, 5e-4]}
    entries = [
        {
            "quantity": quantity,
            **({"pantograph": owner} if owner else {}),
            "value": value,
            "half_width": 1e-3 * abs(value),
            "second_value": value,
            "difference_pct": 0.0,
        }
        for owner, quantities in values.items()
        for quantity, value in quantities.items()
        if isinstance(value, float)
    ]
    content = {
        "schema": "pantocheck.converged/1",
        "case": case.id,
        "case_digest": case.digest,
        "trust": "computed",
        "reference": formulation | {"name": "reference simulator"},
        "second": formulation,
        "value": entries,
    }
    return ConvergedFile.model_validate(content | changes)


@pytest.fixture
def state_converged(monkeypatch: pytest.MonkeyPatch) -> StateConverged:
    """Converged values of the stated cases; no other case has any."""
    known: dict[str, ConvergedFile] = {}
    for reader in (collection, library_check, case_selection, case_verification):
        monkeypatch.setattr(reader, "find_converged", known.get)

    def state(case: Case, values: Mapping[int, Mapping[str, Value]], **changes: Any) -> ConvergedFile:
        known[case.id] = build_converged(case, values, **changes)
        return known[case.id]

    return state
