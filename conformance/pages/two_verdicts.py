"""Verdicts side by side: EN 50318 criteria, verification and drift from a baseline; and the verdict as a badge."""

from collections import Counter
from collections.abc import Iterator
from html import escape

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.look import read_look
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.criteria_table import DECIDES, DEVIATION_HEADINGS, count_inside, criteria_blocks
from pantocheck.conformance.pages.verdict_marks import (
    CLOSE,
    NAMES,
    case_verdict,
    count_close,
    list_criteria,
    mark_results,
    mark_rows,
    select_criteria,
)
from pantocheck.conformance.pages.words import name_verdict
from pantocheck.conformance.results.case_facts_format import BaselineComparison
from pantocheck.conformance.results.results_format import CaseResult, Results

SHORT_TITLES = NAMES | {"verification": "Verification up to 50 Hz"}

NUMBERS = {2: "Two", 3: "Three"}
"""Words for the number of verdicts."""

MEANING = (
    "The verdict of the report is the worse of those that decide. Verification compares with the solution of the same "
    "equations, on which two formulations without common code agree. It is no criterion of EN 50318 and never improves "
    "the verdict by the criteria."
)

BASELINE_MEANING = (
    "Drift from the baseline compares with earlier results of the user. It is no criterion of EN 50318. It always "
    "counts in the verdict of the report, and never improves it."
)


def build_verdict_section(results: Results) -> tuple[doc.Section, ...]:
    """The verdicts of a run side by side; empty if there is one only."""
    names = _list_names(results)
    if len(names) == 1:
        return ()
    rows = tuple(_verdict_row(results, name) for name in names)
    confirmed = dict.fromkeys(case.verification.confirmed_by for case in results.cases if case.verification is not None)
    meanings = [text for name, text in (("verification", MEANING), ("baseline", BASELINE_MEANING)) if name in names]
    columns = (doc.Column("Verdict on"), doc.Column("Verdict"), doc.Column("Role"), doc.Column("Cases and basis", 3))
    meanings += [f"Confirmed by {text}." for text in confirmed]
    blocks = (doc.Table(columns, rows), doc.SmallPrint(" ".join(meanings)))
    return (doc.Section(f"{NUMBERS[len(names)]} verdicts", blocks, anchor="verdicts"),)


def _list_names(results: Results) -> list[str]:
    """Verdicts of a run: by the criteria, and by verification and baseline if there are any."""
    verified = results.verification_verdict is not None or "verification" in results.requested
    compared = results.baseline_verdict is not None
    return ["criteria", *(["verification"] if verified else []), *(["baseline"] if compared else [])]


def _mark_run(results: Results, name: str) -> str:
    """Mark of one of the verdicts of a run; `info` if it has none."""
    verdicts = {
        "criteria": results.criteria_verdict,
        "verification": results.verification_verdict,
        "baseline": results.baseline_verdict,
    }
    return mark_rows(verdicts[name] or "info", (row for case in results.cases for row in list_criteria(case, name)))


def _verdict_row(results: Results, name: str) -> tuple[doc.RichText, ...]:
    role = DECIDES if name == "baseline" or name in results.requested else "for information"
    return SHORT_TITLES[name], doc.VerdictMark(_mark_run(results, name)), role, " ".join(_describe_basis(results, name))


def _describe_basis(results: Results, name: str) -> Iterator[str]:
    shown = {*results.information, *(results.verification_only if name == "criteria" else ())}
    cases = [case for case in results.cases if case.id not in shown and case_verdict(case, name) is not None]
    verdicts = Counter(case_verdict(case, name) for case in cases)
    if not cases:
        yield "No case takes part."
    elif name == "criteria" and verdicts["info"] == len(cases):
        yield "No case has a limit that counts."
    else:
        passed = f"{verdicts['pass']} of {count_noun(len(cases), 'case')}"
        yield f"{passed} {'passes' if 1 in (verdicts['pass'], len(cases)) else 'pass'}."
    if name == "baseline":
        yield from dict.fromkeys(describe_comparison(case.baseline) for case in cases if case.baseline is not None)
        others = [case for case in results.cases if case.id not in shown and case.baseline is None]
        if others:
            yield f"{count_noun(len(others), 'case was', 'cases were')} not compared."
        return
    if text := count_inside(row for case in cases for row in list_criteria(case, name)):
        yield text
    if name == "verification" and results.system.kind == "builtin":
        yield "The converged values are those of the same simulator."


def verdict_sentences(results: Results) -> list[str]:
    """Sentence for the headline on the verdicts; none if there is one only."""
    names = _list_names(results)
    parts = []
    is_run = any(case.profile is None and case.record is not None for case in results.cases)
    if results.system.kind != "builtin" and "verification" not in names and is_run:
        parts.append("Verification up to 50 Hz: not asked")
    elif len(names) == 1:
        return []
    for name in names:
        note = "" if name == "baseline" or name in results.requested else " (for information)"
        absent = name == "verification" and results.verification_verdict is None
        verdict = "not available" if absent else name_verdict(_mark_run(results, name))
        parts.append(f"{SHORT_TITLES[name]}: {verdict}{note}")
    return [f"{'; '.join(parts)}."]


