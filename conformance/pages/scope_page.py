"""Identity and scope of a run on page 1: origin of the cases, weakened limits, steps of the procedure."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeVar

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.criteria_table import DECIDES, count_inside, criterion_title
from pantocheck.conformance.pages.verdict_marks import count_close, mark_rows
from pantocheck.conformance.pages.words import clean_tree, format_plain, name_verdict, read_words
from pantocheck.conformance.quantities.limit_text import raises_trust_only
from pantocheck.conformance.results.incomplete_uncertainty import explain_missing, list_unknown
from pantocheck.conformance.results.procedure_format import Procedure, ProcedureStep, ValidityClaim
from pantocheck.conformance.results.results_format import CaseResult, Results, ScopeStep, name_case

AnyStep = TypeVar("AnyStep", ScopeStep, ProcedureStep)

CASES_SHOWN = 10
"""Number of cases of a step or source that page 1 names; the table of cases has all."""

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
    author = "Inputs, limits and their trust are stated by the author of this source."
    return f"{name}, {digest}: {shorten_names(cases)}. {author}"


def _kind(case: CaseResult) -> str:
    return "profile" if case.profile else "case"


def list_scope(results: Results) -> dict[str, str]:
    """Steps of the procedure with their cases by state, and cases outside the steps, as facts; empty without steps."""
    states: dict[str, list[str]] = {}
    for step in results.scope:
        name = read_words()["step"][step.step]
        states.setdefault(step.state, []).append(f"{name}: {shorten_names(step.cases)}" if step.cases else name)
    facts = {f"Steps {state}": "; ".join(states[state]) for state in read_words()["state"] if state in states}
    listed = {name for step in results.scope for name in step.cases}
    outside = [case.id for case in results.cases if case.id not in listed] if results.scope else []
    return facts | ({"Cases outside these steps": shorten_names(outside)} if outside else {})


def shorten_names(cases: list[str]) -> str:
    """Names of cases; of many, the first with the number of the others."""
    more = len(cases) - CASES_SHOWN
    return f"{', '.join(cases[:CASES_SHOWN])}{f' and {more} more' if more > 0 else ''}"


def explain_states(results: Results) -> str:
    """Meaning of the states of the steps."""
    states = {step.state for step in results.scope}
    return " ".join(f"Steps {name}: {text}." for name, text in read_words()["state"].items() if name in states)


# Procedure on page 1 of a certificate: its steps with verdict, margin and uncertainty, and the headline.
PROCEDURE_KEY = (
    "Page 1 has the value with the smallest margin of each step; a declared value that equals its bound has none. "
    "Steps that are not required are for information and have no part in the verdict. The steps follow the style of "
    "EN 50318; the text of the standard is not reproduced."
)


def name_step(step: ProcedureStep) -> str:
    """Step of the procedure in words."""
    return read_words()["procedure"][step.step]


def name_state(step: ProcedureStep) -> str:
    """State of a step in words, with a remark on a step for information."""
    return f"{step.state}{'' if step.required else ', for information'}"


def mark_step(step: ProcedureStep, cases: Sequence[CaseResult]) -> str:
    """Mark of a step: of its own criteria and of those of its cases."""
    rows = [row for case in cases if case.id in step.cases for row in case.criteria]
    return mark_rows(step.verdict, [*step.criteria, *rows])


def step_anchor(step: ProcedureStep) -> str:
    """Anchor of the section of a step."""
    return f"step-{step.step.replace('_', '-')}"


def build_procedure_headline(results: Results, procedure: Procedure) -> str:
    """Verdict of a dossier in sentences: required steps that pass, and those that do not."""
    required = [step for step in procedure.steps if step.required]
    others = [step for step in procedure.steps if not step.required]
    passed = sum(step.verdict == "pass" for step in required)
    close = count_close(results)
    near = f", {count_noun(close, 'value')} close to a limit" if close else ""
    sentences = [f"{passed} of {len(required)} required steps pass{near}."]
    for step in required:
        if step.verdict != "pass":
            state = "not done" if step.state == "not done" else name_verdict(step.verdict)
            sentences.append(f"{name_step(step)}: {state}.")
    if others:
        names = ", ".join(f"{name_step(step)} ({name_verdict(mark_step(step, results.cases))})" for step in others)
        sentences.append(f"Not required, for information: {names}.")
    if results.system.name in results.accepted_unconfirmed:
        sentences.append(f"Accepted by the user: unconfirmed records of {results.system.name}.")
    return " ".join(sentences)


def list_dossier_facts(procedure: Procedure) -> tuple[tuple[str, str], ...]:
    """Title, digest and note of a dossier."""
    facts = {"Dossier": procedure.title, "Digest of the dossier": procedure.digest, "Note": procedure.note}
    return tuple((name, text) for name, text in facts.items() if text)


def build_step_table(procedure: Procedure, cases: Sequence[CaseResult]) -> doc.Table:
    """Table of the steps in the order of the procedure."""
    cells: dict[doc.Column, Callable[[tuple[int, ProcedureStep]], doc.RichText]] = {
        doc.Column("Step"): lambda row: doc.Link(f"{row[0]} {name_step(row[1])}", step_anchor(row[1])),
        doc.Column("Verdict"): lambda row: doc.VerdictMark(mark_step(row[1], cases)),
        doc.Column("Role"): lambda row: DECIDES if row[1].required else "for information",
        doc.Column("Cases and basis", 3): lambda row: _describe_step_basis(row[1]),
    }
    return doc.make_table(enumerate(procedure.steps, 1), cells)


def find_closest(step: ProcedureStep, cases: Sequence[CaseResult]) -> tuple[CaseResult | None, Criterion] | None:
    """Criterion of a step with its smallest margin, and its case; None if the step has none."""
    pairs: list[tuple[CaseResult | None, Criterion]] = [(None, row) for row in step.criteria]
    pairs += [(case, row) for case in cases if case.id in step.cases for row in case.criteria]
    return next((pair for pair in pairs if step.margin is not None and pair[1].margin == step.margin), None)


def name_claim(claim: ValidityClaim) -> str:
    """Subject of a claim on the range of validity."""
    return ": ".join(filter(None, (read_words()["claim"][claim.kind], claim.name)))


def format_claimed(limits: tuple[float, float] | None, unit: str) -> str:
    """Range of a claim with its unit; a dash without one."""
    return "–" if limits is None else f"{' to '.join(dict.fromkeys(map(format_plain, limits)))} {unit}".rstrip()


def describe_claim(claim: ValidityClaim) -> str:
    """Subject of a claim with its range."""
    return (
        name_claim(claim)
        if claim.claimed is None
        else f"{name_claim(claim)}: {format_claimed(claim.claimed, claim.unit)}"
    )


def list_step_reasons(procedure: Procedure) -> tuple[doc.Section, ...]:
    """Section on the steps that do not pass or are close to a limit; none if there are no such steps."""
    sentences = tuple(describe_steps(procedure))
    return (doc.Section("Steps", (doc.BulletList(sentences),)),) if sentences else ()


def describe_steps(procedure: Procedure) -> Iterator[str]:
    """Steps and their own criteria that do not pass or are close to a limit, and claims that no run shows."""
    for step in procedure.steps:
        yield from _describe_step(step)
    for claim in procedure.claims:
        if claim.reason:
            yield f"Claim not shown by a run: {name_claim(claim)}: {claim.reason}"


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


def _describe_step_basis(step: ProcedureStep) -> str:
    """Cases or values of a step, its state if it was not done, and remarks on its verdict."""
    state = "" if step.state == "done" else step.state
    cases = shorten_names(step.cases) or count_inside(step.criteria).removesuffix(".")
    return "; ".join(filter(None, (cases, state, step.reason, step.unconfirmed))) or "–"
