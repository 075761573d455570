"""Failed criteria at the lines of the files that state their limits, for the page of a change."""

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import JsonValue

from pantocheck.conformance.pages.junit import GradedTest, list_case_tests, list_step_tests
from pantocheck.conformance.pages.scope_page import prepare_results
from pantocheck.conformance.pages.verdict_reasons import build_headline
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


# Annotations as a code quality report of GitLab: a JSON list, shown beside the lines of a merge request.
GITLAB_SEVERITIES: dict[Severity, str] = {"error": "critical", "warning": "minor"}
"""Severity of GitLab for each severity of an annotation."""


def render_code_quality(annotations: Sequence[Annotation], fallback: Path) -> bytes:
    """Code quality report.

    Args:
        annotations: Annotations.
        fallback: File that stands for an unknown place, because the service requires one: results.json.
    """
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
        lines += map(_render, shown)
        if rest := len(of_severity) - len(shown):
            lines.append(f"::{severity} title=pantocheck::{rest} more are in the summary and in the certificate")
    return "".join(f"{line}\n" for line in lines).encode("utf-8", "replace")


def _render(annotation: Annotation) -> str:
    properties = {}
    if annotation.place is not None:
        properties["file"] = shorten_path(annotation.place.path)
        if annotation.place.line is not None:
            properties["line"] = str(annotation.place.line)
    properties["title"] = f"{annotation.group}: {annotation.name}"
    stated = ",".join(f"{name}={_escape_property(text)}" for name, text in properties.items())
    return f"::{annotation.severity} {stated}::{_escape_message(annotation.text)}"


def _escape_message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _escape_property(text: str) -> str:
    return _escape_message(text).replace(":", "%3A").replace(",", "%2C")
