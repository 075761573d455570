"""Page 1 of a certificate: object, limits, result, use, issuer and means of checking, in the order of an assessor."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_limited_forces
from pantocheck.conformance.pages.condition_sections import describe_condition, mark_cell
from pantocheck.conformance.pages.criteria_table import (
    CriterionTexts,
    describe_criterion,
    draw_margin,
    error_name,
    has_reference,
)
from pantocheck.conformance.pages.document_facts import list_check_facts, list_issuer_facts, name_system
from pantocheck.conformance.pages.frequency_section import mute_row
from pantocheck.conformance.pages.line_figure import draw_line_sketch, name_pantographs
from pantocheck.conformance.pages.scope_page import (
    CASES_SHOWN,
    build_procedure_section,
    describe_origin,
    list_step_reasons,
)
from pantocheck.conformance.pages.two_verdicts import (
    build_verdict_section,
    case_verdict,
    count_close,
    list_criteria,
    mark_rows,
)
from pantocheck.conformance.pages.verdict_reasons import (
    CLOSE_HEADING,
    CaseCriterion,
    describe_chance,
    describe_rule,
    list_reasons,
    state_incomplete,
    summarise_case,
)
from pantocheck.conformance.pages.words import format_plain, read_words
from pantocheck.conformance.results.results_format import CaseResult, Results

MOST_CASES = 4
"""Largest number of cases in the table of page 1; more have a section of their own."""

MOST_GRADED = 20
"""Largest number of graded values on page 1; the sections of the other cases have theirs."""

MOST_SENTENCES = 3
"""Largest number of lines, pantographs or sentences of one kind on page 1."""

MOST_SPEEDS = 6
"""Largest number of speeds that page 1 lists."""


@dataclass(frozen=True)
class FirstPage:
    """Content of page 1 that the sections of the cases do not repeat."""

    graded: tuple[str, ...]
    """Ids of the cases whose graded values it shows."""
    source: str
    """Source of the limits of all graded values; empty: they have several."""
    warnings: tuple[str, ...]
    """Warnings of every case."""


def plan_first_page(results: Results) -> FirstPage:
    """Cases in their order as far as there is room, and what all cases have in common."""
    room, graded = MOST_GRADED, []
    for case in () if results.procedure is not None else results.cases:
        rows = len(list_criteria(case, "criteria"))
        if 0 < rows <= room and not has_reference(case):
            graded.append(case.id)
            room -= rows
    origins = {(row.trust, row.source) for case in results.cases for row in list_criteria(case, "criteria")}
    source = origins.pop()[1] if len(origins) == 1 else ""
    evaluated = [case.warnings for case in results.cases if case.quantities]
    common = [text for text in evaluated[0] if all(text in others for others in evaluated)] if evaluated else []
    return FirstPage(tuple(graded), source, tuple(common) if len(common) <= MOST_SENTENCES else ())


def build_answers(
    results: Results, anchors: dict[str, str], first_page: FirstPage, identity: tuple[str, int]
) -> doc.Answers:
    """Answers of page 1.

    Args:
        results: Results from `prepare_results`.
        anchors: Anchors of the sections of the cases.
        first_page: Content from `plan_first_page`.
        identity: Digest of the results before their preparation, and date of the document [s since 1970; 0: not known].
    """
    digest, date = identity
    answers: dict[str, tuple[str, Iterable[doc.Block]]] = {
        "tested": ("What was tested", _describe_object(results)),
        "basis": ("Against what", _describe_basis(results, anchors, first_page)),
        "result": ("Result", _describe_result(results, first_page)),
        "use": ("Use", _describe_use(results, first_page)),
        "document": ("Issued by", [doc.Facts(list_issuer_facts(results, date))]),
        "check": ("How to check", [doc.Facts(list_check_facts(results, digest))]),
    }
    return doc.Answers(tuple(doc.Section(title, tuple(blocks), name) for name, (title, blocks) in answers.items()))


def _describe_object(results: Results) -> Iterator[doc.Block]:
    """System, speed, line and pantographs, with a sketch of the first line that is known."""
    cases = results.cases
    shapes = [case.line_shape.title for case in cases if case.line_shape is not None]
    facts = {
        "System": name_system(results),
        "Speed": _name_speeds(cases),
        "Line": _join_names(shapes),
        "Pantographs": _join_names(filter(None, map(name_pantographs, cases))),
    }
    yield doc.select_facts(facts)
    moving = sorted(cases, key=lambda case: case.run.speed_km_h is None)
    if drawn := next((figure for case in moving for figure in draw_line_sketch(case)), None):
        yield doc.Figures((drawn,))


def _name_speeds(cases: Sequence[CaseResult]) -> str:
    speeds = sorted({case.run.speed_km_h for case in cases if case.run.speed_km_h is not None})
    if len(speeds) > MOST_SPEEDS:
        return f"{len(speeds)} speeds, {format_plain(speeds[0])} to {format_plain(speeds[-1])} km/h"
    return f"{', '.join(map(format_plain, speeds))} km/h" if speeds else ""


def _join_names(names: Iterable[str]) -> str:
    """Different names; the first of many with the number of the others."""
    different = list(dict.fromkeys(names))
    more = len(different) - MOST_SENTENCES
    return "; ".join([*different[:MOST_SENTENCES], *([f"{more} more"] if more > 0 else [])])


def _describe_basis(results: Results, anchors: dict[str, str], first_page: FirstPage) -> Iterator[doc.Block]:
    """Cases with their edition, and the trust and source of their limits; the dossier of a procedure."""
    facts = []
    if results.procedure is not None:
        facts.append(("Dossier", results.procedure.title))
        *_, dossier = build_procedure_section(results.procedure, results.cases).blocks
        facts += dossier.pairs if isinstance(dossier, doc.Facts) else ()
    elif len(results.cases) <= MOST_CASES:
        yield build_case_index(results.cases, anchors, first_page.graded)
    else:
        cases: dict[str, list[str]] = {}
        for case in results.cases:
            cases.setdefault(describe_origin(case), []).append(case.id)
        for origin, names in cases.items():
            more = f", and {len(names) - CASES_SHOWN} more" if len(names) > CASES_SHOWN else ""
            facts.append((count_noun(len(names), "case"), f"{origin}: {', '.join(names[:CASES_SHOWN])}{more}"))
    if first_page.source:
        facts.append(("Limits", f"{results.trust}: {first_page.source}"))
    elif level := read_words()["trust"].get(results.trust):
        facts.append(("Lowest trust", f"{results.trust} ({level['meaning']})"))
    yield doc.Facts(tuple(facts))


def build_case_index(cases: Sequence[CaseResult], anchors: dict[str, str], graded: Sequence[str] = ()) -> doc.Table:
    """Table of cases; `graded` are ids of those whose criteria stand below. A case without a section has no link."""
    cells: dict[doc.Column, Callable[[CaseResult], doc.RichText]] = {
        doc.Column("Case", 1): lambda case: doc.Link(case.id, anchors[case.id]) if case.id in anchors else case.id,
        doc.Column("Origin", 2): describe_origin,
        doc.Column("Verdict"): partial(_mark, "criteria"),
    }
    if any(case.id not in graded for case in cases):
        cells[doc.Column("Criteria", 2)] = summarise_case
    if any(case.verification for case in cases):
        cells[doc.Column("Verification")] = partial(_mark, "verification")
    if any(case.baseline for case in cases):
        cells[doc.Column("Baseline")] = partial(_mark, "baseline")
    return doc.make_table(cases, cells)


def _mark(name: str, case: CaseResult) -> doc.RichText:
    """One of the verdicts of a case as a mark; a dash without this verdict."""
    verdict = case_verdict(case, name)
    return "–" if verdict is None else doc.VerdictMark(mark_rows(verdict, list_criteria(case, name)))


def _describe_result(results: Results, first_page: FirstPage) -> Iterator[doc.Block]:
    """Verdicts, rule, probability, reasons, forces and graded values; the steps of a procedure."""
    first = [case for case in results.cases if case.id in first_page.graded]
    others = [case for case in results.cases if case.id not in first_page.graded]
    if results.procedure is not None:
        yield build_procedure_section(results.procedure, results.cases).blocks[0]
    for section in build_verdict_section(results) if results.procedure is None else ():
        yield section.blocks[0]
    rule, risk = describe_rule(results).partition(": ")[0], results.decision.partition(":")[2]
    rule = f"{rule}, probability of a wrong acceptance at most {risk}" if risk else rule
    facts = [
        ("Decision rule", rule),
        ("Probability", describe_chance(results)),
        ("Uncertainty", state_incomplete(results)),
    ]
    yield doc.Facts(tuple((name, text) for name, text in (*facts, *_list_reasons(results, first)) if text))
    if figures := draw_limited_forces(first if results.procedure is not None else [*first, *others]):
        yield doc.Figures(figures)
    if first:
        yield _build_value_table(first, first_page)


def group_reasons(results: Results) -> tuple[doc.Section, ...]:
    """Reasons of a verdict under headings, those of the steps of a procedure first."""
    steps = () if results.procedure is None else list_step_reasons(results.procedure)
    return (*steps, *list_reasons(results))


def has_more_reasons(results: Results) -> bool:
    """Whether there are more reasons than page 1 states."""
    return any(len(_read_sentences(section)) > MOST_SENTENCES for section in group_reasons(results))


def _list_reasons(results: Results, first: Sequence[CaseResult]) -> Iterator[tuple[str, str]]:
    """Headings and first sentences of the reasons."""
    sections = group_reasons(results)
    if not sections:
        rows = [
            row for case in results.cases for name in ("criteria", "verification") for row in list_criteria(case, name)
        ]
        graded = any(row.verdict == "pass" for row in rows)
        yield ("Remarks", "No value is close to a limit." if graded else "Nothing was graded.")
    for section in sections:
        if section.heading == CLOSE_HEADING and len(first) == len(results.cases):
            yield ("Close to a limit", f"{count_noun(count_close(results), 'value')}, marked in the table.")
            continue
        sentences = _read_sentences(section)
        more = f" {len(sentences) - MOST_SENTENCES} more under Reasons." if len(sentences) > MOST_SENTENCES else ""
        yield section.heading, " ".join(sentences[:MOST_SENTENCES]) + more


def _read_sentences(section: doc.Section) -> list[str]:
    [items] = section.blocks
    return [str(item) for item in items.items] if isinstance(items, doc.BulletList) else []


def _build_value_table(cases: Sequence[CaseResult], first_page: FirstPage) -> doc.Table:
    """Graded values of cases, one line each on paper; their trust where it is not that of all limits."""
    rows = [(case, row) for case in cases for row in list_criteria(case, "criteria")]
    error = error_name([row for _, row in rows])
    cells: dict[doc.Column, Callable[[CaseCriterion], doc.RichText]] = {
        doc.Column("Quantity", share=1): lambda pair: _name_value(*pair),
        doc.Column("Case"): lambda pair: pair[0].id,
        doc.Column("Pantograph", short="Pant."): lambda pair: _texts(pair).pantograph,
        doc.Column("Value", number=True): lambda pair: _texts(pair).value,
        doc.Column(error, number=True, short=error.partition(" ")[0]): lambda pair: _texts(pair).error,
        doc.Column("Limits", number=True): lambda pair: _texts(pair).limits,
        doc.Column("Margin"): lambda pair: draw_margin(pair[1], _texts(pair)),
        doc.Column("Verdict"): lambda pair: doc.VerdictMark(mark_rows(pair[1].verdict, [pair[1]])),
    }
    if not first_page.source:
        cells[doc.Column("Trust")] = lambda pair: doc.TrustMark(_texts(pair).trust)
    table = doc.make_table(rows, cells, layout="values")
    pairs = zip(table.rows, rows, strict=True)
    muted = (mute_row(case.supported, str(row.pantograph), cells) for cells, (case, row) in pairs)
    return replace(table, rows=tuple(muted))


def _texts(pair: CaseCriterion) -> CriterionTexts:
    case, row = pair
    return describe_criterion(row, case.uncertainty_basis)


def _name_value(case: CaseResult, row: Criterion) -> doc.RichText:
    """Label and name of a value, with the mark of its condition."""
    name = (f"{_texts((case, row)).label} ", doc.Code(row.quantity))
    return mark_cell(name) if describe_condition(case) else name


def _describe_use(results: Results, first_page: FirstPage) -> Iterator[doc.Block]:
    """Covered steps of the procedure, common warnings, and the nature of the report."""
    states: dict[str, list[str]] = {}
    for step in results.scope if results.procedure is None else ():
        states.setdefault(step.state, []).append(read_words()["step"][step.step])
    facts = {f"Steps {state}": ", ".join(states[state]) for state in read_words()["state"] if state in states}
    yield doc.select_facts(facts)
    nature = f"This is a {results.statement}. It is not a certification by a third party."
    yield doc.BulletList((nature, *first_page.warnings))
