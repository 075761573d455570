"""Keys of results.json that a verdict rests on: a file without one of them is refused, not read with a default."""

from typing import Any

import pytest
from pydantic import ValidationError

from helpers.example_results import example
from pantocheck.conformance.results.results_format import Results


@pytest.mark.parametrize("key", ["limits_digest", "stated_limits_digest", "criteria_verdict", "library", "verdict"])
def test_case_without_a_key_of_its_verdict_is_refused(key: str) -> None:
    results: dict[str, Any] = Results.model_validate(example()).to_dict()
    del results["cases"][0][key]
    with pytest.raises(ValidationError, match=key):
        Results.model_validate(results)
