"""JUnit, Markdown summary, list of quantities and badge."""

import csv
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from openpyxl import load_workbook

from helpers.shown_page import summarise
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.quantity_tables import render_quantity_list
from pantocheck.conformance.pages.report_writers import write_pages
from pantocheck.conformance.pages.results_workbook import render_workbook
from pantocheck.conformance.pages.two_verdicts import render_badge
from pantocheck.conformance.results.report_files import FILES
from pantocheck.conformance.results.results_format import Results


def test_junit_counts_what_the_results_say(results: dict[str, Any]) -> None:
    root = ElementTree.fromstring(render_junit(Results.model_validate(results)))
    suites = root.findall("testsuite")
    assert [suite.get("name") for suite in suites] == [case["id"] for case in results["cases"]]
    counts = [root.get(name) for name in ("tests", "failures", "errors", "skipped")]
    assert counts == ["25", "1", "0", "3"]  # with a test of each record
    for suite in suites:
        assert int(suite.get("tests")) == len(suite.findall("testcase"))
        for element, counter in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
            assert int(suite.get(counter)) == len(suite.findall(f"testcase/{element}"))
    [failure] = root.iter("failure")
    assert re.match(
        r"31\.\d+ N, limits 32 to 34, margin -0\.32\d\d, secondary \(0\.32 N below the lower limit\)$",
        failure.get("message"),
    )
    properties = {p.get("name"): p.get("value") for p in suites[0].iter("property")}
    assert properties["suite_version"] == "0.1.0"
    assert properties["system"] == "Pantocheck reference simulator 0.1.0 (builtin)"
    root = ElementTree.fromstring(render_badge(Results.model_validate(results)))
    assert root.get("aria-label") == "EN 50318 style: fail 19/21"


def test_junit_holds_errors_and_any_text(passing: dict[str, Any], hostile: dict[str, Any]) -> None:
    passing["cases"][0] |= {"verdict": "error", "reason": "the solver diverged", "criteria": []}
    root = ElementTree.fromstring(render_junit(Results.model_validate(passing)))
    assert root.get("errors") == "1"
    assert next(root.iter("error")).get("message") == "the solver diverged"
    root = ElementTree.fromstring(render_junit(Results.model_validate(hostile)))
    assert root.find("testsuite[2]").get("name") == "en50318-2002/300a|b `c` *d* [e](f) \\ _g_"
    assert all("\n" not in value for element in root.iter() for value in element.attrib.values())


@pytest.mark.parametrize("name", ["results", "hostile"])
def test_summary_tables_keep_their_columns(name: str, request: pytest.FixtureRequest) -> None:
    results = request.getfixturevalue(name)
    rows = [line for line in summarise(results).splitlines() if line.startswith("|")]
    assert len(rows) == 2 * 2 + 22
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {9}


def test_summary_begins_with_the_verdict_and_escapes(results: dict[str, Any], hostile: dict[str, Any]) -> None:
    assert summarise(results).startswith(
        "# FAIL: 1 of 3 cases passes, 1 fails \\(1 of 21 values outside limits that count\\), "
        "1 could not be evaluated completely.\n"
    )
    text = summarise(hostile)
    assert "<script" not in text
    assert "`c`" not in text.replace(r"\`c\`", "")
    assert "https://" not in summarise(
        results | {"system": {"name": "see https://example.org", "version": "", "kind": "record"}}
    )


def read_rows(results: dict[str, Any]) -> dict[tuple[str, ...], dict[str, str]]:
    """Rows of the list of quantities by case, pantograph, quantity and item."""
    rows = csv.DictReader(render_quantity_list(Results.model_validate(results)).splitlines())
    return {(row["case"], row["pantograph"], row["quantity"], row["item"]): row for row in rows}


def test_list_of_quantities_has_every_value_with_its_components(results: dict[str, Any]) -> None:
    """A component that is not known is NA, not zero; numbers have all their digits."""
    rows = read_rows(results)
    values = {
        (case["id"], owner, name, ""): value
        for case in results["cases"]
        for owner, quantities in case["quantities"].items()
        for name, value in quantities.items()
    }
    assert {key: float(row["value"]) for key, row in rows.items()} == values
    rear = rows["en50318-2002/250", "2", "std_force_N", ""]
    value = float(rear["value"])
    assert (float(rear["discretisation"]), float(rear["start"])) == (0.0015 * value, 0.002 * value)
    assert (rear["section"], rear["length"], rear["unit"]) == ("NA", "NA", "N")
    assert (rear["lower"], rear["upper"], rear["verdict"]) == ("22.0", "31.0", "pass")
    speed = rows["en50318-2002/250", "0", "wave_speed_m_s", ""]
    assert (speed["uncertainty"], speed["discretisation"], speed["verdict"]) == ("NA", "NA", "")


