"""Results on a site: the content of results.json, its contradictions and the place of its certificate."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import clean_text
from pantocheck.conformance.results.results_format import CaseResult, Results

LONGEST_FILE_NAME = 60
"""Longest part of a file name that comes from a name in the results."""


@dataclass(frozen=True)
class PublishedResults:
    """Results of one run on a site."""

    results: Results
    """Results of a run."""
    discrepancies: tuple[str, ...]
    """Contradictions between its numbers and verdicts; none if it is consistent."""
    folder: str
    """Folder of the certificate in the site."""

    @property
    def system(self) -> str:
        """Name of the system."""
        return self.results.system.name

    @property
    def version(self) -> str:
        """Version of the system."""
        return self.results.system.version

    @property
    def date(self) -> str:
        """Date and time of the run; empty if the results state none."""
        return self.results.started or ""

    def verdict(self, stated: str) -> str:
        """Verdict as shown: `error` for results that contradict themselves."""
        return "error" if self.discrepancies else stated


def publish_results(contents: Iterable[tuple[Results, tuple[str, ...]]]) -> list[PublishedResults]:
    """Order results by date and name their folders.

    Args:
        contents: Content of each results.json with its contradictions.

    Returns:
        Results from the oldest to the latest; equal dates keep their order.
    """
    ordered = sorted(contents, key=lambda content: content[0].started or "")
    return [
        PublishedResults(results, discrepancies, f"runs/{number:04d}-{name_file(results.system.name)}")
        for number, (results, discrepancies) in enumerate(ordered, 1)
    ]


def name_file(text: str) -> str:
    """Part of a file name from any text: small letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:LONGEST_FILE_NAME] or "unnamed"


# First page of a site: systems against cases, and all runs.
SITE_STATEMENT = (
    "Every verdict is self-declared, in the style of EN 50318. The site repeats results that were given to it; it does "
    "not show who made them. A verdict belongs to the version of the suite and of the limits that its certificate "
    "states."
)
CONTRADICTION = "contradicts itself: {count} discrepancies, first: {first}"


def build_site_index(title: str, published: Sequence[PublishedResults], pages: Mapping[str, str]) -> doc.Document:
    """First page of a site.

    Args:
        title: Title of the site.
        published: Results from the oldest to the latest.
        pages: Page of each case by its id.
    """
    systems = list(dict.fromkeys(run.system for run in published))
    counted = ((systems, "system"), (pages, "case"), (published, "run"))
    headline = f"{', '.join(count_noun(len(items), noun) for items, noun in counted)}."
    blocks: list[doc.Block] = [doc.Paragraph(SITE_STATEMENT)]
    warnings = tuple(
        f"{name_run(run)} {CONTRADICTION.format(count=len(run.discrepancies), first=clean_text(run.discrepancies[0]))}"
        for run in published
        if run.discrepancies
    )
    if warnings:
        blocks.append(doc.WarningBox(warnings))
    blocks.append(doc.Section("Systems and cases", (_build_matrix(systems, published, pages),)))
    blocks.append(doc.Section("Runs", (_build_run_table(published),)))
    return doc.Document(title, doc.PlainHeader(clean_text(title), headline), tuple(blocks))


def name_run(run: PublishedResults) -> str:
    """Name of a run in a sentence: system, version and date."""
    return clean_text(" ".join(filter(None, (run.system, run.version, f"of {run.date[:10]}" if run.date else ""))))


def find_latest_runs(
    published: Sequence[PublishedResults],
) -> dict[tuple[str, str], tuple[PublishedResults, CaseResult]]:
    """Latest run of each system and case, with its result."""
    return {(run.system, case.id): (run, case) for run in published for case in run.results.cases}


def _build_matrix(systems: Sequence[str], published: Sequence[PublishedResults], pages: Mapping[str, str]) -> doc.Table:
    latest = find_latest_runs(published)
    rows = tuple(
        (doc.PageLink(clean_text(case), page), *(_describe_cell(latest.get((system, case))) for system in systems))
        for case, page in pages.items()
    )
    columns = (doc.Column("Case"), *(doc.Column(clean_text(system), share=1) for system in systems))
    return doc.Table(columns, rows, "Verdict of the latest run of each system; the version leads to its certificate")


def _describe_cell(found: tuple[PublishedResults, CaseResult] | None) -> doc.RichText:
    if found is None:
        return "–"
    run, case = found
    copy: tuple[doc.Inline, ...] = (doc.Remark("modified copy"),) if case.library == "modified" else ()
    link = doc.PageLink(clean_text(run.version) or "certificate", f"{run.folder}/certificate.html")
    return (doc.VerdictMark(run.verdict(case.verdict)), " ", link, *copy)


def _build_run_table(published: Sequence[PublishedResults]) -> doc.Table:
    columns = (
        *map(doc.Column, ("Date", "System", "Version", "Suite", "Verdict")),
        doc.Column("Cases with the verdict pass", share=1),
        doc.Column("Certificate"),
    )
    rows = tuple(_describe_run(run) for run in reversed(published))
    return doc.Table(columns, rows, "All runs, the latest first")


def _describe_run(run: PublishedResults) -> tuple[doc.RichText, ...]:
    cases = run.results.cases
    passed = sum(run.verdict(case.verdict) == "pass" for case in cases)
    texts = (run.date.replace("T", " ").rstrip("Z") or "not stated", run.system, run.version)
    return (
        *map(clean_text, texts),
        clean_text(run.results.suite.version),
        doc.VerdictMark(run.verdict(run.results.verdict)),
        f"{passed} of {len(cases)}",
        doc.PageLink("certificate", f"{run.folder}/certificate.html"),
    )
