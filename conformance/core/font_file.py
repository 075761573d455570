"""Glyphs of a TrueType font: the characters that it has, and the widths of texts."""

import struct
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray

REPLACEMENT = "\N{REPLACEMENT CHARACTER}"


@cache
def find_fonts() -> Path:
    """Folder of the fonts that matplotlib brings; importing the package itself would take 0.2 s."""
    package = find_spec("matplotlib")
    if package is None or package.origin is None:
        raise ModuleNotFoundError("matplotlib")
    return Path(package.origin).parent / "mpl-data" / "fonts" / "ttf"


@cache
def read_advances(name: str = "DejaVuSans.ttf") -> dict[int, float]:
    """Advance width of every character of a font, as a share of the font size.

    The tables `cmap` (format 12), `head`, `hhea` and `hmtx` are those of the OpenType specification.
    """
    data = (find_fonts() / name).read_bytes()
    tables = {tag: start for tag, _, start, _ in struct.iter_unpack(">4sLLL", data[12 : 12 + 16 * data[5]])}
    (units,) = struct.unpack_from(">H", data, tables[b"head"] + 18)
    (count,) = struct.unpack_from(">H", data, tables[b"hhea"] + 34)
    widths: RealArray = np.frombuffer(data, ">u2", 2 * count, tables[b"hmtx"])[::2] / units
    return {
        code: float(widths[min(glyph + code - first, count - 1)])
        for first, last, glyph in _list_groups(data, tables[b"cmap"])
        for code in range(first, last + 1)
    }


def _list_groups(data: bytes, start: int) -> list[tuple[int, int, int]]:
    """First and last character and first glyph of each group of a `cmap` table of format 12."""
    (number,) = struct.unpack_from(">H", data, start + 2)
    for _, _, offset in struct.iter_unpack(">HHL", data[start + 4 : start + 4 + 8 * number]):
        if data[start + offset : start + offset + 2] == b"\x00\x0c":
            (groups,) = struct.unpack_from(">L", data, start + offset + 12)
            first = start + offset + 16
            return list(struct.iter_unpack(">LLL", data[first : first + 12 * groups]))
    raise ValueError("the font has no table of characters of format 12")


def measure_text(text: str, size: float) -> float:
    """Width of a text in DejaVu Sans, in the unit of its font size, without kerning."""
    advances = read_advances()
    return size * sum(advances.get(ord(character), 0.6) for character in text)


def replace_missing_glyphs(text: str) -> str:
    """A text with every character that has no glyph replaced by U+FFFD."""
    if text.isascii():  # most texts, and all figures
        return text
    missing = {code for code in map(ord, set(text)) if code > 127 and code not in read_advances()}
    return text.translate(dict.fromkeys(missing, REPLACEMENT)) if missing else text
