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
    NO_BASIS,
    CriterionTexts,
    describe_criterion,
    draw_margin,
    error_name,
    has_reference,
    mark_criterion,
)
from pantocheck.conformance.pages.document_facts import list_check_facts, list_issuer_facts, name_system
from pantocheck.conformance.pages.frequency_section import mute_row
from pantocheck.conformance.pages.line_figure import draw_line_sketch, name_pantographs
from pantocheck.conformance.pages.scope_page import (
    build_step_table,
    describe_claim,
    describe_origin,
    find_closest,
    list_dossier_facts,
    list_scope,
    list_step_reasons,
    shorten_names,
)
from pantocheck.conformance.pages.two_verdicts import build_verdict_section
from pantocheck.conformance.pages.verdict_marks import case_verdict, count_close, list_criteria, mark_rows
from pantocheck.conformance.pages.verdict_reasons import (
    CLOSE_HEADING,
    describe_chance,
    describe_rule,
    explain_uncertainty,
    list_reasons,
    summarise_case,
)
from pantocheck.conformance.pages.words import format_plain, read_words
from pantocheck.conformance.results.procedure_format import Procedure
from pantocheck.conformance.results.results_format import CaseResult, Results

MOST_CASES = 4
"""Largest number of cases in the table of page 1; more have a section of their own."""

MOST_GRADED = 20
"""Largest number of graded values on page 1; the sections of the other cases have theirs."""

MOST_SENTENCES = 3
"""Largest number of lines, pantographs or sentences of one kind on page 1."""

MOST_REASONS = 2
"""Largest number of reasons under one heading on page 1."""

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
    """Cases in their order as far as there is room, and the source that all limits have in common."""
    room, graded = MOST_GRADED, []
    for case in results.cases if results.procedure is None else ():
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
        "tested": ("Tested item", _describe_object(results)),
        "basis": ("Cases and limits", _describe_basis(results, anchors, first_page)),
        "result": ("Result", _describe_result(results, first_page)),
        "use": ("Use", _describe_use(results, first_page)),
        "document": ("Issued by", [doc.Facts(list_issuer_facts(results, date))]),
        "check": ("Check of this document", [doc.Facts(list_check_facts(results, digest))]),
    }
    return doc.Answers(tuple(doc.Section(title, tuple(blocks), name) for name, (title, blocks) in answers.items()))


def _describe_object(results: Results) -> Iterator[doc.Block]:
    """System, record, speed, line and pantographs; without a procedure, a sketch of the first line that is known."""
    cases = results.cases
    lines = _list_lines(results)
    facts = {
        "System": name_system(results),
        "Record": _join_names(_describe_records(results)),
        "Speed": _name_speeds(cases),
        "Line": _join_names(lines),
        "Pantographs": _join_names(filter(None, map(name_pantographs, cases))),
    }
    yield doc.select_facts(facts)
    moving = sorted(cases, key=lambda case: case.run.speed_km_h is None)
    drawn = next((figure for case in moving for figure in draw_line_sketch(case)), None)
    if drawn is not None and results.procedure is None:
        yield doc.Figures((drawn,))


def _list_lines(results: Results) -> list[str]:
    """Names of the lines, those of a claim first; of a line that is not drawn, its spans."""
    if (procedure := results.procedure) is not None:
        claimed = [claim.name for claim in procedure.claims if claim.kind == "line"]
        return [*claimed, *(item.line for item in procedure.evidence)]
    return list(filter(None, map(_name_line, results.cases)))


def _name_line(case: CaseResult) -> str:
    if case.line_shape is not None:
        return case.line_shape.title
    geometry = next((group.values for group in case.inputs if group.group == "line.geometry"), {})
    spans, span = geometry.get("spans"), geometry.get("span_m")
    if not isinstance(spans, float) or not isinstance(span, float):
        return ""
    return f"{format_plain(spans)} spans of {format_plain(span)} m"


def _describe_records(results: Results) -> Iterator[str]:
    """State and reason of the records of a system that is not built in."""
    if results.system.kind != "builtin" and results.procedure is None:
        yield from (f"{case.record.state}: {case.record.reason}" for case in results.cases if case.record is not None)


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
    facts: list[tuple[str, str]] = []
    if results.procedure is not None:
        facts += list_dossier_facts(results.procedure)
    if results.procedure is None and len(results.cases) <= MOST_CASES:
        yield build_case_index(results.cases, anchors, first_page.graded)
    else:
        cases: dict[str, list[str]] = {}
        for case in results.cases:
            cases.setdefault(describe_origin(case), []).append(case.id)
        for origin, names in cases.items():
            facts.append(("Cases", f"{origin}: {shorten_names(names)}"))
    if first_page.source:
        facts.append(("Limits", f"{results.trust}: {first_page.source}"))
    elif level := read_words()["trust"].get(results.trust):
        facts.append(("Lowest trust of the limits that count", f"{results.trust} ({level['meaning']})"))
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
    if (procedure := results.procedure) is not None:
        yield build_step_table(procedure, results.cases)
    for section in build_verdict_section(results) if procedure is None else ():
        yield section.blocks[0]
    rule, risk = describe_rule(results).partition(": ")[0], results.decision.partition(":")[2]
    rule = f"{rule}, probability of a wrong acceptance at most {risk}" if risk else rule
    facts = [
        ("Decision rule", rule),
        ("Probability", describe_chance(results)),
        ("Uncertainty", explain_uncertainty(results)),
    ]
    yield doc.Facts(tuple((name, text) for name, text in (*facts, *_list_reasons(results, first)) if text))
    if figures := draw_limited_forces([*first, *others]):
        yield doc.Figures(figures)
    rows: list[GradedValue] = [(case.id, case, row) for case in first for row in list_criteria(case, "criteria")]
    for number, step in enumerate(() if procedure is None else procedure.steps, 1):
        if (closest := find_closest(step, results.cases)) is not None:
            case, row = closest
            rows.append((f"step {number}" if case is None else case.id, case, row))
    if rows:
        yield _build_value_table(rows, first_page)


