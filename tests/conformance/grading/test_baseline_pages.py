"""Drift from a baseline on the pages: a verdict of its own, and no criterion of EN 50318."""

import io
import re
from typing import Any
from xml.etree import ElementTree

import pytest
from pypdf import PdfReader
from rich.console import Console

from helpers.shown_page import shown_certificate
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.baseline import compare_with_baseline
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.pages.badge import summarise_verdict
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.junit import render_junit
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.quantity_tables import render_quantity_list
from pantocheck.conformance.pages.summary_page import build_summary
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.results.results_format import Results

DRIFTED = "std_force_N"


@pytest.fixture
def drifted(passing: dict[str, Any]) -> Results:
    """Every criterion passes; the standard deviation of pantograph 1 was half as large in the baseline."""
    now = Participation().decide_run(Results.model_validate(passing))
    case = now.cases[0]
    quantities = case.quantities | {
        "1": case.quantities["1"] | {DRIFTED: 0.5 * float(str(case.quantities["1"][DRIFTED]))}
    }
    before = now.model_copy(update={"cases": [case.model_copy(update={"quantities": quantities})]})
    return compare_with_baseline(now, before, 1.0, "earlier.json")


def test_criteria_pass_and_the_headline_states_the_drift_apart(drifted: Results) -> None:
    assert (drifted.verdict, drifted.criteria_verdict, drifted.baseline_verdict) == ("fail", "pass", "fail")
    assert find_discrepancies(drifted) == []
    text = build_headline(drifted)
    drift = f"1 value drifted from the baseline, most {DRIFTED} of {drifted.cases[0].id} by +100 %"
    assert f"1 fails (0 of 16 counted criteria outside their limits, {drift})" in text
    rows = [row for row in drifted.cases[0].criteria if row.baseline is not None]
    uncounted = drifted.model_copy(update={"cases": [drifted.cases[0].model_copy(update={"criteria": rows})]})
    assert f"1 fails ({drift})" in build_headline(uncounted)
    assert "EN 50318 criteria: PASS; Drift from the baseline: FAIL." in text


def test_summary_has_a_row_and_a_table_of_the_drift(drifted: Results) -> None:
    text = render_markdown(build_summary(drifted))
    assert "## Two verdicts" in text
    assert "| EN 50318 criteria | PASS | decides | 1 of 1 case passes. 16 of 16 counted criteria" in text
    assert re.search(
        r"\| Drift from the baseline \| FAIL \| decides \| 0 of 1 case passes. 1 of \d+ values drifted", text
    )
    assert "## Drift from the baseline" in text
    table = text.split("Drift from the baseline: FAIL")[-1]
    [row] = [line for line in table.splitlines() if "drift from the baseline" in line]
    assert row.endswith("| FAIL | – |")  # earlier values have no trust


def test_certificate_shows_the_drift_below_a_heading_of_its_own(drifted: Results) -> None:
    html = shown_certificate(drifted.to_dict())
    headings = re.findall(r"<h[23][^>]*>(.*?)</h[23]>", html, re.DOTALL)
    assert [heading for heading in headings if "Drift from the baseline" in heading]
    assert "Two verdicts" in html
    assert "16 criteria: 16 " in html
    pages = PdfReader(io.BytesIO(render_pdf(build_certificate(drifted)))).pages
    pdf = re.sub(r"[\s\u200b]", "", "".join(page.extract_text() for page in pages))
    assert "Twoverdicts" in pdf
    assert re.search(r"1of\d+valuesdriftedbymorethan1%fromearlier\.json,oraremissing", pdf)


def test_terminal_junit_badge_and_csv_show_the_drift_apart(drifted: Results, passing: dict[str, Any]) -> None:
    console = Console(width=140)
    with console.capture() as capture:
        for part in build_results_output(drifted, (), 1).details:
            console.print(part)
    criteria, drift = capture.get().split("Drift from the baseline: ")
    assert "FAIL" not in criteria.split("\n", 4)[-1]
    assert drift.startswith("FAIL")
    assert "drifted by +100 % from the baseline" in drift
    root = ElementTree.fromstring(render_junit(drifted))
    failed = [test for test in root.iter("testcase") if test.find("failure") is not None]
    assert [test.get("name") for test in failed] == [f"drift of {DRIFTED} of pantograph 1"]
    failure = failed[0].find("failure")
    assert "bounds of the baseline" in "".join(failure.itertext()) + str(failure.attrib)
    assert summarise_verdict(drifted) == "fail 16/16, baseline fail"
    # The bounds of a drift do not replace the limits of the standard.
    assert render_quantity_list(drifted) == render_quantity_list(Results.model_validate(passing))


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
