"""Output on terminals whose encoding lacks characters, such as Windows-1252 or ASCII."""

import codecs
import sys
from io import TextIOWrapper

REPLACEMENTS = {
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "−": "-",
    "–": "-",
    "—": "-",
    "…": "...",
    "×": "x",
    "µ": "u",
    "μ": "u",
    "°": "deg",
    "²": "^2",
    "³": "^3",
    "·": "*",
    "→": "->",
    "✓": "+",
    "✗": "x",
    "\N{NO-BREAK SPACE}": " ",
    "\N{NARROW NO-BREAK SPACE}": " ",
    "\N{EN SPACE}": " ",
}
"""Symbols of the suite in ASCII; any other character becomes a question mark."""

ERROR_HANDLER = "pantocheck.symbols"


def replace_symbols(error: UnicodeError) -> tuple[str, int]:
    """Replacement of characters that an encoding lacks, as an error handler of `codecs`.

    Args:
        error: Error with the text and the range of the characters.

    Returns:
        Replacement.
        Position at which encoding continues.

    Raises:
        UnicodeError: The error is not one of encoding.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    return "".join(REPLACEMENTS.get(character, "?") for character in text), error.end


def accept_all_characters() -> None:
    """Let standard output and standard error replace characters that their encoding lacks.

    Without it, a title with a Greek letter would end a command on such a terminal.
    """
    codecs.register_error(ERROR_HANDLER, replace_symbols)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors=ERROR_HANDLER)
