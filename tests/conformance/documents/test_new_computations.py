"""Checks by new computations: quantities of a record, and a new run of the built-in simulator."""

from pathlib import Path
from typing import Any

import pytest

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents import repetition_check
from pantocheck.conformance.documents.authenticity_check import compare_numbers
from pantocheck.conformance.documents.repetition_check import check_record_quantities, check_rerun
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import Results, SystemIdentity
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator


@pytest.fixture
def record_file(case_250: Case, tmp_path: Path) -> Path:
    """Record of the wave at 250 km/h with all its digits."""
    folder = tmp_path / "records"
    folder.mkdir()
    record = Wave().record(case_250)
    write_record(folder / "wave.h5", record, case=case_250.id, system={"name": "wave", "version": "1"}, run={})
    return folder / "wave.h5"


@pytest.fixture(scope="module")
def static_results() -> Results:
    """Built-in run of a line at rest, which takes a second."""
    case = load_case(library_folder() / "en50318-2018" / "ac-simple" / "static.toml")
    return run_cases([case], ReferenceSimulator())


def change_quantity(results: Results, name: str, factor: float) -> Results:
    content = results.to_dict()
    values = content["cases"][0]["quantities"]
    owner = next(owner for owner in values if name in values[owner])
    values[owner][name] *= factor
    return Results.model_validate(content)


ROW_CHANGES = (
    ("coincidence", lambda row: row["basis"].update(number=row["basis"]["number"] + 1e-5), "stated"),
    ("support passing", lambda row: row["basis"]["thresholds"].update(contradiction=9.0), "contradiction beyond 9"),
    ("motion", lambda row: row.update(outcome="doubt"), "outcome 'doubt' stated, 'confirmed' computed"),
    ("copy", lambda row: row["basis"].update(cause="holds"), "'holds' stated, 'does not apply' follows"),
)
"""Changes of a row, none of which another number of the results shows; 1e-5 is ten times the tolerance."""


def test_quantities_follow_from_the_graded_record_and_no_other(case_250: Case, record_file: Path) -> None:
    results = run_cases([case_250], open_record_folder(record_file.parent))
    quantities, digest = check_record_quantities(results, record_file)
    assert (quantities.outcome, digest.outcome) == ("proved", "proved")
    assert "largest relative difference 0.0e+00" in quantities.statement
    assert "wave.h5 is the graded record" in digest.statement
    content = results.to_dict()
    content["cases"][0]["record"]["state"] = "contradicted"
    changed, _ = check_record_quantities(Results.model_validate(content), record_file)
    assert "state of the record 'contradicted' stated" in changed.details[0]
    for name, change, text in ROW_CHANGES:
        content = results.to_dict()
        row = next(row for row in content["cases"][0]["record"]["checks"] if row["check"] == name)
        change(row)
        changed, _ = check_record_quantities(Results.model_validate(content), record_file)
        assert len(changed.details) == 1
        assert changed.details[0].startswith(f"check '{name}': ")
        assert text in changed.details[0]
    other = Wave(mean=118.0).record(case_250)
    write_record(record_file, other, case=case_250.id, system={"name": "wave", "version": "1"}, run={})
    quantities, digest = check_record_quantities(results, record_file)
    assert (quantities.outcome, digest.outcome) == ("contradicted", "contradicted")


@pytest.mark.parametrize("name", ["mean_force_N", "rms_20_50_N", "contact_height_range_mm", "max_uplift_at_support_mm"])
def test_another_quantity_contradicts_the_record(case_250: Case, record_file: Path, name: str) -> None:
    """1e-5 is ten times the tolerance, and far below the printed digits."""
    results = change_quantity(run_cases([case_250], open_record_folder(record_file.parent)), name, 1 + 1e-5)
    quantities, _ = check_record_quantities(results, record_file)
    assert quantities.outcome == "contradicted"
    assert len(quantities.details) == 1
    assert name in quantities.details[0]


def test_record_or_simulator_of_another_document_is_refused(
    case_250: Case, record_file: Path, wave_results: Results
) -> None:
    case = wave_results.cases[0].model_copy(update={"id": "en50318-2002/300"})
    other = wave_results.model_copy(update={"cases": [case]})
    with pytest.raises(InputError, match="which the document does not grade"):
        check_record_quantities(other, record_file)
    with pytest.raises(InputError, match="'wave' is not the built-in simulator"):
        check_rerun(wave_results)


def test_rerun_repeats_every_number(static_results: Results) -> None:
    """The same processor and packages give the same bits."""
    [check] = check_rerun(static_results)
    assert check.outcome == "proved"
    assert "bit for bit" in check.statement


@pytest.fixture
def remembered_run(static_results: Results, monkeypatch: pytest.MonkeyPatch) -> None:
    """Gives the run of the results instead of a new one, which has the same bits by the test above."""
    monkeypatch.setattr(repetition_check, "run_case", lambda *_: static_results.cases[0])


