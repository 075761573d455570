"""Requirements and criteria for tests of grading and of pages."""

from typing import Any

from pantocheck.conformance.core.criterion import Requirement
from pantocheck.conformance.quantities.registry import unit_of

COMPARED: dict[str, Any] = {
    "pantograph": 0, "lower": None, "trust": "provisional", "source": "", "discretisation_error": None,
    "limit_uncertainty": None, "close": ["lies near"],
}  # fmt: skip
"""Keys that most criteria of a comparison have in common; the record states no uncertainty."""


def build_requirement(quantity: str, lower: float | None, upper: float | None, **changes: Any) -> Requirement:
    """Limits of a quantity of pantograph 2."""
    stated = {"pantograph": 2, "unit": unit_of(quantity), "trust": "secondary", "source": "test", **changes}
    return Requirement.model_validate({"quantity": quantity, "lower": lower, "upper": upper, **stated})
