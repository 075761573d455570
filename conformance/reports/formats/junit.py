"""JUnit XML: one test suite per case or step, one test case per criterion, so that any CI server shows the verdicts."""

from collections import Counter
from collections.abc import Iterator
from typing import Any
from xml.etree import ElementTree

from pantocheck.conformance.quantities.limit_text import format_graded
from pantocheck.conformance.reports.certificate.case_facts import name_system
from pantocheck.conformance.reports.certificate.scope_page import describe_origin, prepare_results
from pantocheck.conformance.reports.certificate.two_verdicts import NAMES, list_criteria, select_criteria
from pantocheck.conformance.reports.words import name_owner

ELEMENTS = {"fail": "failure", "error": "error", "skip": "skipped", "info": "skipped", "unverified": "failure"}
"""Name of each verdict in JUnit; a test without such an element has passed."""

COUNTERS = ("tests", "failures", "errors", "skipped")
"""Attributes that count the tests of a suite."""


def render_junit(results: dict[str, Any]) -> bytes:
    """JUnit XML of results.json as a dictionary."""
    results = prepare_results(results)
    suites = [*_list_steps(results), *(_suite(case, results) for case in results["cases"])]
    total = {name: str(sum(int(suite.attrib[name]) for suite in suites)) for name in COUNTERS}
    root = ElementTree.Element("testsuites", {"name": "pantocheck", **total})
    root.extend(suites)
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _suite(case: dict[str, Any], results: dict[str, Any]) -> ElementTree.Element:
    # A case without criteria counts as one test, or the count would omit it.
    graded = [test for name in NAMES for test in _list_tests(case, results, name)]
    tests = graded or [_test(case["id"], "case", case["verdict"], case["reason"] or "no criteria")]
    if graded and case["record"]:
        tests.append(_record_test(case, results))
    if case["id"] in results["information"]:
        tests = [test if test[0].tag == "system-out" else _skip_test(test) for test in tests]
    attributes = {"name": case["id"], **_count_tests(tests)}
    if case["run"]["wall_s"] is not None:
        attributes["time"] = f"{case['run']['wall_s']:.3f}"
    if results["started"]:
        attributes["timestamp"] = results["started"].removesuffix("Z")
    suite = ElementTree.Element("testsuite", attributes)
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in {
        "statement": results["statement"],
        "suite_version": results["suite"]["version"],
        "suite_commit": results["suite"]["commit"],
        "system": name_system(results),
        "suite_digest": results["suite"]["digest"],
        "origin": describe_origin(case),
        "input_digest": case["input_digest"],
        "limits_digest": case["limits_digest"],
        "limit_changes": "; ".join(case["limit_changes"]),
        "changes": "; ".join(case["changes"]),
        **{f"administration_{key}": text for key, text in (results["administration"] or {}).items()},
        **{f"platform_{name}": text for name, text in results["platform"].items()},
    }.items():
        if value:
            ElementTree.SubElement(properties, "property", {"name": name, "value": str(value)})
    suite.extend(tests)
    return suite


def _list_steps(results: dict[str, Any]) -> Iterator[ElementTree.Element]:
    """One suite per step of the procedure of a dossier: its own criteria and claims, and the step as a whole."""
    procedure = results.get("procedure") or {"steps": []}
    for step in procedure["steps"]:
        name = f"step/{step['step']}"
        tests = [_criterion_test(name, row) for row in step["criteria"]]
        if step["step"] == "limits_of_validity":
            tests += [_claim_test(name, claim) for claim in procedure["claims"]]
        reason = step["reason"] or step["unverified"] or step["closest"] or "no criterion of its own"
        tests.append(_test(name, "step", step["verdict"], f"{step['state']}: {reason}"))
        if not step["required"]:
            tests = [test if test[0].tag == "system-out" else _skip_test(test) for test in tests]
        suite = ElementTree.Element("testsuite", {"name": name, **_count_tests(tests)})
        suite.extend(tests)
        yield suite


def _claim_test(suite: str, claim: dict[str, Any]) -> ElementTree.Element:
    name = f"claim on {' '.join(filter(None, (claim['kind'], claim['name'])))}"
    return _test(suite, name, claim["verdict"], claim["reason"] or f"verified by {', '.join(claim['evidence'])}")


def _count_tests(tests: list[ElementTree.Element]) -> dict[str, str]:
    """Attributes of a suite that count its tests."""
    elements = Counter(test[0].tag for test in tests)
    counts = (len(tests), elements["failure"], elements["error"], elements["skipped"])
    return dict(zip(COUNTERS, map(str, counts), strict=True))


def _list_tests(case: dict[str, Any], results: dict[str, Any], name: str) -> Iterator[ElementTree.Element]:
    """Tests of one of the two verdicts of a case; skipped if this verdict does not decide."""
    decisive = list(select_criteria(results, case))
    for row in list_criteria(case, name):
        test = _criterion_test(case["id"], row)
        yield test if row in decisive else _skip_test(test)


def _criterion_test(case: str, row: dict[str, Any]) -> ElementTree.Element:
    kind = "verification: " if row["trust"] == "computed" else "" if row["baseline"] is None else "drift of "
    number, bounds = format_graded(row["value"], row["lower"], row["upper"])
    value = "no value" if row["value"] is None else f"{number} {row['unit']}".rstrip()
    margin = "" if row["margin"] is None else f", margin {row['margin']:.4g}"
    reason = f" ({row['reason']})" if row["reason"] else ""
    name = f"{kind}{row['quantity']} of {name_owner(row)}"
    return _test(case, name, row["verdict"], f"{value}, limits {bounds}{margin}, {row['trust']}{reason}")


def _record_test(case: dict[str, Any], results: dict[str, Any]) -> ElementTree.Element:
    """Test of the state of the record; skipped if it is unverified, and the profile or the user accepts that."""
    record = case["record"]
    excused = results["system"]["name"] in results["accepted_unverified"] or not record["demanded"]
    verdict = "pass" if record["state"] == "verified" else "info" if excused else "unverified"
    return _test(case["id"], "record", verdict, f"{record['state']}: {record['reason']}")


def _skip_test(test: ElementTree.Element) -> ElementTree.Element:
    """The same test without influence on a pipeline, for a case that is shown for information."""
    text = test[0].get("message") or test[0].text or ""
    return _test(test.attrib["classname"], test.attrib["name"], "info", f"for information: {test[0].tag}: {text}")


def _test(case: str, name: str, verdict: str, text: str) -> ElementTree.Element:
    test = ElementTree.Element("testcase", {"classname": case, "name": name})
    if verdict in ELEMENTS:
        ElementTree.SubElement(test, ELEMENTS[verdict], {"message": text})
    else:
        ElementTree.SubElement(test, "system-out").text = f"{verdict}: {text}"
    return test
