"""Procedure on page 1 of a certificate: its steps with verdict, margin and uncertainty, and the headline."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.criteria_table import criterion_title
from pantocheck.conformance.pages.words import format_value, name_verdict, read_words, replace_minus
from pantocheck.conformance.quantities.limit_text import format_margin
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown, mark_half_width
from pantocheck.conformance.results.procedure_format import Procedure, ProcedureStep
from pantocheck.conformance.results.results_format import CaseResult, Results

PROCEDURE_KEY = (
    "Margin and uncertainty belong to the criterion of the step with the smallest margin. The margin is the distance "
    "to the nearer limit, divided by half the distance between the limits, or by the limit. The uncertainty is the "
    "half-width of the 95 % interval of value and limit together, divided in the same way; an asterisk marks one that "
    "lacks a component that is not known. With a limit of 0 alone, both are in the unit of the value. Steps that are "
    "not required are for information and have no part in the verdict. The steps follow the style of EN 50318; the "
    "text of the standard is not reproduced."
)


def name_step(step: ProcedureStep) -> str:
    """Step of the procedure in words."""
    return read_words()["procedure"][step.step]


def name_state(step: ProcedureStep) -> str:
    """State of a step in words, with a remark on a step for information."""
    return f"{step.state}{'' if step.required else ', for information'}"


def anchor_step(step: ProcedureStep) -> str:
    """Anchor of the section of a step."""
    return f"step-{step.step.replace('_', '-')}"


def build_procedure_headline(results: Results, procedure: Procedure) -> str:
    """Verdict of a dossier in sentences: required steps that pass, and those that do not."""
    required = [step for step in procedure.steps if step.required]
    others = [step for step in procedure.steps if not step.required]
    passed = sum(step.verdict == "pass" for step in required)
    sentences = [f"{passed} of {len(required)} required steps pass."]
    for step in required:
        if step.verdict != "pass":
            state = "not done" if step.state == "not done" else name_verdict(step.verdict)
            sentences.append(f"{name_step(step)}: {state}.")
    if others:
        names = ", ".join(f"{name_step(step)} ({name_verdict(step.verdict)})" for step in others)
        sentences.append(f"Not required, for information: {names}.")
    if results.system.name in results.accepted_unverified:
        sentences.append(f"Accepted by the user: unverified records of {results.system.name}.")
    return " ".join(sentences)


def build_procedure_section(procedure: Procedure, cases: Sequence[CaseResult]) -> doc.Section:
    """Table of the steps in the order of the procedure."""
    columns = (
        doc.Column("Step", share=2),
        doc.Column("State", share=1),
        doc.Column("Verdict"),
        doc.Column("Margin", number=True),
        doc.Column("±", number=True),
        doc.Column("Smallest margin of, or reason", share=4),
    )
    rows = tuple(_build_row(number, step, cases) for number, step in enumerate(procedure.steps, 1))
    facts = [("Digest of the dossier", procedure.digest)]
    if note := procedure.note:
        facts.append(("Note", note))
    blocks = (doc.Table(columns, rows), doc.SmallPrint(PROCEDURE_KEY), doc.Facts(tuple(facts)))
    return doc.Section("Steps of the procedure", blocks, anchor="procedure")


def list_step_reasons(procedure: Procedure) -> tuple[doc.Section, ...]:
    """Section on the steps that do not pass or are close to a limit; none if there are no such steps."""
    sentences = tuple(describe_steps(procedure))
    return (doc.Section("Steps", (doc.BulletList(sentences),)),) if sentences else ()


def describe_steps(procedure: Procedure) -> Iterator[str]:
    """Steps and their own criteria that do not pass or are close to a limit, and claims that are not verified."""
    for step in procedure.steps:
        yield from _describe_step(step)
    for claim in procedure.claims:
        if claim.reason:
            subject = f"{read_words()['claim'][claim.kind]} {claim.name}".strip()
            yield f"Claim not verified: {subject}: {claim.reason}"


def _describe_step(step: ProcedureStep) -> Iterator[str]:
    yield from (f"{name_step(step)}: {reason}" for reason in (step.reason, step.unverified) if reason)
    for row in step.criteria:
        remarks = [] if row.reason is None else [row.reason]
        for text in (*remarks, *(row.close if row.is_close else ())):
            yield f"{name_step(step)}, {criterion_title(row)}: {text}"


def list_step_missing(step: ProcedureStep, cases: Sequence[CaseResult]) -> tuple[str, ...]:
    """Components that the uncertainty of a step lacks: those of the case of its smallest margin."""
    named = (case for case in cases if case.id in step.cases and _is_closest(step, case.id))
    return next((list_unknown(case.uncertainty_basis) for case in named), ())


def _is_closest(step: ProcedureStep, case: str) -> bool:
    return str(step.closest).startswith(f"{case}, ")


def _build_row(number: int, step: ProcedureStep, cases: Sequence[CaseResult]) -> tuple[doc.RichText, ...]:
    margin = "–" if step.margin is None else replace_minus(format_margin(step.margin))
    width = step.uncertainty
    missing = list_step_missing(step, cases)
    texts = [text for text in (step.closest, step.unverified, step.reason) if text]
    return (
        doc.Link(f"{number} {name_step(step)}", anchor_step(step)),
        name_state(step),
        doc.VerdictMark(step.verdict),
        margin,
        "–" if width is None else mark_half_width(width, format_value(width, 2), missing),
        "; ".join(texts) or "–",
    )
