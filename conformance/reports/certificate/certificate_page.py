"""The certificate: from results.json to a document. Every number of the page stands in the results."""

from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.case_facts import (
    list_case_facts,
    list_suite_facts,
    name_suite,
    name_system,
)
from pantocheck.conformance.reports.certificate.case_figures import draw_case_figures
from pantocheck.conformance.reports.certificate.comparison_section import comparison_blocks
from pantocheck.conformance.reports.certificate.criteria_table import criteria_blocks
from pantocheck.conformance.reports.certificate.document_facts import build_document_section
from pantocheck.conformance.reports.certificate.event_section import event_blocks
from pantocheck.conformance.reports.certificate.findings_table import build_findings_section
from pantocheck.conformance.reports.certificate.procedure_page import build_procedure_section, list_step_reasons
from pantocheck.conformance.reports.certificate.quantity_tables import (
    build_band_table,
    build_quantity_table,
    list_definitions,
    list_skipped,
)
from pantocheck.conformance.reports.certificate.reference_values import reference_note
from pantocheck.conformance.reports.certificate.scope_page import (
    build_scope_section,
    describe_changes,
    describe_origin,
    list_identity_warnings,
    prepare_results,
)
from pantocheck.conformance.reports.certificate.step_sections import build_step_section
from pantocheck.conformance.reports.certificate.two_verdicts import (
    build_verdict_section,
    case_verdict,
    verification_blocks,
)
from pantocheck.conformance.reports.certificate.uncertainty_table import uncertainty_blocks
from pantocheck.conformance.reports.certificate.verdict_reasons import (
    build_headline,
    describe_record,
    list_reasons,
    summarise_case,
)
from pantocheck.conformance.reports.formats.embedded_results import digest_results
from pantocheck.conformance.reports.formats.reproducibility import find_date
from pantocheck.conformance.reports.words import read_words

HEADING = "Conformance report"


def build_certificate(results: dict[str, Any]) -> doc.Document:
    """The certificate of a run, from results.json as a dictionary, with the date of `find_date`."""
    return build_dated_certificate(results, find_date(results))


def build_dated_certificate(results: dict[str, Any], date: int) -> doc.Document:
    """The certificate of a run with a given date.

    Parameters
    ----------
    results : dict
        Content of results.json.
    date : int
        Date of the document [s since 1970]; 0: not known.
    """
    prepared = prepare_results(results)
    header = build_header(prepared)
    cases = prepared["cases"]
    anchors = [f"case-{number}" for number in range(1, len(cases) + 1)]
    warnings = list_identity_warnings(prepared)
    steps = list_step_reasons(prepared) if "procedure" in prepared else ()
    reasons = (*steps, *list_reasons(prepared)) or (doc.Paragraph("Nothing was graded."),)
    trusts = read_words()["trust"].items()
    levels = doc.BulletList(tuple((doc.TrustMark(name), f": {level['meaning']}") for name, level in trusts))
    closing = doc.Paragraph(f"This is a {header.statement}. It is not a certification by a third party.")
    return doc.Document(
        title=f"{read_words()['verdict'][header.verdict]['word']} – {HEADING} – {name_system(prepared)}",
        header=header,
        blocks=(
            *((doc.WarningBox(warnings),) if warnings else ()),
            build_document_section(prepared, digest_results(results), date),
            *_build_scope(prepared, anchors),
            *build_findings_section(prepared),
            doc.Section("Reasons", reasons, anchor="reasons"),
            *_build_index(prepared, anchors),
            *_build_case_sections(prepared, anchors),
            doc.Section(
                "Reproducibility",
                (list_suite_facts(prepared), doc.Section("Levels of trust", (levels,)), closing),
                anchor="reproducibility",
            ),
        ),
        results=results,
        date=date,
    )


def _build_scope(results: dict[str, Any], anchors: list[str]) -> tuple[doc.Section, ...]:
    """Steps of the procedure of a dossier, or the verdicts and the scope of a run."""
    if "procedure" in results:
        return (build_procedure_section(results),)
    links = dict(zip((case["id"] for case in results["cases"]), anchors, strict=True))
    return (*build_verdict_section(results), *build_scope_section(results, links))


def _build_index(results: dict[str, Any], anchors: list[str]) -> tuple[doc.Section, ...]:
    """List of the cases; with a procedure, each step lists its own."""
    if "procedure" in results:
        return ()
    return (doc.Section("Cases", (_case_index(results["cases"], anchors),), anchor="cases"),)


def _build_case_sections(results: dict[str, Any], anchors: list[str]) -> tuple[doc.Section, ...]:
    """Sections of the cases; with a procedure, behind the section of their step."""
    numbered = enumerate(zip(results["cases"], anchors, strict=True))
    sections = {case["id"]: _case_section(number, case, anchor) for number, (case, anchor) in numbered}
    by_id = {case["id"]: (case, anchor) for case, anchor in zip(results["cases"], anchors, strict=True)}
    if "procedure" not in results:
        return tuple(sections.values())
    ordered: list[doc.Section] = []
    for number, step in enumerate(results["procedure"]["steps"], 1):
        listed = [by_id[name] for name in step["cases"]]
        index = (_case_index([case for case, _ in listed], [anchor for _, anchor in listed]),) if listed else ()
        ordered += [build_step_section(number, step, results, index), *(sections[name] for name in step["cases"])]
    return tuple(ordered)


