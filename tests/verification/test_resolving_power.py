"""Resolving power: search of the first change of a verdict, errors of the inputs, and stored files."""

from pathlib import Path

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import ErrorBound, ResolvingPowerFile, find_resolving_power, read_study
from pantocheck.conformance.cases.library import select_cases
from verification.tables import resolving_power
from verification.tables.input_variations import (
    Choice,
    Grade,
    NotApplicable,
    grade_error,
    list_changes,
    read_variations,
    vary_choice,
)
from verification.tables.resolving_power import (
    complete_file,
    find_first_change,
    measure_input,
    name_criteria,
    predict_forces,
    write_file,
)

INPUTS = {item.name: item for item in read_variations().input}
PASS = Grade("pass", "pass", "")
FAIL = Grade("pass", "fail", "rms_20_50_N (verification)")


def search(limits: tuple[float, float], largest: float = 100.0) -> tuple[ErrorBound, list[float]]:
    """Bound of a verdict that fails strictly between two errors, and the tried errors."""
    tried: list[float] = []

    def grade(error: float) -> Grade:
        tried.append(error)
        return FAIL if limits[0] < error < limits[1] else PASS

    return find_first_change(grade, lambda found: found.passes, 1.0, largest), tried


def test_first_change_is_bracketed_within_a_tenth() -> None:
    bound, tried = search((11.3, 1e9))
    assert tried[:5] == [1.0, 2.0, 4.0, 8.0, 16.0]
    assert bound.passed <= 11.3 < bound.noticed <= bound.passed + 0.1 * bound.noticed
    assert bound.by == "rms_20_50_N (verification)"
    bound, tried = search((0.3, 1e9))
    assert bound.passed <= 0.3 < bound.noticed <= bound.passed + 0.1  # below the first error: a tenth of that
    assert tried[0] == 1.0


def test_search_starts_at_the_error_of_a_similar_case() -> None:
    for limit, most in ((11.3, 6), (0.3, 9), (90.0, 8)):
        tried: list[float] = []

        def grade(error: float, tried: list[float] = tried, limit: float = limit) -> Grade:
            tried.append(error)
            return FAIL if error > limit else PASS

        bound = find_first_change(grade, lambda found: found.passes, 1.0, 100.0, start=9.0)
        assert tried[0] == 9.0
        assert bound.passed <= limit < bound.noticed <= bound.passed + 0.1 * max(bound.noticed, 1.0)
        assert len(tried) <= most


def test_uplift_forces_follow_a_parabola_through_the_nearest_errors() -> None:
    (case_twin,) = (case for case in select_cases(["en50318-2018/ac-simple/320-twin"]) if not case.is_static)
    stated = [lift.stated_uplift_force for lift in case_twin.lift_forces]
    forces = {error: tuple(f + 2 * error + 0.5 * error**2 for f in stated) for error in (1.0, 2.0, 50.0)}
    known = {error: PASS._replace(uplift_forces=force) for error, force in forces.items()} | {3.0: PASS}
    assert predict_forces(case_twin, known, 4.0) == pytest.approx([f + 16.0 for f in stated])


def test_larger_error_that_passes_again_does_not_hide_the_first_change() -> None:
    """Failing from 5 to 20 %: the outward steps 1, 2, 4, 8 meet it, although 32 to 100 % pass."""
    bound, tried = search((5.0, 20.0))
    assert bound.passed <= 5.0 < bound.noticed
    assert max(tried) == 8.0


def test_verdict_that_never_changes_has_the_largest_tried_error() -> None:
    bound, tried = search((1e9, 1e9), largest=90.0)
    assert bound == ErrorBound(passed=90.0)
    assert tried == [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 90.0]


def test_impossible_simulation_is_not_a_noticed_error() -> None:
    def grade(error: float) -> Grade:
        if error > 5.0:
            raise NotApplicable("no simulation: the wires cross")
        return PASS

    bound = find_first_change(grade, lambda found: found.passes, 1.0, 100.0)
    assert bound == ErrorBound(passed=4.0, by="no simulation: the wires cross")
    with pytest.raises(NotApplicable):
        find_first_change(grade, lambda found: found.passes, 8.0, 100.0)


@pytest.mark.parametrize(
    ("criteria", "verification", "both", "alone"),
    [
        ("pass", "pass", True, True),
        ("info", "pass", True, True),
        ("pass", "info", True, True),
        ("pass", "fail", False, True),
        ("fail", "pass", False, False),
        ("unconfirmed", "unconfirmed", False, False),
        ("error", "error", False, False),
        ("skip", "pass", False, False),
    ],
)
def test_record_passes_by_both_verdicts_or_by_the_criteria(
    criteria: str, verification: str, both: bool, alone: bool
) -> None:
    grade = Grade(criteria, verification, "")
    assert (grade.passes, grade.passes_criteria) == (both, alone)


