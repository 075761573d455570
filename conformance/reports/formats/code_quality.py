"""Annotations as a code quality report of GitLab: a JSON list, shown beside the lines of a merge request."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

from pydantic import JsonValue

from pantocheck.conformance.reports.formats.annotations import Annotation, Severity, shorten_path
from pantocheck.conformance.results.file_places import FilePlace

GITLAB_SEVERITIES: dict[Severity, str] = {"error": "critical", "warning": "minor"}
"""Severity of GitLab for each severity of an annotation."""


def render_code_quality(annotations: Sequence[Annotation], fallback: Path) -> bytes:
    """Code quality report.

    Args:
        annotations: Annotations.
        fallback: File that stands for an unknown place, because the service requires one: results.json.

    Returns:
        JSON in UTF-8.
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
