"""Documented readings of the evaluation: a value that changes side between them is marked, and can be recomputed."""

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from helpers.criterion_fixtures import build_requirement
from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.case_conformity import count_passing_starts, find_case_conformity
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.pages.certificate_page import build_certificate, build_summary
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.quantities.evaluation import Evaluation
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.case_facts_format import ReadingFacts
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.system import Delivered

READING = {
    "id": "order-4-twice",
    "trust": "provisional",
    "source": "own test",
    "filter": {"order": 8, "attenuation_dB": 6, "bands": "band-pass"},
}
SECTION = {"id": "one-span", "evaluated_m": [240.0, 300.0]}
EDGE_N = 32.0
"""Amplitude at 20 Hz: half of its power passes by the default filter, a quarter by the other one."""


class Edge(Wave):
    """Sine per span, and one at 20 Hz, without a contact height that would refute it."""

    def run(self, case: Case) -> Delivered:
        return Delivered(self.record(case))

    def record(self, case: Case) -> Record:
        record = super().record(case)
        force = record.force + EDGE_N * np.sin(2 * np.pi * 20 * record.time)
        return replace(record, force=force, contact_height=None)


@pytest.fixture
def case(edited_case: EditedCase) -> Case:
    return load_case(edited_case("250.toml", {"id": "own/250", "reading": [READING, SECTION]}))


@pytest.fixture
def results(case: Case) -> Results:
    return run_cases([case], Edge())


def test_value_that_changes_side_is_marked(results: Results) -> None:
    """28 N and half or a quarter of the power of 32 N / sqrt(2); the section holds no whole periods: 2 %."""
    [result] = results.cases
    [std] = [row for row in result.criteria if row.quantity == "std_force_N"]
    other = result.readings[0].quantities["1"]["std_force_N"]
    assert (std.verdict, std.value) == ("fail", pytest.approx(np.sqrt(28**2 + EDGE_N**2 / 4), rel=0.02))
    assert other == pytest.approx(np.sqrt(28**2 + EDGE_N**2 / 8), rel=0.02)
    assert std.readings == [f"under the reading 'order-4-twice' the value is {other:.4g} N, inside the limits"]
    assert std.depends_on_reading
    assert result.readings[1].evaluated_m == (240.0, 300.0)
    assert result.readings[1].filter == result.run.filter
    assert result.readings[1].quantities["1"]["mean_force_N"] == pytest.approx(119.0, rel=0.01)
    assert Results.model_validate(json.loads(results.to_json())) == results


def make_row(quantity: str = "std_force_N", **changes: Any) -> Criterion:
    """Criterion of pantograph 1 that passes."""
    requirement = build_requirement(quantity, None, changes.pop("upper"), pantograph=1)
    facts = {"verdict": "pass", "margin": None, "discretisation_error": None, "reason": None}
    return Criterion.model_validate(requirement.model_dump() | facts | changes)


def test_probability_under_a_reading_is_that_of_the_shifted_sample() -> None:
    """Draws 9, 10, 11 and 12 below 11.5; the reading adds 1: two of four. A value without draws is in or out."""
    rows = [
        make_row(value=10.5, upper=11.5, draws=[9.0, 10.0, 11.0, 12.0]),
        make_row(quantity="max_force_N", value=150.0, upper=160.0),
    ]
    base: dict[str, Any] = {"trust": "provisional", "source": "", "filter": Filter(), "evaluated_m": (0.0, 1.0)}
    shifted = ReadingFacts(id="a", quantities={"1": {"std_force_N": 11.5}}, **base)
    outside = ReadingFacts(id="b", quantities={"1": {"max_force_N": 161.0}}, **base)
    unread = ReadingFacts(id="c", quantities={}, reason="filtered", **base)
    found = find_case_conformity(rows, (0, 0), [shifted, outside, unread])
    assert found is not None
    assert (found.probability, found.readings) == (0.75, {"a": 0.5, "b": 0.0})


def test_start_without_a_counted_value_or_with_one_outside_does_not_pass() -> None:
    """Values 10.5, 11.5 (on the limit), 12 and none under a limit of 11.5; a row without a verdict does not count."""
    rows = [make_row(value=10.5, upper=11.5), make_row("max_force_N", value=170.0, upper=160.0, verdict="info")]
    starts = [Evaluation({1: {"max_force_N": 170.0} | values}, {}) for values in (
        {"std_force_N": 10.5}, {"std_force_N": 11.5}, {"std_force_N": 12.0}, {}
    )]  # fmt: skip
    run = SimpleNamespace(evaluation=starts[0], start_evaluations=starts[1:])
    assert count_passing_starts(run, rows) == (4, 2)  # type: ignore[arg-type]
    run.start_evaluations = []
    assert count_passing_starts(run, rows) == (0, 0)  # type: ignore[arg-type]


def test_filter_of_a_reading_keeps_the_other_keys_of_the_case(edited_case: EditedCase) -> None:
    """An odd order is valid because the case has a causal filter."""
    own = {"order": 4, "cutoff_Hz": 25.0, "phase": "causal"}
    read = {**READING, "filter": {"order": 5}}
    case = load_case(edited_case("250.toml", {"id": "own/250", "filter": own, "reading": [read, SECTION]}))
    changed, kept = (case.with_reading(reading).file.filter for reading in case.file.reading)
    assert (changed.order, changed.cutoff_Hz, changed.phase) == (5, 25.0, "causal")
    assert kept == case.file.filter


