"""The summary of a run for the page of a CI job."""

from collections.abc import Sequence

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.certificate_page import build_header
from pantocheck.conformance.pages.criteria_table import NO_BASIS, Basis, describe_criterion, error_name, note_incomplete
from pantocheck.conformance.pages.document_facts import list_administration
from pantocheck.conformance.pages.findings_table import build_findings_section
from pantocheck.conformance.pages.procedure_page import build_procedure_section, list_step_reasons, name_step
from pantocheck.conformance.pages.scope_page import (
    build_scope_section,
    list_identity_warnings,
    list_sources,
    prepare_results,
)
from pantocheck.conformance.pages.two_verdicts import NAMES, build_verdict_section, describe_comparison, list_criteria
from pantocheck.conformance.pages.verdict_reasons import describe_record, list_reasons
from pantocheck.conformance.pages.words import name_verdict
from pantocheck.conformance.results.results_format import CaseResult, Results


def build_summary(results: Results, certificates: Sequence[str] = ()) -> doc.Document:
    """Verdict, reasons and criteria of a run.

    Args:
        results: Results of a run.
        certificates: Names of the certificates in the same folder, which the page links.
    """
    results = prepare_results(results)
    header = build_header(results)
    scope = (*_build_scope(results), *build_findings_section(results))
    facts = (*(list_administration(results.administration) if results.administration else ()), *list_sources(results))
    stated = (doc.Facts(facts),) if facts else ()
    first = (*_link_certificates(certificates), *stated, *doc.warn(list_identity_warnings(results)))
    return doc.Document(
        header.heading, header, (*first, *scope, *list_reasons(results), *map(_case_section, results.cases))
    )


def _link_certificates(names: Sequence[str]) -> tuple[doc.Paragraph, ...]:
    links = [doc.PageLink(name, name) for name in names]
    separated = [part for link in links[1:] for part in (", ", link)]
    return (doc.Paragraph(("Certificate: ", links[0], *separated)),) if links else ()


def _build_scope(results: Results) -> tuple[doc.Section, ...]:
    """Steps of the procedure of a dossier with their own criteria, or the verdicts and the scope of a run."""
    if (procedure := results.procedure) is None:
        return (*build_verdict_section(results), *build_scope_section(results, {}))
    graded = (step for step in procedure.steps if step.criteria)
    sections = (doc.Section(name_step(step), (_criteria(step.criteria),)) for step in graded)
    return (build_procedure_section(procedure, results.cases), *list_step_reasons(procedure), *sections)


def _case_section(case: CaseResult) -> doc.Section:
    blocks: list[doc.Block] = [doc.Paragraph(f"Case {case.id}{': ' + case.reason if case.reason else ''}")]
    if record := describe_record(case):
        blocks.append(doc.Paragraph(record))
    blocks += doc.warn(case.warnings)
    if criteria := list_criteria(case, "criteria"):
        blocks += [_criteria(criteria, case.uncertainty_basis), *note_incomplete(criteria, case.uncertainty_basis)]
    if (verification := case.verification) is not None:
        blocks.append(doc.Paragraph((f"{NAMES['verification']}: ", doc.VerdictMark(verification.verdict))))
        if verification.criteria:
            blocks.append(_criteria(verification.criteria, case.uncertainty_basis))
    if (comparison := case.baseline) is not None:
        mark, text = doc.VerdictMark(comparison.verdict), describe_comparison(comparison)
        blocks.append(doc.Paragraph((f"{NAMES['baseline']}: ", mark, f". {text}")))
        if drifts := list_criteria(case, "baseline"):
            blocks.append(_criteria(drifts, case.uncertainty_basis))
    return doc.Section(f"{name_verdict(case.verdict)}: {case.title}", tuple(blocks))


def _criteria(criteria: Sequence[Criterion], basis: Basis = NO_BASIS) -> doc.Table:
    rows: list[tuple[doc.RichText, ...]] = []
    for criterion in criteria:
        texts = describe_criterion(criterion, basis)
        numbers = (texts.value, texts.error, texts.limits, texts.margin)
        rows.append((texts.label, texts.pantograph, *numbers, doc.VerdictMark(criterion.verdict), texts.trust or "–"))
    numbers = ("Value", error_name(criteria), "Limits", "Margin")
    columns = (
        *map(doc.Column, ("Quantity", "Pantograph")),
        *(doc.Column(heading, number=True) for heading in numbers),
        *map(doc.Column, ("Verdict", "Trust")),
    )
    return doc.Table(columns, tuple(rows))
