"""The certificate as PDF/A-3a, set by Typst, with the results embedded."""

import json
import os
from dataclasses import asdict
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib
import typst
from matplotlib.ft2font import FT2Font

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.reports.certificate.certificate_page import build_certificate
from pantocheck.conformance.reports.formats.embedding import NAME, encode_attachment, strip_times
from pantocheck.conformance.reports.words import TEMPLATES, read_words

# Typst brings Libertinus Serif and DejaVu Sans Mono, matplotlib DejaVu Sans. No font of the machine is used.
FONTS = Path(matplotlib.get_data_path(), "fonts", "ttf")


def write_certificate_pdf(results: dict[str, Any], path: Path) -> None:
    """Write `certificate.pdf`.

    The same results give the same bytes if the environment sets `SOURCE_DATE_EPOCH`; without it the document bears the
    time the run started. A character that no font here can show is printed as U+FFFD; the embedded results keep it.

    Parameters
    ----------
    results : dict[str, Any]
        results.json as a dictionary.
    path : Path
        The file to write.

    Raises
    ------
    InputError
        The file cannot be written, or `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    write_atomically(path, render_pdf(results, parse_moment(results)))


def render_pdf(results: dict[str, Any], seconds: int) -> bytes:
    """The certificate's PDF, dated `seconds` after 1970 [s]."""
    results = strip_times(results)
    data = {
        "page": asdict(build_certificate(results)),
        "date": f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC" if seconds else "",
        "verdicts": read_words()["verdict"],
        "trusts": read_words()["trust"],
    }
    # typst takes a dictionary of files, which its type hints do not know.
    sources: Any = {
        "main.typ": (TEMPLATES / "certificate.typ").read_bytes(),
        "page.json": json.dumps(find_showable(data)).encode("ascii"),
        NAME: encode_attachment(results),
    }
    made = typst.compile(
        sources, pdf_standards="a-3a", ignore_system_fonts=True, font_paths=[str(FONTS)], timestamp=seconds
    )
    return bytes(made)


def parse_moment(results: dict[str, Any]) -> int:
    """The date of the document [s since 1970]: `SOURCE_DATE_EPOCH`, else the start of the run, else 0."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given is not None:
        # Up to the end of the year 9999, beyond which no date can be written.
        if not (given.isascii() and given.isdigit() and int(given[:15]) <= 253402300799):
            raise InputError(
                "SOURCE_DATE_EPOCH", f"'{given}' is not a date", "Give whole seconds since 1970-01-01 UTC."
            )
        return int(given)
    started = results.get("started")
    return int(datetime.fromisoformat(started).timestamp()) if started else 0


@cache
def _glyphs() -> frozenset[int]:
    return frozenset(FT2Font(str(FONTS / "DejaVuSans.ttf")).get_charmap())


def find_showable(value: Any) -> Any:
    """The same nest of dictionaries and lists with every character that has no glyph replaced by U+FFFD."""
    if isinstance(value, str):
        if value.isascii():
            return value
        return "".join(c if c.isascii() or ord(c) in _glyphs() else "\N{REPLACEMENT CHARACTER}" for c in value)
    if isinstance(value, dict):
        return {key: find_showable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [find_showable(item) for item in value]
    return value
