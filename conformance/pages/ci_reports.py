"""Criteria, records and steps of a run as named tests with one verdict each: JUnit XML, and annotations of a change."""

import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

from pydantic import JsonValue

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages.condition_sections import describe_condition
from pantocheck.conformance.pages.document_facts import name_system
from pantocheck.conformance.pages.scope_page import describe_origin, prepare_results
from pantocheck.conformance.pages.verdict_marks import NAMES, list_criteria, select_criteria
from pantocheck.conformance.pages.verdict_reasons import build_headline
from pantocheck.conformance.pages.words import name_owner
from pantocheck.conformance.quantities.limit_text import format_graded, is_relative_margin
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.results.file_places import FilePlace, ReportPlaces
from pantocheck.conformance.results.procedure_format import ValidityClaim
from pantocheck.conformance.results.results_format import CaseResult, Results

TEST_ELEMENTS = {"error": "error", **dict.fromkeys(("fail", "undecided", "unconfirmed"), "failure")}
TEST_ELEMENTS |= dict.fromkeys(("skip", "info"), "skipped")
"""Name of each verdict in JUnit; a test without such an element has passed."""


@dataclass(frozen=True)
class GradedTest:
    """Test with its verdict."""

    group: str
    """Id of the case, or `step/` with the name of a step of the procedure."""
    name: str
    """Name of the test in its group."""
    verdict: str
    """Verdict; `info` if the test has no influence."""
    text: str
    """Value, limits and reason."""
    criterion: Criterion | None = None
    """Graded criterion; None: a case, a record, a step or a claim."""

    @property
    def element(self) -> str:
        """Element of JUnit that states the verdict."""
        return TEST_ELEMENTS.get(self.verdict, "system-out")

    @property
    def message(self) -> str:
        """Text of this element."""
        return self.text if self.verdict in TEST_ELEMENTS else f"{self.verdict}: {self.text}"


def list_case_tests(case: CaseResult, results: Results) -> list[GradedTest]:
    """Tests of a case: its criteria and its record.

    Returns:
        At least one test, so that a count of tests includes a case without criteria.
    """
    graded = [test for name in NAMES for test in _list_criterion_tests(case, results, name)]
    tests = graded or [GradedTest(case.id, "case", case.verdict, case.reason or "no criteria")]
    if graded and case.record:
        tests.append(_test_record(case.id, case.record, results))
    return _show_unpassed(tests) if case.id in results.information else tests


def list_step_tests(results: Results) -> Iterator[list[GradedTest]]:
    """Tests of each step of the procedure of a dossier: its own criteria and claims, and the step as a whole."""
    if (procedure := results.procedure) is None:
        return
    for step in procedure.steps:
        name = f"step/{step.step}"
        tests = [_test_criterion(name, row) for row in step.criteria]
        if step.step == "limits_of_validity":
            tests += [_test_claim(name, claim) for claim in procedure.claims]
        reason = step.reason or step.unconfirmed or step.closest or "no criterion of its own"
        tests.append(GradedTest(name, "step", step.verdict, f"{step.state}: {reason}"))
        yield tests if step.required else _show_unpassed(tests)


def _list_criterion_tests(case: CaseResult, results: Results, name: str) -> Iterator[GradedTest]:
    """Tests of one of the verdicts of a case; for information if this verdict does not decide."""
    decisive = list(select_criteria(results, case))
    for row in list_criteria(case, name):
        test = _test_criterion(case.id, row)
        yield test if row in decisive else _show_only(test)


def _test_criterion(group: str, row: Criterion) -> GradedTest:
    kind = "verification: " if row.trust == "computed" else "" if row.baseline is None else "drift of "
    number, bounds = format_graded(row.value, row.lower, row.upper)
    value = "no value" if row.value is None else f"{number} {row.unit}".rstrip()
    relative = is_relative_margin(row.lower, row.upper)
    margin = "" if row.margin is None else f", margin {row.margin:.4g} {'' if relative else row.unit}".rstrip()
    reason = f" ({row.reason})" if row.reason else ""
    name = f"{kind}{row.quantity} of {name_owner(row)}"
    basis = row.trust or "bounds of the baseline"
    return GradedTest(group, name, row.verdict, f"{value}, limits {bounds}{margin}, {basis}{reason}", row)