def test_page_one_and_summary_name_the_reading(results: Results) -> None:
    texts = [render_html(build_certificate(results)), render_markdown(build_summary(results))]
    number = sum(row.depends_on_reading for row in results.cases[0].criteria)
    for text in texts:
        assert re.search(
            rf"{number} values? lies? on the other side of a limit under another documented reading of the evaluation",
            text,
        )
        assert "Another documented reading or contact reverses the verdict" in text
        assert "under the reading" in text


def test_marks_and_values_are_recomputed(results: Results) -> None:
    assert find_discrepancies(results) == []

    def tampered(change: Any) -> list[str]:
        tree = json.loads(results.to_json())
        change(tree["cases"][0])
        return find_discrepancies(Results.model_validate(tree))

    assert any("remarks on readings" in text for text in tampered(lambda case: case.pop("readings")))
    assert any(
        "remarks on readings" in text
        for text in tampered(lambda case: [row.pop("readings", 0) for row in case["criteria"]])
    )
    changed = tampered(lambda case: case["readings"][0]["quantities"]["1"].update(statistical_max_N=1.0))
    assert any("reading 'order-4-twice', pantograph 1: statistical_max_N" in text for text in changed)


def test_reading_is_no_input_of_the_run(case: Case) -> None:
    """Converged values, records and baselines are those of a case, whichever readings it documents."""
    assert case.digest == replace(case, file=case.file.model_copy(update={"reading": ()})).digest
    assert {entry.group for entry in case.inputs} >= {"reading 'order-4-twice'", "reading 'one-span'"}


def test_filter_before_delivery_cannot_be_replaced(case: Case) -> None:
    filtered = Delivered(replace(Edge().record(case), filter_applied_Hz=20.0))
    result = grade_case(case, filtered, "secondary")
    assert result.readings[0].quantities == {}
    assert "filtered at 20 Hz before delivery" in str(result.readings[0].reason)
    assert result.readings[1].reason is None
    assert not any(row.depends_on_reading for row in result.criteria if "one-span" not in str(row.readings))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"reading": [{**READING, "filter": {"order": 5}}]}, "key reading[1].filter.order: 5 is odd"),
        ({"reading": [{**READING, "filter": {"attenuation_dB": 4}}]}, "attenuation_dB: found 4, expected 3 or 6"),
        ({"reading": [{**READING, "bands": "both"}]}, "key reading[1].bands: unknown key"),
        ({"reading": [{"id": "nothing"}]}, "key reading[1].filter: missing"),
        ({"reading": [{**READING, "id": "default"}]}, "'default' is the reading of the case itself"),
        ({"reading": [READING, READING]}, "key reading[2].id: 'order-4-twice' is the name of two readings"),
        ({"reading": [{**SECTION, "evaluated_m": [300.0, 240.0]}]}, "the end 240 m is not greater than the start 300"),
    ],
)  # fmt: skip
def test_wrong_reading_is_refused(edited_case: EditedCase, changes: dict[str, Any], message: str) -> None:
    done = pantocheck("readings", edited_case("250.toml", changes), COLUMNS="400")
    assert done.exit_code == 2
    assert message in done.stderr
    assert "case '250.toml'" in done.stderr


def test_command_prints_one_table_at_80_columns(case: Case, edited_case: EditedCase, tmp_path: Path) -> None:
    edited_case("250.toml", {"id": "own/250", "reading": [READING]})
    sidecar = write_record(tmp_path / "run.csv", Edge().record(case), "own/250")
    done = pantocheck("readings", tmp_path / "run.csv", "--cases", tmp_path, COLUMNS="80")
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    [std] = [line for line in lines if line.startswith("std_force_N") and "26 to 31" in line]
    assert re.search(r"FAIL .* PASS reading *$", std)
    assert any(line.startswith("  against std_force_N") and line.count("%") == 2 for line in lines)
    assert "Not evaluated" not in done.stdout
    tree = json.loads(pantocheck("readings", sidecar, "--cases", tmp_path, "--json").stdout)["result"]
    assert [reading["id"] for reading in tree["readings"]] == ["order-4-twice"]
    edit_toml(sidecar, {"case": None})
    done = pantocheck("readings", sidecar)
    assert (done.exit_code, "key case: names no case" in done.stderr) == (2, True)


def test_record_repeats_the_values_of_every_reading(case: Case, tmp_path: Path) -> None:
    write_record(tmp_path / "records" / "run.csv", Edge().record(case), "own/250")
    out = tmp_path / "out" / "results.json"
    options = ("--cases", tmp_path, "--system", f"record:{tmp_path / 'records'}", "--out", out.parent)
    pantocheck("run", "own/250", *options, "--formats", "json", "--verdicts", "criteria")
    verify = ("verify", out, "--record", tmp_path / "records" / "run.csv", "--cases", tmp_path, "--any-verdict")
    assert pantocheck(*verify).exit_code == 0
    tree = json.loads(out.read_text())
    assert [reading["id"] for reading in tree["cases"][0]["readings"]] == ["order-4-twice", "one-span"]
    tree["cases"][0]["readings"][1]["quantities"]["1"]["rms_20_50_N"] += 0.5
    out.write_text(json.dumps(tree, indent=1))
    done = pantocheck(*verify, COLUMNS="400")
    assert (done.exit_code, "under the reading one-span, rms_20_50_N" in done.stdout) == (1, True)
