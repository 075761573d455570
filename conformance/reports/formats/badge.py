"""A badge for a README: an SVG picture, or the JSON that a shields.io endpoint badge is drawn from."""

import json
from collections import Counter
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.reports.words import read_words

LABEL = "EN 50318 style"
COLOURS = {"pass": "#1b5e3a", "fail": "#8c1d18", "info": "#24496e", "skip": "#625000", "error": "#5a1a66"}
# Widths of text: the letters are squeezed or stretched to them, so that every font fits.
LETTER, MARGIN = 6.6, 8


def write_badge(results: dict[str, Any], path: Path) -> None:
    """Write a badge: SVG if the name of the file ends in `.svg`, else JSON for a shields.io endpoint.

    Parameters
    ----------
    results : dict[str, Any]
        results.json as a dictionary.
    path : Path
        The file to write.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_atomically(path, (svg(results) if path.suffix.lower() == ".svg" else endpoint(results)).encode("utf-8"))


def message(results: dict[str, Any]) -> str:
    """The verdict, and how many of the counted criteria are inside their limits."""
    verdicts = Counter(row["verdict"] for case in results["cases"] for row in case["criteria"])
    counted = sum(count for verdict, count in verdicts.items() if verdict != "info")
    word = read_words()["verdict"][results["verdict"]]["word"].lower()
    return f"{word} {verdicts['pass']}/{counted}" if counted else word


def endpoint(results: dict[str, Any]) -> str:
    """JSON of a shields.io endpoint badge."""
    badge = {"schemaVersion": 1, "label": LABEL, "message": message(results), "color": COLOURS[results["verdict"]]}
    return json.dumps(badge, indent=1) + "\n"


def svg(results: dict[str, Any]) -> str:
    """The badge as a picture."""
    texts = (LABEL, message(results))
    widths = [round(len(text) * LETTER + 2 * MARGIN) for text in texts]
    total = sum(widths)
    starts = (0, widths[0])
    fills = ("#3b4249", COLOURS[results["verdict"]])
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
