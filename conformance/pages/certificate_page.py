"""The certificate: from results.json to a document. Every number of the page stands in the results."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_section import ShownCase, build_case_section, list_shown_cases
from pantocheck.conformance.pages.condition_sections import condition_blocks, mark_values
from pantocheck.conformance.pages.criteria_table import (
    MARGIN_KEY,
    NO_BASIS,
    Basis,
    describe_criterion,
    error_name,
    mark_criterion,
    state_causes,
)
from pantocheck.conformance.pages.document import digest_results, find_date
from pantocheck.conformance.pages.document_facts import list_administration, list_suite_facts, name_suite, name_system
from pantocheck.conformance.pages.findings_table import build_findings_section
from pantocheck.conformance.pages.first_page import (
    MOST_CASES,
    build_answers,
    build_case_index,
    has_more_reasons,
    list_reason_sections,
    plan_first_page,
)
from pantocheck.conformance.pages.quantity_tables import SHIFT_KEY, UNCERTAINTY_KEY, list_definitions
from pantocheck.conformance.pages.scope_page import (
    PROCEDURE_KEY,
    build_step_table,
    explain_states,
    list_dossier_facts,
    list_identity_warnings,
    list_scope,
    list_sources,
    list_step_reasons,
    name_step,
    prepare_results,
)
from pantocheck.conformance.pages.step_sections import build_step_section
from pantocheck.conformance.pages.two_verdicts import build_verdict_section, describe_comparison
from pantocheck.conformance.pages.verdict_marks import NAMES, list_criteria, mark_case, mark_results, mark_rows
from pantocheck.conformance.pages.verdict_reasons import (
    CHANCE_KEY,
    build_headline,
    describe_record,
    describe_rule,
    list_reasons,
    state_decision,
    state_incomplete,
)
from pantocheck.conformance.pages.words import name_verdict, read_words
from pantocheck.conformance.results.results_format import CaseResult, Results

HEADING = "Conformance report"


def build_certificate(results: Results) -> doc.Document:
    """The certificate of a run, with the date of `find_date`."""
    return build_dated_certificate(results, find_date(results))


def build_dated_certificate(results: Results, date: int) -> doc.Document:
    """The certificate of a run with a given date [s since 1970]; 0: not known."""
    prepared = prepare_results(results)
    header, cases, first_page = build_header(prepared), prepared.cases, plan_first_page(prepared)
    shown = list_shown_cases(cases, first_page)
    anchors = {one.case.id: one.anchor for one in shown}
    answers = build_answers(prepared, anchors, first_page, (digest_results(results), date))
    reasons = list_reason_sections(prepared) if has_more_reasons(prepared) else ()
    return doc.Document(
        title=f"{name_verdict(header.verdict)} – {HEADING} – {name_system(prepared)}",
        header=replace(header, subject=""),
        blocks=(
            *doc.warn(list_identity_warnings(prepared)),
            answers,
            *build_findings_section(prepared),
            *((doc.Section("Reasons", reasons, anchor="reasons"),) if reasons else ()),
            *_build_index(prepared, anchors),
            *_build_case_sections(prepared, shown, anchors),
            doc.Section("Explanations", _explanation_blocks(prepared), anchor="explanations"),
            doc.Section("Reproducibility", (list_suite_facts(prepared),), anchor="reproducibility"),
        ),
        results=results,
        date=date,
    )


def _build_index(results: Results, anchors: dict[str, str]) -> tuple[doc.Section, ...]:
    """List of many cases; page 1 has that of a few, and with a procedure, each step lists its own."""
    if results.procedure is not None or len(results.cases) <= MOST_CASES:
        return ()
    return (doc.Section("Cases", (build_case_index(results.cases, anchors),), anchor="cases"),)


def _build_case_sections(results: Results, shown: list[ShownCase], anchors: dict[str, str]) -> tuple[doc.Section, ...]:
    """Sections of the cases; with a procedure, behind the section of their step."""
    sections = {one.case.id: build_case_section(one) for one in shown}
    by_id = {case.id: case for case in results.cases}
    if results.procedure is None:
        return tuple(sections.values())
    ordered: list[doc.Section] = []
    for number, step in enumerate(results.procedure.steps, 1):
        listed = [by_id[name] for name in step.cases]
        index = (build_case_index(listed, anchors),) if listed else ()
        ordered += [build_step_section(number, step, results.procedure, results.cases, index)]
        ordered += [sections[name] for name in step.cases if name in sections]
    return tuple(ordered)


def build_header(results: Results) -> doc.VerdictHeader:
    """Head of the pages made from results.json."""
    level = read_words()["trust"].get(results.trust)
    system, suite = name_system(results), name_suite(results)
    title = "" if results.procedure is None else f"{results.procedure.title}. "
    trust = f" Lowest trust of the limits that count: {results.trust} ({level['meaning']})." if level else ""
    return doc.VerdictHeader(
        heading=HEADING,
        verdict=mark_results(results),
        statement=results.statement,
        headline=build_headline(results),
        subject=" ".join(
            filter(
                None,
                (f"{title}{system}, checked with {suite}.{trust}", state_decision(results), state_incomplete(results)),
            )
        ),
        footer=f"{suite} · {system}",
    )


def _explanation_blocks(results: Results) -> tuple[doc.Block, ...]:
    """Meaning of margins, uncertainties, trust and definitions, once for all cases."""
    trusts = read_words()["trust"].items()
    levels = doc.BulletList(tuple((doc.TrustMark(name), f": {level['meaning']}") for name, level in trusts))
    graded = any(case.criteria for case in results.cases)
    uncertain = any(case.uncertainty_basis for case in results.cases)
    definitions = list_definitions(results.cases)
    verdicts = build_verdict_section(results) if results.procedure is None else ()
    return (
        doc.SmallPrint(f"Decision rule: {describe_rule(results)}."),
        *((doc.SmallPrint(CHANCE_KEY),) if results.conformity is not None else ()),
        *(block for section in verdicts for block in section.blocks[1:]),
        *((doc.SmallPrint(states),) if (states := explain_states(results)) else ()),
        *((doc.SmallPrint(PROCEDURE_KEY),) if results.procedure is not None else ()),
        *((doc.SmallPrint(MARGIN_KEY),) if graded else ()),
        *((doc.SmallPrint(UNCERTAINTY_KEY),) if uncertain else ()),
        *((doc.SmallPrint(SHIFT_KEY),) if any(any(case.spread.values()) for case in results.cases) else ()),
        doc.Section("Levels of trust", (levels,)),
        *((doc.Section("Definitions", (doc.BulletList(definitions),)),) if definitions else ()),
    )


# The summary of a run for the page of a CI job.
def build_summary(results: Results, certificates: Sequence[str] = ()) -> doc.Document:
    """Verdict, reasons and criteria of a run; `certificates` are names in the same folder, which the page links."""
    results = prepare_results(results)
    header = build_header(results)
    scope = (*_build_summary_scope(results), *build_findings_section(results))
    facts = (*(list_administration(results.administration) if results.administration else ()), *list_sources(results))
    stated = (doc.Facts(facts),) if facts else ()
    first = (*_link_certificates(certificates), *stated, *doc.warn(list_identity_warnings(results)))
    return doc.Document(
        header.heading, header, (*first, *scope, *list_reasons(results), *map(_build_case_summary, results.cases))
    )


def _link_certificates(names: Sequence[str]) -> tuple[doc.Paragraph, ...]:
    links = [doc.PageLink(name, name) for name in names]
    separated = [part for link in links[1:] for part in (", ", link)]
    return (doc.Paragraph(("Certificate: ", links[0], *separated)),) if links else ()


def _build_summary_scope(results: Results) -> tuple[doc.Block, ...]:
    """Steps of the procedure of a dossier with their own criteria, or the verdicts and the scope of a run."""
    if (procedure := results.procedure) is None:
        scope = (doc.Facts(tuple(list_scope(results).items())),) if results.scope else ()
        return (*scope, *build_verdict_section(results))
    graded = (step for step in procedure.steps if step.criteria)
    sections = (doc.Section(name_step(step), (_build_summary_table(step.criteria),)) for step in graded)
    facts, table = doc.Facts(list_dossier_facts(procedure)), build_step_table(procedure, results.cases)
    return (facts, table, doc.SmallPrint(PROCEDURE_KEY), *list_step_reasons(procedure), *sections)


def _build_case_summary(case: CaseResult) -> doc.Section:
    blocks: list[doc.Block] = [doc.Paragraph(f"Case {case.id}{': ' + case.reason if case.reason else ''}")]
    if record := describe_record(case):
        blocks.append(doc.Paragraph(record))
    blocks += doc.warn(case.warnings)
    blocks += condition_blocks(case)
    if criteria := list_criteria(case, "criteria"):
        blocks += [*state_causes(criteria), _build_summary_table(criteria, case.uncertainty_basis)]
    if (verification := case.verification) is not None:
        mark = doc.VerdictMark(mark_rows(verification.verdict, verification.criteria))
        blocks.append(doc.Paragraph((f"{NAMES['verification']}: ", mark)))
        if verification.criteria:
            blocks.append(_build_summary_table(verification.criteria, case.uncertainty_basis))
    if (comparison := case.baseline) is not None:
        mark, text = doc.VerdictMark(comparison.verdict), describe_comparison(comparison)
        blocks.append(doc.Paragraph((f"{NAMES['baseline']}: ", mark, f". {text}")))
        if drifts := list_criteria(case, "baseline"):
            blocks.append(_build_summary_table(drifts, case.uncertainty_basis))
    return doc.Section(f"{name_verdict(mark_case(case))}: {case.title}", mark_values(case, blocks))


def _build_summary_table(criteria: Sequence[Criterion], basis: Basis = NO_BASIS) -> doc.Table:
    rows: list[tuple[doc.RichText, ...]] = []
    for criterion in criteria:
        texts = describe_criterion(criterion, basis)
        numbers = (texts.value, texts.error, texts.limits, texts.margin)
        rows.append((texts.label, texts.pantograph, *numbers, mark_criterion(criterion), texts.trust or "–"))
    numbers = ("Value", error_name(criteria), "Limits", "Margin")
    columns = (
        *map(doc.Column, ("Quantity", "Pantograph")),
        *(doc.Column(heading, number=True) for heading in numbers),
        *map(doc.Column, ("Verdict", "Trust")),
    )
    return doc.Table(columns, tuple(rows))
