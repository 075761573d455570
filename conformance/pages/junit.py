"""JUnit XML: one test suite per case or step, one test case per criterion, so that any CI server shows the verdicts."""

from collections import Counter
from collections.abc import Sequence
from xml.etree import ElementTree

from pantocheck.conformance.pages.document_facts import name_system
from pantocheck.conformance.pages.graded_tests import GradedTest, list_case_tests, list_step_tests
from pantocheck.conformance.pages.scope_page import describe_origin, prepare_results
from pantocheck.conformance.results.results_format import CaseResult, Results

COUNTERS = ("tests", "failures", "errors", "skipped")
"""Attributes that count the tests of a suite."""


def render_junit(results: Results, certificates: Sequence[str] = ()) -> bytes:
    """JUnit XML of a run.

    Args:
        results: Results of a run.
        certificates: Names of the certificates in the same folder, which the properties of each case name.

    Returns:
        Content of junit.xml.
    """
    results = prepare_results(results)
    cases = (_case_suite(case, results, certificates) for case in results.cases)
    suites = [*map(_suite, list_step_tests(results)), *cases]
    total = {name: str(sum(int(suite.attrib[name]) for suite in suites)) for name in COUNTERS}
    root = ElementTree.Element("testsuites", {"name": "pantocheck", **total})
    root.extend(suites)
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _case_suite(case: CaseResult, results: Results, certificates: Sequence[str]) -> ElementTree.Element:
    suite = _suite(list_case_tests(case, results))
    if case.run.wall_s is not None:
        suite.set("time", f"{case.run.wall_s:.3f}")
    if results.started:
        suite.set("timestamp", results.started.removesuffix("Z"))
    properties = ElementTree.Element("properties")
    for name, value in {
        "statement": results.statement,
        "suite_version": results.suite.version,
        "suite_commit": results.suite.commit,
        "system": name_system(results),
        "suite_digest": results.suite.digest,
        "origin": describe_origin(case),
        "input_digest": case.input_digest,
        "limits_digest": case.limits_digest,
        "limit_changes": "; ".join(case.limit_changes),
        "changes": "; ".join(case.changes),
        "certificate": "; ".join(certificates),
        **{f"administration_{key}": text for key, text in (results.administration or ())},
        **{f"platform_{name}": text for name, text in results.platform},
    }.items():
        if value:
            ElementTree.SubElement(properties, "property", {"name": name, "value": str(value)})
    suite.insert(0, properties)
    return suite


def _suite(tests: list[GradedTest]) -> ElementTree.Element:
    elements = Counter(test.element for test in tests)
    counts = (len(tests), elements["failure"], elements["error"], elements["skipped"])
    counted = dict(zip(COUNTERS, map(str, counts), strict=True))
    suite = ElementTree.Element("testsuite", {"name": tests[0].group, **counted})
    suite.extend(map(_test_case, tests))
    return suite


def _test_case(test: GradedTest) -> ElementTree.Element:
    case = ElementTree.Element("testcase", {"classname": test.group, "name": test.name})
    if test.element == "system-out":
        ElementTree.SubElement(case, test.element).text = test.message
    else:
        ElementTree.SubElement(case, test.element, {"message": test.message})
    return case
