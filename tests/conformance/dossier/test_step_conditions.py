"""Parameters and conditions of the runs: each run counts, each declared part is listed."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from helpers.example_results import passing_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.dossier import model_steps
from pantocheck.conformance.dossier.dossier_file import ParameterTable, StaticTolerance
from pantocheck.conformance.dossier.line_test_step import LINE_TEST_PROFILE, LineTests
from pantocheck.conformance.dossier.model_steps import check_pantographs, check_parameters, check_statics
from pantocheck.conformance.dossier.run_reading import list_mismatches, measure_spacing, run_and_read
from pantocheck.conformance.dossier.step_result import grade_again, list_inputs
from pantocheck.conformance.dossier.validation import Validation
from pantocheck.conformance.results.results_format import CaseResult


def build_dossier(parameters: dict[str, Any], *claimed: str) -> Any:
    """Parts of a dossier that the steps read."""
    return SimpleNamespace(
        file=SimpleNamespace(
            parameters=ParameterTable(**parameters),
            trust="secondary",
            validity=SimpleNamespace(change=[SimpleNamespace(key=key) for key in claimed]),
        )
    )


def build_run(**facts: Any) -> CaseResult:
    case = CaseResult.model_validate(passing_case())
    return case.model_copy(update={"run": case.run.model_copy(update=facts)})


def test_declared_parameters_bound_every_run() -> None:
    """The second run has the largest element, the largest step and the shortest time."""
    dossier = build_dossier({"element_m": 0.5, "time_step_s": 0.001, "shortest_run_s": 10.0, "start": "at rest"})
    good = build_run(element_m=0.4, dt_s=0.0005, simulated_s=12.0)
    worse = build_run(element_m=0.6, dt_s=0.002, simulated_s=9.0)
    step = check_parameters(dossier, [good, worse])
    assert [(row.value, row.verdict) for row in step.criteria] == [(0.6, "fail"), (0.002, "fail"), (9.0, "fail")]
    assert [item.name for item in step.parameters] == [
        "largest_element_m", "largest_time_step_s", "shortest_run_s", "start",
    ]  # fmt: skip
    assert [row.verdict for row in check_parameters(dossier, [good, good]).criteria] == ["pass"] * 3


def test_runs_of_a_train_with_quantities_state_the_parameters() -> None:
    """A case at rest and a run without a result have no parameters of a passage."""
    at_rest, ended = build_run(speed_km_h=None), build_run().model_copy(update={"quantities": {}})
    steps = {name: SimpleNamespace(cases=[at_rest, ended, build_run()]) for name in ("reference_models", "line_test")}
    validation: Any = Validation
    assert validation._list_runs(SimpleNamespace(finished=steps)) == [build_run()] * 2


def test_inputs_and_parameters_of_a_claim_are_listed(case_250: Case) -> None:
    """An input of pantographs that differ, one that does not exist, and a text have no number."""
    line, pantographs = case_250.line, case_250.pantographs
    tension, force = "line.contact_wire.tension_N", "pantograph.chain.masses_kg.2"
    dossier = build_dossier({}, tension, force, "pantograph.chain.masses_kg.9", "line.title", "speed_km_h")
    chain = pantographs[0].chain
    expected = {tension: line.contact_wire.tension_N, force: chain.masses_kg[1]}
    assert list_inputs(dossier, line, pantographs) == expected
    step = check_parameters(build_dossier({"start": "at rest"}), [build_run()])
    assert {row.quantity: row.verdict for row in step.criteria} == dict.fromkeys(
        ("largest_element_m", "largest_time_step_s", "shortest_run_s"), "skip"
    )
    step = check_parameters(build_dossier({"element_m": 1.0}), [build_run(element_m=0.5)])
    (start,) = (row for row in step.criteria if row.quantity == "start")
    assert (start.verdict, start.reason) == ("skip", "the dossier does not declare it")


def build_side(speed: float = 250.0, section: tuple[float, float] = (100.0, 300.0)) -> Any:
    """Run of a pair with two pantographs."""
    header = SimpleNamespace(speed_km_h=speed, evaluated_m=section)
    record = SimpleNamespace(header=header, pantographs=(1, 2), values=SimpleNamespace(values={}))
    facts = {"line": "a", "pantographs": ("p", "p"), "direction": "up", "spacing_m": (85.0,), "span_m": 60.0}
    return SimpleNamespace(record=record, **facts)


def test_mismatch_of_a_pair_names_both_runs() -> None:
    profile = load_profile(LINE_TEST_PROFILE)
    simulated, measured = build_side(), build_side(300.0, (140.0, 340.0))
    assert list(list_mismatches(simulated, simulated, profile)) == []
    assert list(list_mismatches(simulated, measured, profile)) == [
        "the speed of the measured run: 300 km/h; of the simulated run: 250 km/h",
        "the analysis section of the measured run: 140 to 340 m; of the simulated run: 100 to 300 m",
    ]


def test_spacing_follows_from_positions_that_were_sampled_together() -> None:
    ahead = np.arange(10.0)
    for stated, positions, expected in (
        (None, {1: ahead}, ()),
        ((90.0,), {1: ahead, 2: ahead - 85.0}, (90.0,)),
        (None, {1: ahead, 2: ahead - 85.0}, (85.0,)),
        (None, {1: ahead, 2: ahead[1:] - 85.0}, None),
    ):
        pantographs = {number: SimpleNamespace(position=position) for number, position in positions.items()}
        record: Any = SimpleNamespace(
            header=SimpleNamespace(spacing_m=stated),
            pantographs=tuple(positions),
            prepared=SimpleNamespace(pantographs=pantographs) if len(positions) > 1 else None,
        )
        assert measure_spacing(record) == expected


def test_quantity_without_a_tolerance_is_listed_for_its_owners() -> None:
    """A quantity of the force for each pantograph, the uplift of the supports for the line."""
    profile = load_profile(LINE_TEST_PROFILE)
    tests: Any = LineTests
    rows = list(tests._list_ungraded(None, build_side(), profile.model_copy(update={"rule": ()})))
    owners = {row.quantity: [other.pantograph for other in rows if other.quantity == row.quantity] for row in rows}
    assert owners["std_force_N"] == [1, 2]
    assert owners["max_uplift_at_support_mm"] == [0]


def test_pass_by_a_wide_own_tolerance_does_not_count() -> None:
    """A tolerance of more than 50 % of the measured value; an upper limit in another unit may be any number."""
    (row, *_) = CaseResult.model_validate(passing_case()).criteria
    for unit, upper, verdict in (("%", 50.0, "pass"), ("%", 51.0, "info"), ("N", 51.0, "pass")):
        graded = row.model_copy(update={"unit": unit, "lower": None, "upper": upper, "value": 49.5, "components": {}})
        again = grade_again(graded, {}, "secondary")
        assert again.verdict == verdict
        assert again.limit_uncertainty in (None, 0.0)
        again = grade_again(graded.model_copy(update={"limit_uncertainty": 0.3}), {}, "secondary")
        assert again.limit_uncertainty == 0.3


@pytest.mark.parametrize("step", ["pantograph", "line"])
def test_entry_without_a_measurement_is_named_beside_others(step: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second of three entries has none."""
    found = SimpleNamespace(criteria=(), values=())
    for name in ("_compare", "_compare_statics"):
        monkeypatch.setattr(model_steps, name, lambda *_: found)
    monkeypatch.setattr(model_steps, "_skip_unlimited", lambda *_: ())
    measured = SimpleNamespace(name="a", responses=("a.csv",), statics="a.csv", tolerance=StaticTolerance())
    missing = SimpleNamespace(name="b", responses=(), statics=None, tolerance=StaticTolerance())
    entries = (measured, missing, measured)
    dossier: Any = SimpleNamespace(file=SimpleNamespace(pantograph=entries, line=entries, trust="secondary"))
    result = check_pantographs(dossier) if step == "pantograph" else check_statics(dossier)
    rows = [row for row in result.criteria if f"(key {step}[2]." in str(row.reason)]
    assert rows
    assert len(result.responses if step == "pantograph" else result.statics) == 2
    alone: Any = SimpleNamespace(file=SimpleNamespace(line=(measured,), trust="secondary"))
    assert {row.item for row in check_statics(alone).criteria} <= {None}


def test_run_with_another_filter_than_the_line_tests_is_refused(case_250: Case, tmp_path: Any) -> None:
    profile = load_profile(LINE_TEST_PROFILE)
    other = profile.model_copy(update={"filter": profile.filter.model_copy(update={"cutoff_Hz": 19.0})})
    nothing: Any = None
    with pytest.raises(InputError, match="is not that of the line tests"):
        run_and_read(case_250, "up", nothing, nothing, other, tmp_path / "run.h5")