def test_changes_of_an_input_follow_from_the_case(case_250: Case) -> None:
    (tension,) = list_changes(case_250, INPUTS["tension of the contact wire"], -10.0)
    assert (tension.key, tension.value) == ("line.contact_wire.tension_N", pytest.approx(18e3))
    (head,) = list_changes(case_250, INPUTS["mass of the head"], 5.0)
    assert (head.key, head.value) == ("pantograph.chain.masses_kg[2]", pytest.approx(7.56))
    (height,) = list_changes(case_250, INPUTS["height of the wire at the middle dropper"], 3.0)
    assert (height.key, height.value) == ("line.droppers.presag_m[5]", pytest.approx(0.003))
    assert len(list_changes(case_250, INPUTS["damping of the line, all coefficients"], 1.0)) == 8
    (twin,) = (case for case in select_cases(["en50318-2018/ac-simple/320-twin"]) if not case.is_static)
    (middle,) = list_changes(twin, INPUTS["mass between frame and head"], 10.0)
    assert (middle.key, middle.value) == ("pantograph.chain.masses_kg[2]", pytest.approx(9.9))
    assert [change.key for change in list_changes(twin, INPUTS["spacing of the pantographs"], 1.0)] == ["spacing_m[1]"]


@pytest.mark.parametrize(
    ("name", "error", "reason"),
    [
        ("mass between frame and head", 1.0, "does not state"),
        ("pre-sag", 1.0, "value of the case is zero"),
        ("moving mass of the steady arm", -0.1, "cannot be below 0 kg"),
        ("encumbrance", -60.0, "no simulation: the wires cross"),
    ],
)
def test_error_that_a_case_does_not_support_has_a_reason(case_250: Case, name: str, error: float, reason: str) -> None:
    with pytest.raises(NotApplicable, match=reason):
        grade_error(case_250, INPUTS[name], error)
    with pytest.raises(NotApplicable, match="has this setting"):
        vary_choice(case_250, Choice(name="same", group="supports", settings={"line.steady_arm.static_share": "level"}))


def test_wrong_input_is_graded_as_a_record_of_the_case(case_250: Case) -> None:
    """Own inputs pass; 4 % more tension fails the verification alone; 6 % more frame mass is a contradiction."""
    assert grade_error(case_250, INPUTS["tension of the contact wire"], 0.0)[:3] == PASS[:3]
    tension = grade_error(case_250, INPUTS["tension of the contact wire"], 4.0)
    assert (tension.passes, tension.passes_criteria) == (False, True)
    frame = grade_error(case_250, INPUTS["mass of the frame"], 6.0)
    assert (frame.criteria, frame.reason) == ("error", "record contradicted")
    # The record states speed and section of the case, so that its samples must reveal another span length.
    assert grade_error(case_250, INPUTS["span length"], 1.0).passes_criteria is False


def test_bounds_of_an_input_both_ways(case_250: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """+12.5 % fails the criteria, +3.5 % and -2 % the verification; each error is simulated once."""
    tried: list[float] = []

    def grade(case: Case, item: object, error: float, start: object) -> Grade:
        tried.append(error)
        if error > 12.5:
            return Grade("fail", "fail", "std_force_N (criteria), max_force_N (verification)")
        return FAIL if error > 3.5 or error < -2.0 else PASS

    monkeypatch.setattr(resolving_power, "grade_error", grade)
    bounds = measure_input(case_250, INPUTS["mass of the head"])
    assert bounds.up.passed <= 3.5 < bounds.up.noticed
    assert bounds.down.passed <= 2.0 < bounds.down.noticed
    assert bounds.up_criteria.passed <= 12.5 < bounds.up_criteria.noticed
    assert bounds.up_criteria.by == "std_force_N (criteria)"
    assert bounds.down_criteria == ErrorBound(passed=90.0)
    assert len(tried) == len(set(tried))


def test_interrupted_file_is_continued(case_250: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, items = tmp_path / "power.toml", list(INPUTS.values())[:3]
    monkeypatch.setattr(resolving_power, "grade_error", lambda case, item, error, start: FAIL if error > 3.3 else PASS)
    complete_file(case_250, path, 1e9, items[:1])
    first = read_study(path, ResolvingPowerFile)
    assert [bounds.name for bounds in first.input] == [items[0].name]
    monkeypatch.setattr(resolving_power, "grade_error", lambda case, item, error, start: PASS)
    complete_file(case_250, path, 1e9, items)
    second = read_study(path, ResolvingPowerFile)
    assert second.input[0] == first.input[0]
    assert second.input[2].up == ErrorBound(passed=100.0)
    path.write_text(path.read_text().replace(case_250.digest, "sha256:0"))
    complete_file(case_250, path, 1e9, items[:1])
    assert read_study(path, ResolvingPowerFile).input[0].up == ErrorBound(passed=100.0)
    complete_file(case_250, path, 0.0, items)  # no processor time left
    assert len(read_study(path, ResolvingPowerFile).input) == 1


def test_stored_bound_is_repeated(case_250: Case, tmp_path: Path) -> None:
    """Ends of a stored bracket: the same verdicts, because the simulator is deterministic."""
    stored = {bounds.name: bounds for bounds in find_resolving_power(case_250.id).input}
    assert stored.keys() == INPUTS.keys()
    for name in ("mass of the head", "contact stiffness"):
        bound = stored[name].up
        assert grade_error(case_250, INPUTS[name], bound.passed).passes
        assert not grade_error(case_250, INPUTS[name], bound.noticed).passes
    path = tmp_path / "file.toml"
    path.write_text(write_file(case_250, list(stored.values()), 1.0))
    assert read_study(path, ResolvingPowerFile).input == tuple(stored.values())


def test_bound_by_the_criteria_names_their_quantities() -> None:
    bound = ErrorBound(passed=1.0, noticed=2.0, by="std_force_N (criteria), rms_0_5_N (verification)")
    assert name_criteria(bound).by == "std_force_N (criteria)"
