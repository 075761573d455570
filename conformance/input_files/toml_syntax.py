"""Syntax errors of TOML files: the line, and a hint at frequent causes."""

import re
import tomllib

LONGEST_QUOTE = 80
"""Largest number of characters of a line that is quoted."""

_PLACE = re.compile(r"\(at line (\d+), column \d+\)")
_DECIMAL_COMMA = re.compile(r"=\s*([+-]?\d+,\d+)")
_FOLDER_SEPARATOR = re.compile(r"""=\s*\[?\s*"[^"']*\\""")
_NUMBER_WITH_UNIT = re.compile(r"[=\[,]\s*([+-]?\d[\d_]*(?:\.\d+)?(?:[eE][+-]?\d+)?)\s*([A-Za-z%°µΩ][\w/%°²³]*)")


def explain_syntax_error(text: str, error: tomllib.TOMLDecodeError) -> tuple[str, str]:
    """Explain a syntax error.

    Args:
        text: Content of the file.
        error: Error of the parser.

    Returns:
        found: Message of the parser with the quoted line.
        hint: Next step of the user.
    """
    message = f"is not valid TOML: {str(error)[:200]}"
    place = _PLACE.search(str(error))
    if place is None:
        return message, "Complete the end of the file; see toml.io."
    line = text.split("\n")[int(place[1]) - 1].strip()
    quoted = line if len(line) <= LONGEST_QUOTE else line[:LONGEST_QUOTE] + "..."
    return f"{message}: {quoted!r}", _suggest_correction(line[:LONGEST_QUOTE])


def _suggest_correction(line: str) -> str:
    if found := _DECIMAL_COMMA.search(line):
        return f"Write a decimal point: {found[1].replace(',', '.')} in place of {found[1]} ."
    if found := _NUMBER_WITH_UNIT.search(line):
        return f"Write {found[1]} without {found[2]!r}: the end of the key states the unit, e.g. _N or _m."
    if _FOLDER_SEPARATOR.search(line):
        return "Write a path with forward slashes, or in single quotes: 'C:\\records'."
    return "Correct this line; see toml.io."