def test_list_of_quantities_has_a_row_for_each_item_and_pages_one_file(passing: dict[str, Any], tmp_path: Path) -> None:
    case = passing["cases"][0]
    case["quantities"]["0"]["presag_mm"] = [20.0, 55.0]
    case["uncertainty"]["0"] = {"presag_mm": [0.5, 0.25]}
    case["uncertainty_components"]["0"] = {"presag_mm": {"discretisation": [0.5, 0.25]}}
    rows = read_rows(passing)
    found = [rows["en50318-2002/250", "0", "presag_mm", item] for item in ("1", "2")]
    values = [(row["value"], row["uncertainty"], row["discretisation"]) for row in found]
    assert values == [("20.0", "0.5", "0.5"), ("55.0", "0.25", "0.25")]
    write_pages(Results.model_validate(passing), tmp_path, list(FILES))
    assert {path.name for path in tmp_path.iterdir()} == set(FILES.values()) - {"results.json"}


def test_workbook_has_every_number_with_its_unit_and_no_formula(
    results: dict[str, Any], hostile: dict[str, Any], tmp_path: Path
) -> None:
    """Sheets hold the numbers of results.json to the last digit."""
    found = Results.model_validate(results)
    (tmp_path / "a.xlsx").write_bytes(render_workbook(found))
    sheets = {sheet.title: list(sheet.iter_rows(values_only=True)) for sheet in load_workbook(tmp_path / "a.xlsx")}
    assert [row[0] for row in sheets["verdicts"][1:]] == ["all", *(case.id for case in found.cases)]
    assert [row[2] for row in sheets["verdicts"][1:]] == [found.verdict, *(case.verdict for case in found.cases)]
    criteria = [row for case in found.cases for row in case.criteria]
    head, *rows = sheets["criteria"]
    shown = [dict(zip(head, row, strict=True)) for row in rows if row[1] == "criteria"]
    assert [(row["value"], row["lower limit"], row["verdict"], row["unit"]) for row in shown] == [
        (row.value, row.lower, row.verdict, row.unit) for row in criteria
    ]
    head, *rows = sheets["quantities"]
    shown = [dict(zip(head, row, strict=True)) for row in rows]
    values = {(row["case"], str(row["pantograph"])): row["Mean contact force [N]"] for row in shown}
    for case in found.cases:
        for owner, quantities in case.quantities.items():
            assert values[case.id, owner] == quantities.get("mean_force_N")
    head, *rows = sheets["uncertainty"]
    rear = next(row for row in rows if row[:3] == ("en50318-2002/250", "2", "Standard deviation, 0–20 Hz"))
    shown_row = dict(zip(head, rear, strict=True))
    assert (shown_row["discretisation"], shown_row["section"]) == (0.0015 * shown_row["value"], "NA")
    content = render_workbook(Results.model_validate(hostile))
    (tmp_path / "b.xlsx").write_bytes(content)
    cells = [cell for sheet in load_workbook(tmp_path / "b.xlsx") for row in sheet.iter_rows() for cell in row]
    assert {cell.data_type for cell in cells} == {"s", "n"}
    assert render_workbook(Results.model_validate(hostile)) == content


def test_modified_copy_is_named_in_every_format(passing: dict[str, Any]) -> None:
    """A wider limit under the id of a library case must not look like the library case."""
    passing["cases"][0]["library"] = "modified"
    name = f"modified copy of {passing['cases'][0]['id']}"
    badge = ElementTree.fromstring(render_badge(Results.model_validate(passing))).get("aria-label") or ""
    assert re.fullmatch(r"EN 50318 style: pass \d+/\d+, modified copy", badge)
    suite = next(ElementTree.fromstring(render_junit(Results.model_validate(passing))).iter("testsuite"))
    assert suite.get("name") == name
    assert {test.get("classname") for test in suite.iter("testcase")} == {name}
    assert name in summarise(passing)


def test_markdown_renders_every_element() -> None:
    text = (
        doc.Code("a_b"), " ", doc.Code("a`b"), doc.Remark("*r*"), doc.Link("[1]", "x"), doc.TrustMark(""),
        doc.Drawing("<svg/>", "bar"),
    )  # fmt: skip
    blocks = (
        doc.Paragraph(text),
        doc.CodeBlock("x = 1\n[t]"),
        doc.BulletList(("one_",)),
        doc.NumberedList("Sources", ("first", "second"), "x"),
        doc.Facts((("Suite", "1.0"),), times=(("Started", "now"),)),
        doc.Figures((doc.Figure("<svg/>", "a line", "caption"),)),
    )
    document = doc.Document(
        "t", doc.PlainHeader("Heading", "Result."), (doc.Section("Part", (*blocks, doc.Section("Deeper", ()))),)
    )
    assert render_markdown(document).split("\n\n") == [
        "# Heading", "Result.", "## Part", r"`a_b` a\`b\*r\*\[1\]–bar", "    x = 1\n    [t]", r"* one\_",
        "1. first\n2. second", "* Suite: 1.0\n* Started: now", "* a line", "### Deeper\n",
    ]  # fmt: skip
