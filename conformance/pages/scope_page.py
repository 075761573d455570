"""Identity and scope of a run on page 1: origin of the cases, weakened limits, steps of the procedure."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeVar

from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.criteria_table import criterion_title
from pantocheck.conformance.pages.two_verdicts import mark_rows
from pantocheck.conformance.pages.words import clean_tree, format_value, name_verdict, read_words, replace_minus
from pantocheck.conformance.quantities.limit_text import format_margin, raises_trust_only
from pantocheck.conformance.results.incomplete_uncertainty import explain_missing, list_unknown
from pantocheck.conformance.results.procedure_format import Procedure, ProcedureStep
from pantocheck.conformance.results.results_format import CaseResult, Results, ScopeStep, name_case

AnyStep = TypeVar("AnyStep", ScopeStep, ProcedureStep)

SCOPE_HEADING = "Scope: steps of the EN 50318 procedure"

CASES_SHOWN = 10
"""Number of cases outside the steps that page 1 names; the table of cases has all."""

SOURCE_LABEL = "Cases from outside the library"

CHANGES_SHOWN = 5
"""Number of weakened limits of a case on page 1; the section of the case shows all."""


def prepare_results(results: Results) -> Results:
    """Results for all pages: cleaned texts, and modified copies of library cases under their full name."""
    cleaned = clean_tree(results)
    names = {case.id: name_case(case.id, case.library) for case in cleaned.cases}
    changes: dict[str, object] = {
        "cases": [_rename_case(case, names[case.id]) for case in cleaned.cases],
        "scope": [_rename_cases(step, names) for step in cleaned.scope],
        "information": [names.get(case, case) for case in cleaned.information],
        "verification_only": [names.get(case, case) for case in cleaned.verification_only],
    }
    if (procedure := cleaned.procedure) is not None:
        steps = [_rename_cases(step, names) for step in procedure.steps]
        changes["procedure"] = procedure.model_copy(update={"steps": steps})
    return cleaned.model_copy(update=changes)


def _rename_case(case: CaseResult, name: str) -> CaseResult:
    title = f"Modified copy: {case.title}" if case.library == "modified" else case.title
    return case.model_copy(update={"id": name, "title": title})


def _rename_cases(step: AnyStep, names: Mapping[str, str]) -> AnyStep:
    return step.model_copy(update={"cases": [names[case] for case in step.cases]})


def list_identity_warnings(results: Results) -> tuple[str, ...]:
    """Warnings on modified copies of library cases, excluded stretches, changed inputs and weakened limits."""
    copies = [
        f"The {case.id} has other inputs, limits or sources than the library {_kind(case)}."
        for case in results.cases
        if case.library == "modified"
    ]
    shorter = [
        f"{case.id}: stretches of the analysis section are left out of the force statistics, as its profile permits."
        for case in results.cases
        if any(event.excluded for event in case.events or ())
    ]
    inputs = [f"{case.id}: {text}." for case in results.cases if (text := describe_changes(case))]
    return (*copies, *shorter, *inputs, *(warn_of_changes(case) for case in results.cases if case.limit_changes))


def summarise_identity(results: Results) -> list[str]:
    """Sentences for the headline on modified copies, changed inputs and weakened limits."""
    copies = sum(case.library == "modified" for case in results.cases)
    changes = [case.limit_changes for case in results.cases if case.limit_changes]
    inputs = sum(bool(case.changes) for case in results.cases)
    sentences = [f"Modified copies of the library: {copies}."] if copies else []
    sentences += [f"Cases with inputs changed with --set: {inputs}."] if inputs else []
    if not changes:
        return sentences
    cases = count_noun(len(changes), "case")
    raised = all(raises_trust_only(change) for stated in changes for change in stated)
    effect = "raises the trust of limits" if raised else "weakens limits or changes their trust"
    return [*sentences, f"The limits file {effect} in {cases}."]


def describe_changes(case: CaseResult) -> str:
    """Inputs of a case that were changed on the command line, without a full stop; empty if there are none."""
    if not case.changes:
        return ""
    limits = "The limits of the library do not apply. " if case.library == "modified" else ""
    return f"{limits}Inputs changed with --set: {'; '.join(case.changes)}"


def warn_of_changes(case: CaseResult) -> str:
    """Warning on the limits of a case that a limits file weakens."""
    changes = case.limit_changes
    more = len(changes) - CHANGES_SHOWN
    shown = [*changes[:CHANGES_SHOWN], *([f"and {more} more"] if more > 0 else [])]
    return f"The limits file changes limits of {case.id}. {'; '.join(shown)}."


def describe_origin(case: CaseResult) -> str:
    """Origin of a case or profile: the library with the edition, a modified copy, or a user; a dash if unknown."""
    kind = _kind(case)
    if case.library != "identical":
        text = {"modified": "modified copy", "own": f"own {kind}", None: "–"}[case.library]
        return f"{text}, {case.origin.text}" if case.origin else text
    edition = f" of {case.edition}" if case.edition else ""
    return f"library {kind}{edition}" + (f", superseded by {case.superseded_by}" if case.superseded_by else "")


def list_sources(results: Results) -> list[tuple[str, str]]:
    """Label and text for each source of cases from outside that took part."""
    cases: dict[tuple[str, str], list[str]] = {}
    for case in results.cases:
        if origin := case.origin:
            cases.setdefault((origin.text, origin.digest), []).append(case.id)
    return [(SOURCE_LABEL, _describe_source(*source, names)) for source, names in cases.items()]


def _describe_source(name: str, digest: str, cases: list[str]) -> str:
    shown, more = cases[:CASES_SHOWN], len(cases) - CASES_SHOWN
    listed = f"{', '.join(shown)}{f' and {more} more' if more > 0 else ''}"
    return f"{name}, {digest}: {listed}. Inputs, limits and their trust are stated by the author of this source."


def _kind(case: CaseResult) -> str:
    return "profile" if case.profile else "case"


def build_scope_section(results: Results, anchors: dict[str, str]) -> tuple[doc.Section, ...]:
    """Table of the steps of the procedure with the verdicts of their cases, linked by the anchors of their sections."""
    if not results.scope:
        return ()
    verdicts = {case.id: mark_rows(case.criteria_verdict or case.verdict, case.criteria) for case in results.cases}
    steps = [step for step in results.scope if step.state != "not done"]
    rows = tuple(_step_row(step, verdicts, anchors) for step in steps)
    columns = (doc.Column("Step", share=2), doc.Column("State"), doc.Column("Cases", share=3))
    table = (doc.Table(columns, rows),) if rows else ()
    sentences = _describe_rest(results, list(verdicts), {step.state for step in steps})
    return (doc.Section(SCOPE_HEADING, (*table, doc.SmallPrint(" ".join(sentences))), anchor="scope"),)


def _step_row(step: ScopeStep, verdicts: Mapping[str, str], anchors: dict[str, str]) -> tuple[doc.RichText, ...]:
    """Step of the procedure, its state, and its cases with their verdicts."""
    cases: list[doc.Inline] = []
    for name in step.cases:
        label = doc.Link(name, anchors[name]) if name in anchors else name
        cases += [", " if cases else "", label]
        if step.state != "informative":  # a verdict belongs to other steps of the case, or to a modified copy
            cases += [" ", doc.VerdictMark(verdicts[name])]
    return read_words()["step"][step.step], step.state, tuple(cases) or "–"


def _describe_rest(results: Results, cases: list[str], states: set[str]) -> Iterator[str]:
    """Sentences on the steps that were not done, on cases outside the steps, and on the states in the table."""
    words = read_words()
    missing = [words["step"][step.step].lower() for step in results.scope if step.state == "not done"]
    if missing:
        yield f"Not done ({words['state']['not done']}): {', '.join(missing)}."
    listed = {name for step in results.scope for name in step.cases}
    if outside := [name for name in cases if name not in listed]:
        shown, more = outside[:CASES_SHOWN], len(outside) - CASES_SHOWN
        yield f"Cases outside these steps: {', '.join(shown)}{f' and {more} more' if more > 0 else ''}."
    yield from (f"{name.capitalize()}: {meaning}." for name, meaning in words["state"].items() if name in states)


# Procedure on page 1 of a certificate: its steps with verdict, margin and uncertainty, and the headline.
PROCEDURE_KEY = (
    "Margin and uncertainty belong to the criterion of the step with the smallest margin. The margin is the distance "
    "to the nearer limit, divided by half the distance between the limits, or by the limit. The uncertainty is the "
    "half-width of the 95 % interval of value and limit together, divided in the same way. With a limit of 0 alone, "
    "both are in the unit of the value. Steps that are not required are for information and have no part in the "
    "verdict. The steps follow the style of EN 50318; the text of the standard is not reproduced."
)


def name_step(step: ProcedureStep) -> str:
    """Step of the procedure in words."""
    return read_words()["procedure"][step.step]


def name_state(step: ProcedureStep) -> str:
    """State of a step in words, with a remark on a step for information."""
    return f"{step.state}{'' if step.required else ', for information'}"


def step_anchor(step: ProcedureStep) -> str:
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
    if results.system.name in results.accepted_unconfirmed:
        sentences.append(f"Accepted by the user: unconfirmed records of {results.system.name}.")
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
    rows = tuple(_build_procedure_row(number, step, cases) for number, step in enumerate(procedure.steps, 1))
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
    yield from (f"{name_step(step)}: {reason}" for reason in (step.reason, step.unconfirmed) if reason)
    for row in step.criteria:
        remarks = [] if row.reason is None else [row.reason]
        for text in (*remarks, *(row.close if row.is_close else ())):
            yield f"{name_step(step)}, {criterion_title(row)}: {text}"


def explain_step_missing(step: ProcedureStep, cases: Sequence[CaseResult]) -> str:
    """Sentence on the components that the uncertainty of a step lacks: those of the case of its smallest margin."""
    named = (case for case in cases if case.id in step.cases and str(step.closest).startswith(f"{case.id}, "))
    missing = next((list_unknown(case.uncertainty_basis) for case in named), ())
    return "" if step.uncertainty is None else explain_missing(missing)


def _build_procedure_row(number: int, step: ProcedureStep, cases: Sequence[CaseResult]) -> tuple[doc.RichText, ...]:
    margin = "–" if step.margin is None else replace_minus(format_margin(step.margin))
    width = step.uncertainty
    lacking = explain_step_missing(step, cases).removesuffix(".")
    texts = [text for text in (step.closest, lacking, step.unconfirmed, step.reason) if text]
    return (
        doc.Link(f"{number} {name_step(step)}", step_anchor(step)),
        name_state(step),
        doc.VerdictMark(step.verdict),
        margin,
        "–" if width is None else format_value(width, 2),
        "; ".join(texts) or "–",
    )
