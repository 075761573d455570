"""Baseline: a drifted value fails even within its limits, and a missing value is skipped."""

import json
import math
import re
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from pydantic import ValidationError
from rich.console import Console

from helpers.command_line import pantocheck
from helpers.shown_page import shown_certificate
from helpers.toml_edit import change_keys, write_toml
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.baseline import compare_with_baseline, read_baseline
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.pages.certificate_page import build_summary
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.quantity_tables import render_quantity_list
from pantocheck.conformance.pages.two_verdicts import summarise_verdict
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.results.case_facts_format import BaselineComparison
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.system_choice import choose_system

PASSING = "record:en50318-2002/known-passing-code"
CRITERIA = ("--verdicts", "criteria")


@pytest.fixture
def results() -> Results:
    """Published statistics that pass; the user accepts that they are unconfirmed."""
    system = choose_system(PASSING)
    accepted = Participation(accepted_unconfirmed=(system.name,))
    return run_cases(select_cases(["en50318-2002/*"]), system, participation=accepted)


def build_command(cases: str, out: Path, accepted: str, formats: str = "json") -> list[str | Path]:
    """Run on the published statistics, whose unconfirmed records the user accepts."""
    options = ["--system", PASSING, *CRITERIA, "--formats", formats, "--accept-unconfirmed", accepted]
    return ["run", f"en50318-2002/{cases}", *options, "--out", out]


@pytest.fixture
def drifted(results: Results) -> Results:
    """Comparison in which the standard deviation of the first case drifted from 27.0 N to 27.6 N, by more than 1 %."""
    return compare_with_baseline(results, changed(results, "std_force_N", 27.0), 1.0, "b.json")


def changed(results: Results, name: str, value: float | list[float]) -> Results:
    """Baseline in which one quantity of the first case had another value."""
    first = results.cases[0]
    quantities = {**first.quantities, "1": {**first.quantities["1"], name: value}}
    return results.model_copy(
        update={"cases": [first.model_copy(update={"quantities": quantities}), *results.cases[1:]]}
    )


def test_same_values_do_not_drift_and_results_round_trip(results: Results, tmp_path: Path) -> None:
    compared = compare_with_baseline(results, results, 0.1, "b.json")
    assert compared.verdict == "pass"
    assert [len(case.criteria) for case in compared.cases] == [8, 8]
    assert compared.cases[0].notes[-1].startswith("Compared with baseline b.json: 8 values, of which 0 drifted")
    (tmp_path / "r.json").write_bytes(results.to_json())
    assert read_results(tmp_path / "r.json") == results
    assert json.loads(results.to_json())["cases"][0]["criteria"][0]["baseline"] is None


def test_case_without_values_in_the_baseline_is_not_compared(results: Results) -> None:
    ended = results.cases[0].model_copy(update={"quantities": {}, "verdict": "error"})
    baseline = results.model_copy(update={"cases": [ended, *results.cases[1:]]})
    (row,) = (row for row in compare_with_baseline(results, baseline, 1.0, "b.json").cases[0].criteria if row.is_drift)
    assert (row.verdict, "has no values of this case: its verdict was error" in str(row.reason)) == ("skip", True)


@pytest.mark.parametrize(("was", "drifts"), [(0.230, False), (0.236, True)])
def test_ratio_drifts_relative_to_itself(results: Results, was: float, drifts: bool) -> None:
    """A ratio of 0.23 may drift by 2 % of itself, 0.0046, not by 2 % of 1."""
    now = changed(results, "cov_20", 0.230)
    compared = compare_with_baseline(now, changed(results, "cov_20", was), 2.0, "b.json")
    found = [row.quantity for row in compared.cases[0].criteria if row.baseline is not None]
    assert found == (["cov_20"] if drifts else [])


