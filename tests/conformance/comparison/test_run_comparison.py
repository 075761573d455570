"""Compared runs: every quantity that a run has, its largest difference, and the joint uncertainty."""

from dataclasses import replace
from typing import Any

from helpers.example_passage import with_passage
from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.run_comparison import add_scenes, compare_subjects
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.results.results_format import Results


def run(name: str, values: dict[str, Value], uncertainty: dict[str, Value]) -> ComparedRun:
    keys: dict[str, Any] = {"kind": "record", "source": name, "digest": "", "case": "", "speed_km_h": 250.0}
    return ComparedRun(name=name, values={1: values}, uncertainty={1: uncertainty}, **keys)


def test_every_quantity_of_any_run_is_compared() -> None:
    """The joint half-width of 0.3 and 0.4 is 0.5: a difference of 0.5 does not exceed it, one of 0.6 does."""
    first = run("first", {"mean_force_N": 120.0, "std_force_N": 30.0, "max_force_N": 200.0}, {"mean_force_N": 0.3})
    other = run("other", {"mean_force_N": 119.4, "std_force_N": 31.0, "min_force_N": 50.0}, {"mean_force_N": 0.4})
    third = run("third", {"mean_force_N": 120.5}, {"mean_force_N": 0.4})
    comparison = compare_subjects([[first], [other], [third]], None)
    assert "scenes" not in comparison.model_dump()
    (owner,) = comparison.cases[0].owners
    found = {item.name: item for item in owner.quantities}
    assert set(found) == {"mean_force_N", "std_force_N", "max_force_N", "min_force_N"}
    assert found["std_force_N"].difference[1:] == (1.0, None)
    assert found["mean_force_N"].beyond_uncertainty == (False, True, False)
    assert found["min_force_N"].difference == (None, None, None)


def test_passages_of_lines_with_other_wires_are_not_laid_over_each_other() -> None:
    case = Results.model_validate(with_passage()).cases[0]
    shape = case.line_shape
    assert shape is not None
    lone = shape.model_copy(update={"side": shape.side.model_copy(update={"curves": shape.side.curves[:1]})})
    subjects = [
        [ComparedRun("results", name, "", "", case.id, None, {}, {}, shape=drawn, motion=case.motion)]
        for name, drawn in (("first", shape), ("second", shape), ("other", lone))
    ]
    [scene] = add_scenes(compare_subjects(subjects, None), subjects).scenes
    assert scene.names == ["first", "second"]
    assert scene.together
    assert add_scenes(compare_subjects(subjects[1:], None), subjects[1:]).scenes == ()
    assert case.motion is not None
    still = replace(subjects[1][0], motion=case.motion.model_copy(update={"speed_m_s": 0.0}))
    pair = [subjects[0], [still]]
    assert add_scenes(compare_subjects(pair, None), pair).scenes == ()
