"""Annotations as workflow commands of GitHub Actions.

A line `::error file=F,line=N,title=T::MESSAGE` that a step prints becomes a remark at this line of the change. Texts
come from files of other people: the escapes of the service keep them inside their field.
"""

from collections.abc import Sequence

from pantocheck.conformance.reports.formats.annotations import Annotation, shorten_path

MOST_SHOWN = 10
"""Largest number of errors, and of warnings, that the service shows of a step."""


def render_workflow_commands(annotations: Sequence[Annotation]) -> bytes:
    """Lines of workflow commands; more annotations than the service shows end in a line with their number.

    Args:
        annotations: Annotations, errors first.

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