def describe_comparison(comparison: BaselineComparison) -> str:
    """Numbers of compared and of drifted values of a case in one sentence."""
    values, drifted = comparison.values, comparison.drifted
    if not values:
        return f"No value was compared with {comparison.name}."
    drift = f"drifted by more than {comparison.drift_pct:g} % from {comparison.name}"
    return f"{drifted} of {values} values {drift}, or are missing."


def baseline_blocks(case: CaseResult, anchor: str) -> tuple[doc.Block, ...]:
    """Section on the drift of a case from its baseline; empty if it was not compared with one."""
    comparison = case.baseline
    if comparison is None:
        return ()
    mark = doc.VerdictMark(comparison.verdict)
    blocks: list[doc.Block] = [doc.Paragraph((mark, f"\N{EN SPACE}{describe_comparison(comparison)}"))]
    if rows := list_criteria(case, "baseline"):
        blocks += criteria_blocks(rows, anchor, f"{anchor}-baseline-source", case)
    return (doc.Section(NAMES["baseline"], tuple(blocks)),)


def verification_blocks(case: CaseResult, anchor: str) -> tuple[doc.Block, ...]:
    """Section on the verification of a case; empty if the case has no converged values."""
    verification = case.verification
    if verification is None:
        return ()
    basis = f"\N{EN SPACE}Converged values of the reference simulator, confirmed by {verification.confirmed_by}."
    mark = doc.VerdictMark(mark_rows(verification.verdict, verification.criteria))
    blocks: list[doc.Block] = [doc.Paragraph((mark, basis))]
    if verification.reason and verification.reason != case.reason:
        blocks.append(doc.Paragraph(verification.reason))
    if verification.criteria:
        rows = [_subtract_converged(row) for row in verification.criteria]
        blocks += criteria_blocks(rows, anchor, f"{anchor}-verification-source", case, DEVIATION_HEADINGS)
    if verification.omitted:
        blocks.append(doc.Section("Without a confirmed value", (doc.BulletList(tuple(verification.omitted)),)))
    return (doc.Section(NAMES["verification"], tuple(blocks)),)


def _subtract_converged(row: Criterion) -> Criterion:
    """Criterion of the deviation from the converged value, the middle of its limits."""
    if row.value is None or row.lower is None or row.upper is None:
        return row
    width, middle = (row.upper - row.lower) / 2, (row.lower + row.upper) / 2
    return row.model_copy(update={"value": row.value - middle, "lower": -width, "upper": width})


# A badge for a README as SVG.
LABEL = "EN 50318 style"
LETTER, MARGIN = 6.6, 8
"""Width of a letter and margin beside the text [px]; every font is fitted to these widths."""


def summarise_verdict(results: Results) -> str:
    """Verdict with the numbers of passed and of counted criteria; a drift and a modified library case are named.

    With a procedure, the numbers are those of its required steps.
    """
    word = name_verdict(results.verdict).lower()
    if results.procedure is not None:
        required = [step.verdict for step in results.procedure.steps if step.required]
        return f"{word} {required.count('pass')}/{len(required)} steps"
    rows = [row for case in results.cases for row in select_criteria(results, case)]
    verdicts = Counter(row.verdict for row in rows if not row.is_drift)
    counted = sum(count for verdict, count in verdicts.items() if verdict != "info")
    text = f"{word} {verdicts['pass']}/{counted}" if counted else word
    if mark_results(results) == CLOSE:
        text += f", {count_close(results)} close"
    if results.baseline_verdict not in (None, "pass"):
        text += f", baseline {name_verdict(results.baseline_verdict).lower()}"
    return f"{text}, modified copy" if any(case.library == "modified" for case in results.cases) else text


def render_badge(results: Results) -> str:
    """SVG of the badge of a run."""
    texts = (LABEL, summarise_verdict(results))
    widths = [round(len(text) * LETTER + 2 * MARGIN) for text in texts]
    total = sum(widths)
    starts = (0, widths[0])
    fills = (read_look()["figure"]["bars"][0], read_look()["light-verdict"][mark_results(results)])
    name = escape(": ".join(texts), quote=False)
    parts = [
        f'<rect x="{x}" width="{width}" height="20" fill="{fill}"/>'
        f'<text x="{x + MARGIN}" y="14" textLength="{width - 2 * MARGIN}" lengthAdjust="spacingAndGlyphs">'
        f"{escape(text, quote=False)}</text>"
        for x, width, fill, text in zip(starts, widths, fills, texts, strict=True)
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{total}" height="20" role="img" aria-label="{name}">'
        f"<title>{name}</title>"
        f'<g fill="{read_look()["light"]["paper"]}" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">'
        f"{''.join(parts)}</g></svg>\n"
    )