def _test_claim(group: str, claim: ValidityClaim) -> GradedTest:
    name = f"claim on {' '.join(filter(None, (claim.kind, claim.name)))}"
    return GradedTest(group, name, claim.verdict, claim.reason or f"verified by {', '.join(claim.evidence)}")


def _test_record(case_id: str, record: RecordFacts, results: Results) -> GradedTest:
    """Test of the state of the record; for information if the profile or the user accepts an unconfirmed one."""
    excused = results.system.name in results.accepted_unconfirmed or not record.demanded
    verdict = "pass" if record.state == "consistent" else "info" if excused else "unconfirmed"
    return GradedTest(case_id, "record", verdict, f"{record.state}: {record.reason}")


def _show_unpassed(tests: list[GradedTest]) -> list[GradedTest]:
    """Tests of a part that is shown for information: passed ones remain, all others have no influence."""
    return [test if test.element == "system-out" else _show_only(test) for test in tests]


def _show_only(test: GradedTest) -> GradedTest:
    """The same test without influence on a pipeline."""
    return replace(test, verdict="info", text=f"for information: {test.element}: {test.message}")


# JUnit XML: one test suite per case or step, one test case per criterion, so that any CI server shows the verdicts.
COUNTERS = ("tests", "failures", "errors", "skipped")
"""Attributes that count the tests of a suite."""


def render_junit(results: Results, certificates: Sequence[str] = ()) -> bytes:
    """JUnit XML of a run; the properties of each case name the certificates in the same folder."""
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
        "condition": describe_condition(case),
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


# Failed criteria at the lines of the files that state their limits, for the page of a change.
Severity = Literal["error", "warning"]

SEVERITIES: dict[str, Severity] = {"skip": "warning"}
SEVERITIES |= dict.fromkeys(("error", "fail", "undecided", "unconfirmed"), "error")
"""Severity of each verdict that keeps a pipeline from passing; a limit that does not count has none."""

WORKSPACE_VARIABLES = ("GITHUB_WORKSPACE", "CI_PROJECT_DIR")
"""Environment variables that name the folder of the checkout in GitHub and GitLab jobs."""


@dataclass(frozen=True)
class Annotation:
    """Remark at a line of a file."""

    severity: Severity
    """`error` or `warning`."""
    group: str
    """Id of the case, or step of the procedure."""
    name: str
    """Name of the criterion in its group."""
    text: str
    """Value, limits and reason."""
    place: FilePlace | None
    """File and line; None: not known."""


def list_annotations(results: Results, places: ReportPlaces) -> list[Annotation]:
    """Annotations of a run, errors first.

    Returns:
        One per criterion, case, record or step that keeps the run from passing. If there is none, and the run does not
        pass, one with the headline.
    """
    found = sorted(_list_unpassed(results, places), key=lambda annotation: annotation.severity == "warning")
    if found or results.verdict == "pass":
        return found
    prepared = prepare_results(results)
    return [Annotation("warning", "pantocheck", str(results.verdict), build_headline(prepared), places.default)]


def _list_unpassed(results: Results, places: ReportPlaces) -> Iterator[Annotation]:
    prepared = prepare_results(results)
    for tests in list_step_tests(prepared):
        yield from (_annotate(test, places.default) for test in tests if test.verdict in SEVERITIES)
    for stated, case in zip(results.cases, prepared.cases, strict=True):
        for test in list_case_tests(case, prepared):
            if test.verdict in SEVERITIES:
                yield _annotate(test, _find_place(test, stated.id, places))


