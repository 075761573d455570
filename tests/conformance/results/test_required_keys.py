"""Keys of results.json that a verdict rests on: a file without one of them is refused, not read with a default."""

from typing import Any

import pytest
from pydantic import ValidationError

from helpers.example_passage import with_passage
from helpers.example_results import example
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.case_facts_format import BaselineComparison
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.procedure_format import Evidence
from pantocheck.conformance.results.results_format import CaseConformity, Results


@pytest.mark.parametrize("key", ["limits_digest", "stated_limits_digest", "criteria_verdict", "library", "verdict"])
def test_case_without_a_key_of_its_verdict_is_refused(key: str) -> None:
    results: dict[str, Any] = Results.model_validate(example()).to_dict()
    del results["cases"][0][key]
    with pytest.raises(ValidationError, match=key):
        Results.model_validate(results)


def test_mode_with_an_infinite_frequency_is_refused() -> None:
    mode = {"frequency_Hz": 1.0, "damping_ratio": 0.01, "damping_ratio_std": 1e-4, "sensor_shape": ()}
    assert Mode.model_validate(mode).frequency_Hz == 1.0
    with pytest.raises(ValidationError, match="finite"):
        Mode.model_validate(mode | {"frequency_Hz": float("inf")})


def test_evidence_that_does_not_state_a_pass_has_none() -> None:
    facts = {"id": "250", "line": "a", "pantographs": [], "speed_km_h": 250.0, "spacing_m": []}
    assert not Evidence.model_validate(facts).passed


@pytest.mark.parametrize("key", ["simulated_s", "wall_s", "dt_s", "element_m"])
def test_case_without_a_fact_of_its_run_is_refused(key: str) -> None:
    """An unknown fact is null. An assessed record without a usable sample has 0 s; a simulation has not."""
    results: dict[str, Any] = Results.model_validate(example()).to_dict()
    results["cases"][0]["run"] |= {"simulated_s": 0.0, "wall_s": None}
    assert Results.model_validate(results | {"conformity": 0.0}).cases[0].run.simulated_s == 0.0
    conformity = {"probability": 0.0, "starts": 0, "passing_starts": 0, "readings": {"a": 0.0, "b": 1.0}}
    assert CaseConformity.model_validate(conformity).starts == 0
    for wrong in ({"probability": 1.1}, {"starts": -1}, {"readings": {"a": -0.1}}, {"readings": {"a": 1.1}}):
        with pytest.raises(ValidationError):
            CaseConformity.model_validate(conformity | wrong)
    with pytest.raises(ValidationError, match="greater than 0"):
        RunTable.model_validate({"simulated_s": 0.0})
    del results["cases"][0]["run"][key]
    with pytest.raises(ValidationError, match=key):
        Results.model_validate(results)


def test_picture_of_a_wire_that_the_line_does_not_have_is_refused() -> None:
    """The wires of the picture are the curves 0 and 1 of the shape: one curve, or none, is too few."""
    results = with_passage()
    assert Results.model_validate(results).cases[0].motion is not None
    case = results["cases"][0]
    wires = case["motion"]["wires"]
    case["line_shape"]["side"]["curves"].pop()
    for changes in ({}, {"line_shape": None, "motion": case["motion"] | {"wires": wires[:1]}}):
        case |= changes
        with pytest.raises(ValidationError, match="a wire that the shape of the line does not have"):
            Results.model_validate(results)


@pytest.mark.parametrize(("key", "wrong"), [("drift_pct", 0.0), ("values", -1), ("drifted", -1)])
def test_impossible_comparison_with_a_baseline_is_refused(key: str, wrong: float) -> None:
    """A drift of half a percent may be accepted, but not one of zero: every rounding would be a drift."""
    stated = {"verdict": "info", "name": "b.json", "drift_pct": 0.5, "values": 0, "drifted": 0}
    assert BaselineComparison.model_validate(stated).drift_pct == 0.5
    with pytest.raises(ValidationError, match=key):
        BaselineComparison.model_validate(stated | {key: wrong})
