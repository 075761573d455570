"""`pantocheck compare`: records, results and systems side by side; two pantographs."""

import csv
import json
import tomllib
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from jsonschema import validate

from helpers.command_line import pantocheck
from helpers.wave_system import SIGMA, Wave
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.comparison.compared_run import ComparedRun, simulate_run
from pantocheck.conformance.comparison.run_comparison import compare_subjects
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.pages.run_comparison_page import format_compared
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.comparison_format import ComparedQuantity


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, two_pantograph_case: Case) -> Path:
    """Working folder with two records of two pantographs, and results of both systems."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    case = two_pantograph_case
    for name, sigma in (("first", SIGMA), ("other", 1.1 * SIGMA)):
        system = Wave(sigma=sigma, name=name)
        facts = {"line": {"span_m": 60.0}}
        write_record(
            Path(f"{name}.csv"), system.record(case), case=case.id, system={"name": name, "version": "1"}, further=facts
        )
        Path(name).mkdir()
        (Path(name) / "results.json").write_bytes(run_cases([case], system).to_json())
    return tmp_path


run = partial(pantocheck, "compare")


def read(folder: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((folder / "out" / "comparison.json").read_text())
    validate(content, build_schema("comparison"))
    return content


def select_quantity(content: dict[str, Any], owner: int, name: str) -> dict[str, Any]:
    return next(row for row in content["cases"][0]["owners"][owner]["quantities"] if row["name"] == name)


def test_record_without_an_analysis_section_is_named_with_the_reason(folder: Path) -> None:
    path = folder / "other.toml"
    content = tomllib.loads(path.read_text())
    del content["evaluated_m"]
    path.write_text(tomli_w.dumps(content))
    done = run("first.csv", "other.csv", "--out", "out")
    assert done.exit_code == 0, done.output
    (note,) = read(folder)["cases"][0]["notes"]
    assert note == "other has no quantities: the analysis section is not stated: add evaluated_m to the sidecar."
    assert note in " ".join(done.output.split())
    assert note in (folder / "out" / "comparison.html").read_text()


@pytest.mark.usefixtures("fresh_figures")
def test_two_records_are_compared_for_both_pantographs(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A repeated comparison writes the same bytes."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    done = run("first.csv", "other.csv", "--out", "out")
    assert done.exit_code == 0, done.output
    assert done.output.count("std_force_N") == 2
    content = read(folder)
    assert [subject["name"] for subject in content["subjects"]] == ["first", "other"]
    assert [owner["number"] for owner in content["cases"][0]["owners"]] == [0, 1, 2]
    for owner in (1, 2):
        std = select_quantity(content, owner, "std_force_N")
        assert std["difference"][1] == pytest.approx(0.1 * SIGMA, rel=1e-3)  # the ripple of 0.05 N at 40 Hz
        (agreement,) = content["cases"][0]["owners"][owner]["agreements"]
        # Both forces have one sine per span at 1.16 Hz; the second has 10 % more.
        assert agreement["correlation"] == pytest.approx(1, abs=1e-6)
        assert agreement["bands"][0]["difference_N"] == pytest.approx(0.1 * SIGMA, rel=2e-3)
        assert [span["start_m"] for span in agreement["spans"]] == [240.0, 300.0]
        wide = [chart["wide"] for chart in content["cases"][0]["owners"][owner]["charts"]]
        assert wide == [True, True, False, False, False, False]  # curves along the track have the whole width
    for name in ("comparison.html", "comparison.pdf"):
        assert (folder / "out" / name).stat().st_size > 10_000
    # The table of values has all quantities of both subjects.
    with (folder / "out" / "comparison.csv").open() as file:
        rows = list(csv.DictReader(file))
    subjects = {row["subject"] for row in rows if row["quantity"] == "std_force_N" and row["pantograph"] == "2"}
    assert subjects == {"first", "other"}
    assert run("first.csv", "other.csv", "--out", "again").exit_code == 0
    once, twice = ([path.read_bytes() for path in sorted((folder / out).iterdir())] for out in ("out", "again"))
    assert once == twice


def test_results_are_compared_by_their_case(folder: Path) -> None:
    """Results hold thinned curves: they are drawn, and differences of the force need the record."""
    done = run("first", "other/results.json", "first.csv", "--out", "out")
    assert done.exit_code == 0, done.output
    content = read(folder)
    std = select_quantity(content, 1, "std_force_N")
    assert std["difference"][1:] == pytest.approx([0.1 * SIGMA, 0], abs=2e-3)
    owner = content["cases"][0]["owners"][1]
    assert owner["agreements"] == []
    assert owner["reasons"][0].startswith("first 1: results hold thinned curves")
    assert [len(chart["series"]) for chart in owner["charts"]] == [3, 3]


@pytest.mark.usefixtures("folder")
def test_message_names_the_fault() -> None:
    for arguments, message in (
        (["first.csv"], "names one subject only"),
        (["first.csv", "builtin"], "names a system, but no case"),
        (["first.csv", "missing.csv"], "missing.csv"),
        (["first", "other", "--case", "en50318-2002/300"], "no common case: en50318-2002/250"),
    ):
        done = run(*arguments)
        assert done.exit_code == 2
        assert message in " ".join(done.output.split())


def test_a_difference_beyond_the_uncertainty_is_marked() -> None:
    quantity = ComparedQuantity(
        name="std_force_N", values=(28.0, 31.0, (1.0, 2.0), None), uncertainty=(0.5, 0.0, None, None),
        difference=(0.0, 3.0, -0.5, None), beyond_uncertainty=(False, True, None, None),
    )  # fmt: skip
    texts = [format_compared(quantity, i) for i in range(4)]
    assert texts == ["28.00 ± 0.50", "31.00 (+3 *)", "2 values (−0.5)", "–"]


def build_run(case: str, values: dict[str, float], width: float) -> ComparedRun:
    return ComparedRun("results", case, "results", "", case, None, {1: values}, {1: dict.fromkeys(values, width)})


def test_a_record_belongs_to_the_case_that_it_states() -> None:
    results = [build_run(case, {"std_force_N": value}, 1.0) for case, value in (("a", 30.0), ("b", 40.0))]
    record = replace(build_run("b", {"std_force_N": 41.0}, 1.0), kind="record")
    (case,) = compare_subjects([results, [record]], None).cases
    assert (case.id, case.owners[0].quantities[0].difference) == ("b", (0.0, 1.0))
    with pytest.raises(InputError, match="no common case"):
        compare_subjects([results, [replace(record, case="")]], None)


def test_a_simulation_has_the_signals_of_its_record(two_pantograph_case: Case) -> None:
    simulated = simulate_run(two_pantograph_case, Wave())
    assert sorted(simulated.signals) == [1, 2]
    assert np.std(simulated.signals[2].delivered) == pytest.approx(SIGMA, rel=1e-3)