@pytest.mark.parametrize(("was", "drifts"), [(27.6 / 1.019, False), (27.6 / 1.021, True), (27.6 / 0.979, True)])
def test_value_that_drifts_fails_within_its_limits(results: Results, was: float, drifts: bool) -> None:
    compared = compare_with_baseline(results, changed(results, "std_force_N", was), 2.0, "b.json")
    assert compared.verdict == ("fail" if drifts else "pass")
    if drifts:
        (finding,) = (row for row in compared.cases[0].criteria if row.verdict == "fail")
        assert (finding.quantity, finding.value, finding.baseline) == ("std_force_N", 27.6, was)
        assert "% from the baseline of" in finding.reason
        # To a hundredth of the drift of 0.54 N: four decimals, not twelve.
        assert (finding.lower, finding.upper) == (round(0.98 * was, 4), round(1.02 * was, 4))
        assert find_discrepancies(compared) == []
        assert b'name="drift of std_force_N of pantograph 1"' in render_junit(compared)
        assert compared.cases[1].verdict == "unconfirmed"


@pytest.mark.parametrize(
    ("name", "was", "text"),
    [
        ("std_force_N", 24.0, "drifted by +15 % from the baseline of 24 N"),
        ("std_force_N", 30.0, "drifted by -8 % from the baseline of 30 N"),
        ("contact_loss_pct", 0.5, "drifted by -50 % from the baseline of 0.5 %"),
        ("min_force_N", -70.3, "drifted by +200 % from the baseline of -70.3 N"),
    ],
)
def test_drift_is_stated_with_its_sign(results: Results, name: str, was: float, text: str) -> None:
    """Per cent of the earlier value, or of one unit near zero: 27.6 N now, no contact loss, 70.3 N."""
    compared = compare_with_baseline(results, changed(results, name, was), 2.0, "b.json")
    (finding,) = (row for row in compared.cases[0].criteria if row.baseline is not None)
    assert finding.reason == text


@pytest.mark.parametrize(("was", "drifts"), [(0.0, False), (0.0099, False), (0.0101, True)])
def test_ratio_near_zero_drifts_by_a_hundredth(results: Results, was: float, drifts: bool) -> None:
    """A ratio of 0.02 may drift by 50 %: by 0.01 of itself, not by 0.5."""
    now = changed(results, "cov_20", 0.02)
    earlier = changed(results, "cov_20", 0.02 + was)
    found = compare_with_baseline(now, earlier, 50.0, "b.json").cases[0].criteria
    assert any(row.baseline is not None for row in found) is (was > 0.0199)
    tiny = compare_with_baseline(changed(results, "cov_20", was), changed(results, "cov_20", 0.0), 100.0, "b.json")
    assert any(row.baseline is not None for row in tiny.cases[0].criteria) is drifts


def test_drift_is_a_verdict_of_its_own(results: Results, drifted: Results) -> None:
    """All eight criteria pass; the accepted published record keeps them at a pass."""
    assert (drifted.verdict, drifted.criteria_verdict, drifted.baseline_verdict) == ("fail", "pass", "fail")
    case = drifted.cases[0]
    assert (case.verdict, case.criteria_verdict) == ("fail", results.cases[0].criteria_verdict)
    assert case.baseline == BaselineComparison(verdict="fail", name="b.json", drift_pct=1.0, values=8, drifted=1)
    assert (case.criteria[-1].trust, case.criteria[-1].source) == (None, "baseline b.json, allowed drift 1 %")
    assert drifted.scope == results.scope
    # Otherwise a limit without any source would count.
    content = results.to_dict()
    content["cases"][0]["criteria"][0]["trust"] = None
    with pytest.raises(ValidationError, match="a criterion without trust must compare with a baseline"):
        Results.model_validate(content)


def remove_row(case: dict[str, Any]) -> None:
    case["criteria"].pop()


FORGERIES: dict[str, Callable[[dict[str, Any]], None]] = {
    "row": remove_row,
    "row and number": lambda case: (remove_row(case), case["baseline"].update(drifted=0))[0],
    "comparison": lambda case: case.pop("baseline"),
    "row and comparison": lambda case: (remove_row(case), case.pop("baseline"))[0],
    "verdict of the case by the baseline": lambda case: case["baseline"].update(verdict="pass"),
    "verdict of the case": lambda case: case.update(verdict="unconfirmed"),
    "bounds": lambda case: case["criteria"][-1].update(upper=29.0, verdict="pass", margin=0.2),
    "accepted drift": lambda case: case["baseline"].update(drift_pct=5.0),
    "number": lambda case: case["baseline"].update(drifted=0),
    "drift among the criteria": lambda case: case["criteria"][-1].update(baseline=None, trust="provisional"),
}
"""Ways to hide one value that drifted."""