def build_header(results: dict[str, Any]) -> doc.VerdictHeader:
    """Head of the pages made from results.json."""
    level = read_words()["trust"].get(results["trust"])
    system, suite = name_system(results), name_suite(results)
    title = f"{results['procedure']['title']}. " if "procedure" in results else ""
    trust = f" Lowest trust of the limits that count: {results['trust']} ({level['meaning']})." if level else ""
    return doc.VerdictHeader(
        heading=HEADING,
        verdict=results["verdict"],
        statement=results["statement"],
        headline=build_headline(results),
        subject=f"{title}{system}, checked with {suite}.{trust}",
        footer=f"{suite} · {system}",
    )


def _case_index(cases: list[dict[str, Any]], anchors: list[str]) -> doc.Table:
    shares = {"Case": 2.0, "Origin": 2.0, "Verdict": 0.0, "Criteria": 3.0}
    rows: tuple[tuple[doc.RichText, ...], ...] = tuple(
        (
            doc.Link(case["id"], anchor),
            describe_origin(case),
            doc.VerdictMark(case_verdict(case, "criteria") or ""),
            summarise_case(case),
        )
        for case, anchor in zip(cases, anchors, strict=True)
    )
    if any(case["verification"] for case in cases):
        shares["Verification"] = 0.0
        rows = tuple((*row, _verification_mark(case)) for row, case in zip(rows, cases, strict=True))
    return doc.Table(tuple(doc.Column(heading, share) for heading, share in shares.items()), rows)


def _verification_mark(case: dict[str, Any]) -> doc.RichText:
    verdict = case_verdict(case, "verification")
    return "–" if verdict is None else doc.VerdictMark(verdict)


def _case_section(number: int, case: dict[str, Any], anchor: str) -> doc.Section:
    blocks: list[doc.Block] = [
        doc.Paragraph((doc.VerdictMark(case["verdict"]), "\N{EN SPACE}", doc.Code(case["id"]))),
        doc.Paragraph(summarise_case(case)),
    ]
    if record := describe_record(case):
        blocks.append(doc.Paragraph(record))
    changes = [f"{text}."] if (text := describe_changes(case)) else []
    warnings = (*changes, *(f"Limits file: {change}." for change in case["limit_changes"]), *case["warnings"])
    if warnings:
        blocks.append(doc.WarningBox(warnings))
    blocks += reference_note(case)
    if case["criteria"]:
        blocks.append(doc.Section("Criteria", criteria_blocks(case, anchor, f"{anchor}-source")))
    blocks += verification_blocks(case, anchor)
    blocks += comparison_blocks(case, number, anchor)
    blocks += event_blocks(case)
    blocks += [doc.Section(table["caption"], (_study_table(table),)) for table in case["tables"]]
    bands, quantities = build_band_table(case), build_quantity_table(case)
    if bands.rows:
        blocks.append(doc.Section("Extended band, up to 50 Hz", (bands,)))
    figures = tuple(draw_case_figures(case, number, anchor))
    if figures:
        blocks.append(doc.Section("Figures", (doc.Figures(figures),)))
    if quantities.rows:
        blocks.append(doc.Section("All quantities", (quantities,), folded=True))
    if case["uncertainty_basis"]:
        blocks.append(doc.Section("Uncertainty by component", uncertainty_blocks(case), folded=True))
    if definitions := list_definitions(case):
        blocks.append(doc.Section("Definitions", (doc.BulletList(definitions),), folded=True))
    for heading, sentences in (("Skipped", list_skipped(case)), ("Notes", tuple(case["notes"]))):
        if sentences:
            blocks.append(doc.Section(heading, (doc.BulletList(sentences),), folded=True))
    if case["inputs"]:
        blocks.append(doc.Section("Inputs", (_input_table(case["inputs"]),), folded=True))
    blocks.append(doc.Section("Run", (list_case_facts(case),), folded=True))
    return doc.Section(case["title"], tuple(blocks), anchor=anchor, new_page=True)


def _study_table(table: dict[str, Any]) -> doc.Table:
    names = table["columns"]
    shares = (2.0, 0.0, 3.0) if len(names) <= 3 else (2.0, *(1.0 for _ in names[1:]))
    columns = tuple(doc.Column(name, share) for name, share in zip(names, shares, strict=False))
    return doc.Table(columns, tuple(map(tuple, table["rows"])))


def _input_table(inputs: list[dict[str, Any]]) -> doc.Table:
    rows = tuple((doc.Code(group["group"]), doc.TrustMark(group["trust"]), group["source"]) for group in inputs)
    return doc.Table((doc.Column("Group", share=1), doc.Column("Trust"), doc.Column("Source", share=3)), rows)