@pytest.mark.usefixtures("remembered_run")
def test_rerun_finds_a_change_of_one_bit(static_results: Results) -> None:
    [changed] = check_rerun(change_quantity(static_results, "elasticity_mm_N", 1 + 1e-12))
    assert changed.outcome == "contradicted"
    assert "quantities, 0, elasticity_mm_N" in changed.details[0]
    content = static_results.to_dict()
    curve = content["cases"][0]["line_shape"]["side"]["points"]
    for point in curve:
        point["y_m"] += 0.001
    [many] = check_rerun(Results.model_validate(content))
    assert len(curve) > len(many.details) == 10


@pytest.mark.parametrize("place", ["draw", "passing_starts"])
def test_rerun_contradicts_a_forged_probability(
    wave_results: Results, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A draw moved inside the limits, or a start said to pass, raises the probability of conformity."""
    run = wave_results.cases[0]
    monkeypatch.setattr(repetition_check, "run_case", lambda *_: run)
    builtin = ReferenceSimulator()
    system = SystemIdentity(name=builtin.name, version=builtin.version, kind=builtin.kind)
    stated = wave_results.model_copy(update={"system": system, "cases": [run]})
    [genuine], [forged] = check_rerun(stated), check_rerun(forge_probability(stated, place))
    assert (genuine.outcome, forged.outcome) == ("proved", "contradicted")
    name = "joint sample, mean_force_N of pantograph 1, value 1" if place == "draw" else "conformity, starts that pass"
    assert name in " ".join(forged.details)


@pytest.mark.parametrize("place", ["draw", "passing_starts"])
def test_forged_probability_contradicts_the_record(case_250: Case, record_file: Path, place: str) -> None:
    results = run_cases([case_250], open_record_folder(record_file.parent))
    quantities, _ = check_record_quantities(forge_probability(results, place), record_file)
    assert quantities.outcome == "contradicted"
    assert all(text.startswith(("joint sample", "conformity")) for text in quantities.details)


def forge_probability(results: Results, place: str) -> Results:
    """Results with another first draw of the mean force, or with one more start that passes."""
    content = results.to_dict()
    case = content["cases"][0]
    if place == "draw":
        case["criteria"][0]["draws"][0] += 0.5
    else:
        case["conformity"]["starts"] += 1
        case["conformity"]["passing_starts"] += 1
    return Results.model_validate(content)


@pytest.mark.parametrize("key", ["machine", "core"])
@pytest.mark.usefixtures("remembered_run")
def test_rerun_elsewhere_is_compared_within_rounding(static_results: Results, key: str) -> None:
    platform = static_results.platform.model_copy(update={key: "another"})
    elsewhere = change_quantity(static_results.model_copy(update={"platform": platform}), "elasticity_mm_N", 1 + 1e-8)
    [near], [far] = check_rerun(elsewhere), check_rerun(change_quantity(elsewhere, "elasticity_mm_N", 1 + 1e-5))
    assert (near.outcome, far.outcome) == ("proved", "contradicted")
    content = static_results.to_dict()
    content["cases"][0]["line_shape"]["side"]["points"][0]["y_m"] += 0.001
    [changed] = check_rerun(Results.model_validate(content))
    assert changed.outcome == "contradicted"
    assert "line_shape" in " ".join(changed.details)
    del content["cases"][0]["line_shape"]
    [stripped] = check_rerun(Results.model_validate(content))
    assert stripped.outcome == "contradicted"


@pytest.mark.parametrize(
    ("stated", "computed", "tolerance", "different"),
    [
        ({"a": 1.0}, {"a": 1.0}, 0.0, 0),
        ({"a": 1.0}, {"a": 1.0 + 1e-15}, 0.0, 1),
        ({"a": 1.0}, {"a": 1.0 + 1e-9}, 1e-6, 0),
        ({"a": 1.0}, {"a": 1.0 + 1e-5}, 1e-6, 1),
        ({"a": [1e-9, 100.0]}, {"a": [2e-9, 100.0]}, 1e-6, 0),  # relative to the largest number of the list
        ({"a": [100.0, 1e-9]}, {"a": [100.0, 2e-9]}, 1e-6, 0),
        ({"a": 1.5e-6}, {"a": 0.0}, 1e-6, 1),  # relative to one
        ({"a": [1.0]}, {"a": [1.0, 2.0]}, 1e-6, 2),  # the number of values, and the second one
        ({"a": 1.0}, {"b": 1.0}, 1e-6, 2),
        ({"a": "x"}, {"a": "y"}, 1e-6, 1),
        ({"a": None}, {"a": 1.0}, 1e-6, 1),
        ({"a": float("nan")}, {"a": 1.0}, 1e-6, 1),
    ],
)
def test_numbers_are_compared_relative_to_their_scale(
    stated: Any, computed: Any, tolerance: float, different: int
) -> None:
    assert len(compare_numbers(stated, computed, tolerance).differences) == different