@pytest.mark.parametrize("forgery", FORGERIES)
def test_hidden_drift_is_found(drifted: Results, forgery: str) -> None:
    compared = drifted.to_dict()
    assert find_discrepancies(Results.model_validate(compared)) == []
    FORGERIES[forgery](compared["cases"][0])
    assert find_discrepancies(Results.model_validate(compared))


def test_hidden_verdict_or_comparison_of_the_run_is_found(drifted: Results) -> None:
    for verdict in ("pass", None):
        found = find_discrepancies(drifted.model_copy(update={"baseline_verdict": verdict}))
        assert any(text.startswith("baseline: ") for text in found)
    compared = drifted.to_dict()
    del compared["baseline_verdict"], compared["cases"][0]["baseline"], compared["cases"][1]["baseline"]
    found = find_discrepancies(Results.model_validate(compared))
    assert any("drift without a comparison with a baseline" in text for text in found)


def test_value_near_zero_drifts_by_its_unit(results: Results) -> None:
    """No contact loss in the baseline: 1 % of one percent is allowed."""
    lossy = changed(results, "contact_loss_pct", 0.02)
    assert compare_with_baseline(results, lossy, 1.0, "b").verdict == "fail"
    assert compare_with_baseline(results, lossy, 3.0, "b").verdict == "pass"


def test_value_or_case_that_one_side_lacks_is_skipped(results: Results) -> None:
    compared = compare_with_baseline(results, changed(results, "rms_20_50_N", 20.0), 1.0, "b.json")
    (finding,) = (row for row in compared.cases[0].criteria if row.verdict == "skip")
    assert finding.reason == "the baseline has 20 N; now: the summary does not state this quantity"
    assert compared.verdict == "skip"
    assert find_discrepancies(compared) == []
    other = results.model_copy(update={"cases": results.cases[:1]})
    compared = compare_with_baseline(results, other, 1.0, "b.json")
    assert compared.cases[0].verdict == "unconfirmed"
    lacking = compared.cases[1]
    assert (lacking.verdict, lacking.criteria[-1].reason) == ("skip", "baseline b.json has no case en50318-2002/300")
    assert compared.verdict == "skip"
    assert find_discrepancies(compared) == []
    case = replace(select_cases(["en50318-2002/250"])[0], limits=())
    unknown = replace(case, file=case.file.model_copy(update={"id": "none"}))
    skipped = run_cases([unknown], choose_system(PASSING))
    assert compare_with_baseline(skipped, results, 1.0, "b").verdict == "skip"


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        ({"input_digest": "sha256:0"}, "inputs"),
        ({"limits_digest": "sha256:0"}, "limits"),
        ({"limits_digest": None}, "limits"),
        ({"library": "modified"}, "texts or sources"),
        ({"input_digest": "sha256:0", "limits_digest": "sha256:0"}, "inputs, limits"),
    ],
)
def test_baseline_of_another_case_is_no_pass(results: Results, change: dict[str, Any], difference: str) -> None:
    """Every value is that of the baseline, and the user accepts published statistics: without the change, a pass."""
    first, second = results.cases
    other = results.model_copy(update={"cases": [first.model_copy(update=change), second]})
    compared = compare_with_baseline(results, other, 1.0, "b.json")
    finding = compared.cases[0].criteria[-1]
    assert (finding.quantity, finding.verdict) == ("baseline", "skip")
    assert finding.reason == f"baseline b.json has other {difference}; renew the baseline"
    assert [case.verdict for case in compared.cases] == ["skip", "unconfirmed"]
    assert compared.verdict == "skip"
    assert find_discrepancies(compared) == []


