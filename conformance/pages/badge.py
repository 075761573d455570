"""A badge for a README as SVG."""

from collections import Counter
from xml.sax.saxutils import escape

from pantocheck.conformance.pages.two_verdicts import select_criteria
from pantocheck.conformance.pages.words import name_verdict
from pantocheck.conformance.results.results_format import Results

LABEL = "EN 50318 style"
COLOURS = {
    "pass": "#1b5e3a",
    "fail": "#8c1d18",
    "info": "#24496e",
    "skip": "#625000",
    "unverified": "#7a3b00",
    "error": "#5a1a66",
}
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
    if results.baseline_verdict not in (None, "pass"):
        text += f", baseline {name_verdict(results.baseline_verdict).lower()}"
    return f"{text}, modified copy" if any(case.library == "modified" for case in results.cases) else text


def render_badge(results: Results) -> str:
    """SVG of the badge of a run."""
    texts = (LABEL, summarise_verdict(results))
    widths = [round(len(text) * LETTER + 2 * MARGIN) for text in texts]
    total = sum(widths)
    starts = (0, widths[0])
    fills = ("#3b4249", COLOURS[results.verdict])
    name = escape(": ".join(texts))
    parts = [
        f'<rect x="{x}" width="{width}" height="20" fill="{fill}"/>'
        f'<text x="{x + MARGIN}" y="14" textLength="{width - 2 * MARGIN}" lengthAdjust="spacingAndGlyphs">'
        f"{escape(text)}</text>"
        for x, width, fill, text in zip(starts, widths, fills, texts, strict=True)
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{total}" height="20" role="img" aria-label="{name}">'
        f"<title>{name}</title>"
        f'<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">{"".join(parts)}</g></svg>\n'
    )
