"""Failed criteria at the lines of the files that state their limits, for the page of a change."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.reports.certificate.scope_page import prepare_results
from pantocheck.conformance.reports.certificate.verdict_reasons import build_headline
from pantocheck.conformance.reports.formats.graded_tests import GradedTest, list_case_tests, list_step_tests
from pantocheck.conformance.results.file_places import FilePlace, ReportPlaces
from pantocheck.conformance.results.results_format import Results

Severity = Literal["error", "warning"]

SEVERITIES: dict[str, Severity] = {"error": "error", "fail": "error", "unverified": "error", "skip": "warning"}
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

    Args:
        results: Results of a run.
        places: Places of the cases and limits in the files of the user.

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
        return places.find_baseline(case_id)
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