def test_changed_inputs_are_named(results: Results) -> None:
    first, second = results.cases
    inputs = [
        group.model_copy(update={"values": {**group.values, "speed_km_h": 251.0}}) if group.group == "case" else group
        for group in first.inputs
    ]
    change = {"input_digest": "sha256:0", "library": "modified", "inputs": inputs}
    other = results.model_copy(update={"cases": [first.model_copy(update=change), second]})
    reason = compare_with_baseline(results, other, 1.0, "b.json").cases[0].criteria[-1].reason
    assert reason == "baseline b.json has other inputs (speed_km_h), texts or sources; renew the baseline"


def test_case_without_values_is_no_pass_of_the_baseline(results: Results) -> None:
    """An interrupted case was not compared."""
    first, second = results.cases
    second = build_ungraded(select_cases([second.id])[0], "skip", "the run was interrupted")
    compared = compare_with_baseline(results.model_copy(update={"cases": [first, second]}), results, 1.0, "b.json")
    assert compared.cases[0].baseline == BaselineComparison(
        verdict="pass", name="b.json", drift_pct=1.0, values=8, drifted=0
    )
    assert compared.baseline_verdict == "skip"
    assert find_discrepancies(compared) == []
    text = render_markdown(build_summary(compared))
    assert "| Drift from the baseline | SKIP | decides the verdict | 1 of 1 case passes. 0 of 8 values drifted" in text
    assert "1 case was not compared." in text


def test_limits_of_the_user_are_not_those_of_the_baseline(results: Results, tmp_path: Path) -> None:
    base, limits = tmp_path / "b.json", tmp_path / "limits.toml"
    base.write_bytes(results.to_json())
    wide = {"quantity": "std_force_N", "pantograph": 1, "upper": 40.0, "trust": "primary", "source": "own"}
    write_toml(limits, {"limit": [wide]})
    command = build_command("250", tmp_path / "out", results.system.name)
    assert pantocheck(*command, "--baseline", base).exit_code == 0
    result = pantocheck(*command, "--baseline", base, "--limits", limits)
    assert result.exit_code == 1
    assert "has other limits" in result.output