def list_reason_sections(results: Results) -> tuple[doc.Section, ...]:
    """Reasons of a verdict under headings, those of the steps of a procedure first."""
    steps = () if results.procedure is None else list_step_reasons(results.procedure)
    return (*steps, *list_reasons(results))


def has_more_reasons(results: Results) -> bool:
    """Whether there are more reasons than page 1 states."""
    return any(len(_read_sentences(section)) > MOST_REASONS for section in list_reason_sections(results))


def _list_reasons(results: Results, first: Sequence[CaseResult]) -> Iterator[tuple[str, str]]:
    """Headings and first sentences of the reasons."""
    sections = list_reason_sections(results)
    if not sections:
        rows = [
            row for case in results.cases for name in ("criteria", "verification") for row in list_criteria(case, name)
        ]
        graded = any(row.verdict == "pass" for row in rows)
        yield ("Remarks", "No value with a limit that counts is close to it." if graded else "Nothing was graded.")
    for section in sections:
        if section.heading == CLOSE_HEADING and len(first) == len(results.cases):
            yield ("Close to a limit", f"{count_noun(count_close(results), 'value')}, marked in the table.")
            continue
        sentences = _read_sentences(section)
        more = f" Under Reasons: {len(sentences) - MOST_REASONS} more." if len(sentences) > MOST_REASONS else ""
        heading = "Close to a limit" if section.heading == CLOSE_HEADING else section.heading
        yield heading, " ".join(sentences[:MOST_REASONS]) + more


def _read_sentences(section: doc.Section) -> list[str]:
    [items] = section.blocks
    return [f"{str(item).removesuffix('.')}." for item in items.items] if isinstance(items, doc.BulletList) else []


GradedValue = tuple[str, CaseResult | None, Criterion]
"""Graded value with its case, and the name of the case or of its step."""


def _build_value_table(rows: Sequence[GradedValue], first_page: FirstPage) -> doc.Table:
    """Graded values, one line each on paper; their trust where it is not that of all limits."""
    cells: dict[doc.Column, Callable[[GradedValue], doc.RichText]] = {
        doc.Column("Quantity", share=1): _name_value,
        doc.Column("Case"): lambda value: value[0],
        doc.Column("Pantograph", short="Pant."): lambda value: _texts(value).pantograph,
        doc.Column("Value", number=True): lambda value: _texts(value).value,
        doc.Column(error_name([row for *_, row in rows]), number=True): lambda value: _texts(value).error,
        doc.Column("Limits", number=True): lambda value: _texts(value).limits,
        doc.Column("Margin"): lambda value: draw_margin(value[2], _texts(value)),
        doc.Column("Verdict"): lambda value: mark_criterion(value[2]),
    }
    if not first_page.source:
        cells[doc.Column("Trust")] = lambda value: doc.TrustMark(_texts(value).trust)
    table = doc.make_table(rows, cells, layout="values")
    pairs = zip(table.rows, rows, strict=True)
    muted = (
        shown if case is None else mute_row(case.supported, str(row.pantograph), shown)
        for shown, (_, case, row) in pairs
    )
    return replace(table, rows=tuple(muted))


def _texts(value: GradedValue) -> CriterionTexts:
    _, case, row = value
    return describe_criterion(row, NO_BASIS if case is None else case.uncertainty_basis)


def _name_value(value: GradedValue) -> doc.RichText:
    """Label and name of a value, with the mark of its condition."""
    _, case, row = value
    name = (f"{_texts(value).label} ", doc.Code(row.quantity))
    return mark_cell(name) if case is not None and describe_condition(case) else name


def _describe_use(results: Results, first_page: FirstPage) -> Iterator[doc.Block]:
    """Covered steps of the procedure or claimed range of validity, common warnings, and the nature of the report."""
    yield doc.select_facts(list_scope(results) if results.procedure is None else _list_claims(results.procedure))
    nature = f"This is a {results.statement}. It is not a certification by a third party."
    others = sum(text not in first_page.warnings for case in results.cases for text in case.warnings)
    more = [f"{count_noun(others, 'warning')} in the sections of the cases."] if others else []
    yield doc.BulletList((nature, *first_page.warnings, *more))


def _list_claims(procedure: Procedure) -> dict[str, str]:
    """Claimed range of validity: as far as runs show it, and the rest."""
    shown = {"Shown by runs": [claim for claim in procedure.claims if claim.verdict == "pass"]}
    shown["Not shown by runs"] = [claim for claim in procedure.claims if claim.verdict != "pass"]
    facts = {name: "; ".join(map(describe_claim, claims)) for name, claims in shown.items()}
    return facts if procedure.claims else {"Range of validity": "none is claimed"}
