"""JUnit, Markdown summary and badge."""

import json
import re
from xml.etree import ElementTree

import pytest

from pantocheck.conformance.reports.formats import badge, junit
from pantocheck.conformance.reports.formats import markdown as summary
from pantocheck.conformance.reports.formats.report_writers import FILES, find_writer


def test_junit_counts_what_the_results_say(results):
    root = ElementTree.fromstring(junit.render_junit(results))
    suites = root.findall("testsuite")
    assert [suite.get("name") for suite in suites] == [case["id"] for case in results["cases"]]
    assert [root.get(name) for name in ("tests", "failures", "errors", "skipped")] == ["23", "1", "0", "2"]
    for suite in suites:
        assert int(suite.get("tests")) == len(suite.findall("testcase"))
        for element, counter in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
            assert int(suite.get(counter)) == len(suite.findall(f"testcase/{element}"))
    [failure] = root.iter("failure")
    assert re.match(r"31\.\d+ N, limits 32 to 34, margin -0\.32\d\d, secondary$", failure.get("message"))
    properties = {p.get("name"): p.get("value") for p in suites[0].iter("property")}
    assert properties["suite_version"] == "0.1.0"
    assert properties["system"] == "Pantocheck reference simulator 0.1.0 (builtin)"


def test_junit_holds_an_error_of_a_case(passing):
    passing["cases"][0] |= {"verdict": "error", "reason": "the solver diverged", "criteria": []}
    root = ElementTree.fromstring(junit.render_junit(passing))
    assert root.get("errors") == "1"
    assert next(root.iter("error")).get("message") == "the solver diverged"


def test_junit_is_valid_xml_for_any_text(hostile):
    root = ElementTree.fromstring(junit.render_junit(hostile))
    assert root.find("testsuite[2]").get("name") == "en50318-2002/300a|b `c` *d* [e](f) \\ _g_"
    assert all("\n" not in value for element in root.iter() for value in element.attrib.values())


@pytest.mark.parametrize("name", ["results", "hostile"])
def test_summary_tables_keep_their_columns(name, request):
    results = request.getfixturevalue(name)
    rows = [line for line in summary.render_markdown(results).splitlines() if line.startswith("|")]
    assert len(rows) == 2 * 2 + 22
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {9}


def test_summary_begins_with_the_verdict_and_escapes(results, hostile):
    assert summary.render_markdown(results).startswith(
        "# FAIL: 1 of 21 counted criteria in 3 cases lie outside their limits.\n"
    )
    text = summary.render_markdown(hostile)
    assert "<script" not in text
    assert "`c`" not in text.replace(r"\`c\`", "")
    assert "https://" not in summary.render_markdown(
        results | {"system": {"name": "see https://example.org", "version": ""}}
    )


def test_badge(results, tmp_path):
    badge.write_badge(results, tmp_path / "badge.json")
    content = json.loads((tmp_path / "badge.json").read_text())
    assert content["schemaVersion"] == 1
    assert content["message"] == "fail 19/21"
    badge.write_badge(results, tmp_path / "badge.svg")
    root = ElementTree.parse(tmp_path / "badge.svg").getroot()
    assert root.get("aria-label") == "EN 50318 style: fail 19/21"


def test_every_format_has_a_writer_that_leaves_one_file(passing, tmp_path):
    for name in FILES:
        if name != "json":
            find_writer(name)(passing, tmp_path / FILES[name])
    assert {path.name for path in tmp_path.iterdir()} == set(FILES.values()) - {"results.json"}
