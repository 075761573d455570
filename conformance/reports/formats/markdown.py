"""The summary of a run in Markdown, for the page of a CI job."""

import re
from pathlib import Path
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.reports.certificate import case_facts as facts
from pantocheck.conformance.reports.certificate import verdict_reasons as reasons
from pantocheck.conformance.reports.certificate.certificate_page import error_name
from pantocheck.conformance.reports.certificate.criteria_rows import build_criterion_row
from pantocheck.conformance.reports.page_text import clean_tree
from pantocheck.conformance.reports.words import TEMPLATES, read_words

# Everything that means something in GitHub's or GitLab's Markdown, mentions (@) and references (#, !) included.
SPECIAL = re.compile(r"([\\`*_{}\[\]()#+!|~$@])")


def write_markdown(results: dict[str, Any], path: Path) -> None:
    """Write `summary.md`.

    Parameters
    ----------
    results : dict[str, Any]
        results.json as a dictionary.
    path : Path
        The file to write.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_atomically(path, render_markdown(results).encode("utf-8"))


def render_markdown(results: dict[str, Any]) -> str:
    """The Markdown text; whatever the template prints is escaped."""
    results = clean_tree(results)
    environment = Environment(
        loader=FunctionLoader(lambda name: (TEMPLATES / name).read_text("utf-8")),
        autoescape=False,  # HTML's escaping does not suit Markdown: `finalize` escapes every printed value instead
        finalize=escape_markdown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("summary.md").render(
        results=results,
        headline=reasons.build_headline(results),
        reasons=reasons.build_reasons(results),
        system=facts.name_system(results),
        suite=facts.name_suite(results),
        cases=[
            (case, [build_criterion_row(row, []) for row in case["criteria"]], error_name(case))
            for case in results["cases"]
        ],
        words={name: of["word"] for name, of in read_words()["verdict"].items()},
    )


def escape_markdown(value: Any) -> str:
    """Text that Markdown shows as it is, in a table as well."""
    text = str(value).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    text = SPECIAL.sub(r"\\\1", text)
    # Bare addresses and the start of a list would still be taken as markup.
    return re.sub(r"(?i)(https?|ftp)://", r"\1:&#8203;//", text).replace("www.", "www&#8203;.")