def test_baseline_on_the_command_line_and_in_a_plan(results: Results, tmp_path: Path) -> None:
    base = tmp_path / "baseline.json"
    base.write_bytes(changed(results, "std_force_N", 27.0).to_json())
    command = build_command("*", tmp_path / "out", results.system.name, "json,badge")
    assert pantocheck(*command).exit_code == 0
    result = pantocheck(*command, "--baseline", base)
    assert result.exit_code == 1
    assert "drifted by +2.22 % from the baseline of 27 N" in result.output
    assert "fail" in (tmp_path / "out" / "badge.svg").read_text().lower()
    assert pantocheck(*command, "--baseline", base, "--drift", "3").exit_code == 0
    plan = tmp_path / "plan.toml"
    options = {"verdicts": "criteria", "formats": ["json"], "accept_unconfirmed": [results.system.name]}
    write_toml(plan, options | {"system": PASSING, "cases": ["en50318-2002/*"], "baseline": "baseline.json"})
    assert pantocheck("run", "--plan", plan, "--out", tmp_path / "p").exit_code == 1
    assert pantocheck("run", "--plan", plan, "--out", tmp_path / "p", "--drift", "3").exit_code == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is not valid JSON"),
        ('{"suite": ', "is not valid JSON"),
        ("[" * 100_000, "is not valid JSON"),
        ("{}", "key suite: field required"),
    ],
)
def test_file_that_is_no_results_is_rejected(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "b.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_results(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"cases.0.quantities.1.std_force_N": math.nan}, "finite"),
        ({"cases.0.quantities.1.std_force_N": 1e300}, "less than or equal to"),
        ({"cases.0.quantities.front": {"std_force_N": 27.6}}, "should match pattern"),
    ],
)
def test_wrong_baseline_is_rejected(results: Results, tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    content = results.to_dict()
    change_keys(content, changes)
    path = tmp_path / "b.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=message):
        read_results(path)


def test_baseline_is_read_before_anything_is_computed(tmp_path: Path) -> None:
    result = pantocheck("run", "--system", PASSING, "--baseline", tmp_path / "none.json", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "results 'none.json': cannot be read" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("value", [1e15, -1e13, [1.0] * 200_000])
def test_extreme_values_are_refused_before_a_run(results: Results, tmp_path: Path, value: float | list[float]) -> None:
    """A limit above 1e15 is no valid result, and 200 000 criteria take minutes."""
    path, out = tmp_path / "b.json", tmp_path / "out"
    path.write_bytes(changed(results, "std_force_N", value).to_json())
    result = pantocheck("run", "en50318-2002/*", "--system", PASSING, *CRITERIA, "--out", out, "--baseline", path)
    assert result.exit_code == 2
    assert "baseline 'b.json', case en50318-2002/250: " in result.output
    assert not out.exists()


def test_results_outlive_the_comparison(results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "b.json").write_bytes(results.to_json())

    def fail(*_: object) -> Results:
        raise RuntimeError("defect")

    monkeypatch.setattr("pantocheck.conformance.execution.plan.compare_with_baseline", fail)
    out = tmp_path / "out"
    command = ("run", "en50318-2002/*", "--system", PASSING, *CRITERIA, "--out", out, "--baseline", tmp_path / "b.json")
    assert pantocheck(*command).exit_code == 2
    assert [case.quantities for case in read_results(out / "results.json").cases] == [
        case.quantities for case in results.cases
    ]


@pytest.mark.parametrize("value", [1.01e12, -1.01e12])
def test_impossible_value_of_a_baseline_is_refused(results: Results, tmp_path: Path, value: float) -> None:
    path = tmp_path / "b.json"
    path.write_bytes(changed(results, "std_force_N", value).to_json())
    with pytest.raises(InputError, match=f"a value of {value:g}".replace("+", r"\+")):
        read_baseline(path)
    path.write_bytes(changed(results, "std_force_N", 0.99 * value).to_json())
    assert read_baseline(path).cases


@pytest.mark.parametrize(("number", "accepted"), [(9_992, True), (9_994, False)])
def test_number_of_values_is_bounded(results: Results, tmp_path: Path, number: int, accepted: bool) -> None:
    """The case has eight quantities; one of them gets a list of values."""
    path = tmp_path / "b.json"
    path.write_bytes(changed(results, "std_force_N", [1.0] * number).to_json())
    with nullcontext() if accepted else pytest.raises(InputError, match="10001 values; at most 10000 can be compared"):
        assert read_baseline(path).cases


# Drift from a baseline on the pages: a verdict of its own, and no criterion of EN 50318.


SHOWN = "std_force_N"


@pytest.fixture
def shown_drift(passing: dict[str, Any]) -> Results:
    """Every criterion passes; the standard deviation of pantograph 1 was half as large in the baseline."""
    now = Participation().decide_run(Results.model_validate(passing))
    case = now.cases[0]
    quantities = case.quantities | {"1": case.quantities["1"] | {SHOWN: 0.5 * float(str(case.quantities["1"][SHOWN]))}}
    before = now.model_copy(update={"cases": [case.model_copy(update={"quantities": quantities})]})
    return compare_with_baseline(now, before, 1.0, "earlier.json")


def test_criteria_pass_and_the_headline_states_the_drift_apart(shown_drift: Results) -> None:
    assert (shown_drift.verdict, shown_drift.criteria_verdict, shown_drift.baseline_verdict) == ("fail", "pass", "fail")
    assert find_discrepancies(shown_drift) == []
    text = build_headline(shown_drift)
    drift = f"1 value drifted from the baseline, most {SHOWN} of {shown_drift.cases[0].id} by +100 %"
    assert f"1 fails (0 of 16 values outside limits that count, {drift})" in text
    rows = [row for row in shown_drift.cases[0].criteria if row.baseline is not None]
    uncounted = shown_drift.model_copy(update={"cases": [shown_drift.cases[0].model_copy(update={"criteria": rows})]})
    assert f"1 fails ({drift})" in build_headline(uncounted)
    assert "EN 50318 criteria: PASS; Drift from the baseline: FAIL." in text


def test_summary_has_a_row_and_a_table_of_the_drift(shown_drift: Results) -> None:
    text = render_markdown(build_summary(shown_drift))
    assert "## Two verdicts" in text
    assert "| EN 50318 criteria | PASS | decides the verdict | 1 of 1 case passes. 16 of 16 values" in text
    assert re.search(
        r"\| Drift from the baseline \| FAIL \| decides the verdict \| 0 of 1 case passes. 1 of \d+ values drifted",
        text,
    )
    assert "## Drift from the baseline" in text
    table = text.split("Drift from the baseline: FAIL")[-1]
    [row] = [line for line in table.splitlines() if "drift from the baseline" in line]
    assert row.endswith("| FAIL | – |")  # earlier values have no trust


def test_certificate_shows_the_drift_below_a_heading_of_its_own(shown_drift: Results) -> None:
    html = shown_certificate(shown_drift.to_dict())
    headings = re.findall(r"<h[23][^>]*>(.*?)</h[23]>", html, re.DOTALL)
    assert [heading for heading in headings if "Drift from the baseline" in heading]
    assert "It always counts in the verdict of the report" in html
    assert "16 criteria: 16 " in html
    text = re.sub(r"<[^>]*>|\s|&nbsp;|\u200b|&#8203;", "", html)
    assert re.search(r"1of\d+valuesdriftedbymorethan1%fromearlier\.json,oraremissing", text)


def test_terminal_junit_badge_and_csv_show_the_drift_apart(shown_drift: Results, passing: dict[str, Any]) -> None:
    console = Console(width=140)
    with console.capture() as capture:
        for part in build_results_output(shown_drift, (), 1).further:
            console.print(part)
    criteria, drift = capture.get().partition("All values of")[0].split("Drift from the baseline: ")
    assert "FAIL" not in criteria[criteria.index("criterion ") :]
    assert drift.startswith("FAIL")
    assert "drifted by +100 % from the baseline" in drift
    root = ElementTree.fromstring(render_junit(shown_drift))
    failed = [test for test in root.iter("testcase") if test.find("failure") is not None]
    assert [test.get("name") for test in failed] == [f"drift of {SHOWN} of pantograph 1"]
    failure = failed[0].find("failure")
    assert "bounds of the baseline" in "".join(failure.itertext()) + str(failure.attrib)
    assert summarise_verdict(shown_drift) == "fail 16/16, baseline fail"
    # The bounds of a drift do not replace the limits of the standard.
    assert render_quantity_list(shown_drift) == render_quantity_list(Results.model_validate(passing))


def test_baseline_without_drift_is_shown_and_passes(passing: dict[str, Any]) -> None:
    now = Participation().decide_run(Results.model_validate(passing))
    same = compare_with_baseline(now, now, 1.0, "earlier.json")
    assert (same.verdict, same.baseline_verdict) == ("pass", "pass")
    assert "Drift from the baseline: PASS." in build_headline(same)
    assert summarise_verdict(same) == "pass 16/16"
    assert find_discrepancies(same) == []


def test_baseline_that_cannot_be_compared_decides_in_junit(passing: dict[str, Any]) -> None:
    """Its skipped criterion counts whichever verdict is requested."""
    passing["cases"][0]["criteria_verdict"] = "pass"
    now = Participation(requested=("verification",)).decide_run(Results.model_validate(passing))
    empty = now.model_copy(update={"cases": []})
    compared = compare_with_baseline(now, empty, 1.0, "earlier.json")
    assert compared.baseline_verdict == "skip"
    assert find_discrepancies(compared) == []
    tests = ElementTree.fromstring(render_junit(compared)).iter("testcase")
    [test] = [test for test in tests if test.get("name") == "baseline of line"]
    skipped = test.find("skipped")
    assert "for information" not in str(skipped.attrib)