def _find_place(test: GradedTest, case_id: str, places: ReportPlaces) -> FilePlace | None:
    row = test.criterion
    if row is None or row.trust == "computed":
        return places.find_case(case_id)
    if row.is_drift:
        return places.baseline or places.find_case(case_id)
    return places.find_limit(case_id, row.quantity, row.pantograph, row.item)


def _annotate(test: GradedTest, place: FilePlace | None) -> Annotation:
    return Annotation(SEVERITIES[test.verdict], test.group, test.name, test.text, place)


def shorten_path(path: Path) -> str:
    """Path relative to the checkout with forward slashes, as services of CI expect; a path outside it stays absolute.

    The checkout is the folder that the service names in the environment, or else the current folder.
    """
    workspace = next((value for name in WORKSPACE_VARIABLES if (value := os.environ.get(name))), os.curdir)
    resolved, folder = path.resolve(), Path(workspace).resolve()
    return (resolved.relative_to(folder) if resolved.is_relative_to(folder) else resolved).as_posix()


# Annotations as a code quality report of GitLab: a JSON list, shown beside the lines of a merge request.
GITLAB_SEVERITIES: dict[Severity, str] = {"error": "critical", "warning": "minor"}
"""Severity of GitLab for each severity of an annotation."""


def render_code_quality(annotations: Sequence[Annotation], fallback: Path) -> bytes:
    """Code quality report; the file `fallback` stands for an unknown place, because the service requires one."""
    issues = [_issue(annotation, annotation.place or FilePlace(fallback)) for annotation in annotations]
    return (json.dumps(issues, indent=1, ensure_ascii=True) + "\n").encode()


def _issue(annotation: Annotation, place: FilePlace) -> dict[str, JsonValue]:
    path, title = shorten_path(place.path), f"{annotation.group}: {annotation.name}"
    # Equal for the same criterion in two runs, so that the service recognises a solved one.
    fingerprint = hashlib.sha256("\0".join((path, annotation.group, annotation.name)).encode("utf-8", "replace"))
    return {
        "type": "issue",
        "check_name": "pantocheck",
        "description": f"{title}: {annotation.text}",
        "severity": GITLAB_SEVERITIES[annotation.severity],
        "fingerprint": fingerprint.hexdigest(),
        "location": {"path": path, "lines": {"begin": place.line or 1}},
    }


# Annotations as workflow commands of GitHub Actions.
#
# A line `::error file=F,line=N,title=T::MESSAGE` that a step prints becomes a remark at this line of the change. Texts
# come from files of other people: the escapes of the service keep them inside their field.
MOST_SHOWN = 10
"""Largest number of errors, and of warnings, that the service shows of a step."""


def render_workflow_commands(annotations: Sequence[Annotation]) -> bytes:
    """Lines of workflow commands; more annotations than the service shows end in a line with their number.

    Returns:
        One line per annotation in UTF-8; empty without annotations.
    """
    lines: list[str] = []
    for severity in ("error", "warning"):
        of_severity = [annotation for annotation in annotations if annotation.severity == severity]
        shown = of_severity if len(of_severity) <= MOST_SHOWN else of_severity[: MOST_SHOWN - 1]
        lines += map(_render_command, shown)
        if rest := len(of_severity) - len(shown):
            lines.append(f"::{severity} title=pantocheck::{rest} more are in the summary and in the certificate")
    return "".join(f"{line}\n" for line in lines).encode("utf-8", "replace")


def _render_command(annotation: Annotation) -> str:
    properties = {}
    if annotation.place is not None:
        properties["file"] = shorten_path(annotation.place.path)
        if annotation.place.line is not None:
            properties["line"] = str(annotation.place.line)
    properties["title"] = f"{annotation.group}: {annotation.name}"
    escaped = {name: _escape_message(text).replace(":", "%3A").replace(",", "%2C") for name, text in properties.items()}
    stated = ",".join(f"{name}={text}" for name, text in escaped.items())
    return f"::{annotation.severity} {stated}::{_escape_message(annotation.text)}"


def _escape_message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
