"""Pages of a site: all systems, cases and runs; and the history of each case."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.condition_sections import BAND_MARK, CONDITIONED, describe_condition
from pantocheck.conformance.pages.frequency_section import frequency_blocks
from pantocheck.conformance.pages.study_chart import draw_chart, find_common_range
from pantocheck.conformance.pages.verdict_marks import mark_case, mark_results
from pantocheck.conformance.pages.words import clean_text, format_value, name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.supported_frequency import is_supported

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


def order_results(contents: Iterable[tuple[Results, tuple[str, ...]]]) -> list[PublishedResults]:
    """Order results by date and name their folders.

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
    """First page of a site, from results in the order of their dates, and the page of each case by its id."""
    systems = list(dict.fromkeys(run.system for run in published))
    counted = ((systems, "system"), (pages, "case"), (published, "run"))
    headline = f"{', '.join(count_noun(len(items), noun) for items, noun in counted)}."
    blocks: list[doc.Block] = [doc.Paragraph(SITE_STATEMENT)]
    warnings = tuple(
        f"{name_run(run)} {CONTRADICTION.format(count=len(run.discrepancies), first=clean_text(run.discrepancies[0]))}"
        for run in published
        if run.discrepancies
    )
    blocks += doc.warn(warnings)
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
    return (doc.VerdictMark(run.verdict(mark_case(case))), " ", link, *copy)


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
    passed = sum(run.verdict(mark_case(case)) == "pass" for case in cases)
    texts = (run.date.replace("T", " ").rstrip("Z") or "not stated", run.system, run.version)
    return (
        *map(clean_text, texts),
        clean_text(run.results.suite.version),
        doc.VerdictMark(run.verdict(mark_results(run.results))),
        f"{passed} of {len(cases)}",
        doc.PageLink("certificate", f"{run.folder}/certificate.html"),
    )


# Page of a case on a site: its values and verdicts by system and version over time.
HISTORY_QUANTITIES = (
    *("mean_force_N", "std_force_N", "std_force_50_N", "rms_20_50_N"),
    *("max_force_N", "min_force_N", "max_uplift_at_support_mm"),
)
"""Quantities whose history a page shows."""

MOST_TICKS = 12
"""Largest number of runs whose dates stand below a figure."""

Run = tuple[PublishedResults, CaseResult]
"""A run, and its result of the case."""


def build_case_page(case_id: str, published: Sequence[PublishedResults]) -> doc.Document:
    """Page of a case."""
    runs = [(run, case) for run in published for case in run.results.cases if case.id == case_id]
    blocks: list[doc.Block] = [doc.Paragraph((doc.PageLink("All systems and cases", "../index.html"),))]
    blocks.append(doc.Section("Verdicts", (_build_verdict_table(runs),)))
    blocks += map(doc.SmallPrint, dict.fromkeys(filter(None, (describe_condition(case) for _, case in runs))))
    blocks += dict.fromkeys(block for _, case in runs for block in frequency_blocks(case))
    # One run per system has no history: the table shows its values.
    repeated = len(runs) > len({run.system for run, _ in runs})
    for owner in sorted({owner for _, case in runs for owner in case.quantities}, key=int):
        names = [name for name in HISTORY_QUANTITIES if any(_read(case, owner, name) is not None for _, case in runs)]
        if names:
            table = _build_value_table(runs, owner, names)
            figures = doc.Figures(tuple(_draw_history(runs, owner, name) for name in names))
            blocks.append(doc.Section(name_pantograph(owner).capitalize(), (table, figures) if repeated else (table,)))
    return doc.build_plain_document(clean_text(case_id), clean_text(runs[-1][1].title), blocks)


def _read(case: CaseResult, owner: str, name: str) -> float | None:
    """Value of a quantity; None if it is not known."""
    return select_single(case.quantities.get(owner, {}).get(name))


def _build_verdict_table(runs: Sequence[Run]) -> doc.Table:
    columns = (*map(doc.Column, ("Date", "System", "Version", "Verdict")), doc.Column("Reason", share=1))
    rows = tuple(
        (
            run.date[:10] or "not stated",
            clean_text(run.system),
            doc.PageLink(clean_text(run.version) or "certificate", f"../{run.folder}/certificate.html"),
            doc.VerdictMark(run.verdict(mark_case(case))),
            clean_text(run.discrepancies[0] if run.discrepancies else case.reason or ""),
        )
        for run, case in reversed(runs)
    )
    return doc.Table(columns, rows, "The latest run first")


def _build_value_table(runs: Sequence[Run], owner: str, names: Sequence[str]) -> doc.Table:
    marks = {CONDITIONED: f" {BAND_MARK}"} if any(describe_condition(case) for _, case in runs) else {}
    labels = [f"{quantity_label(name)}{marks.get(name, '')} [{quantity_unit(name)}]" for name in names]
    columns = (*map(doc.Column, ("System", "Version")), *(doc.Column(label, number=True) for label in labels))
    rows = tuple(
        (
            clean_text(run.system),
            clean_text(run.version),
            *(_format_cell(case, owner, name) for name in names),
        )
        for run, case in reversed(runs)
    )
    return doc.Table(columns, rows, "Values, the latest run first")


def _format_cell(case: CaseResult, owner: str, name: str) -> doc.RichText:
    """Value of a quantity, grey if its model does not support it."""
    text = format_value(_read(case, owner, name))
    return text if is_supported(case.supported, owner, name) else doc.Muted(text)


def _draw_history(runs: Sequence[Run], owner: str, name: str) -> doc.Figure:
    """Values of a quantity in the order of the runs, one series per system."""
    places: dict[str, tuple[list[float], list[float]]] = {}
    for place, (run, case) in enumerate(runs):
        if (value := _read(case, owner, name)) is not None:
            x, y = places.setdefault(clean_text(run.system), ([], []))
            x.append(float(place))
            y.append(value)
    caption = f"{quantity_label(name)} by run, from the oldest to the latest."
    chart = Chart(
        caption=caption,
        alternative=f"{caption} The values are in the table.",
        x_label="run",
        y_label=f"{quantity_label(name)} [{quantity_unit(name)}]",
        ticks=[run.date[:10] or "no date" for run, _ in runs] if len(runs) <= MOST_TICKS else None,
        series=[Series(label=system, style="points", x=x, y=y) for system, (x, y) in places.items()],
    )
    return doc.Figure(draw_chart(chart, find_common_range([chart])), chart.alternative, caption)
