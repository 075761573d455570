"""Characters that no page may show."""

import re
import unicodedata

# Noncharacters, private use and lone surrogates have no meaning for a reader; bidirectional controls can make one text
# look like another ("gpj.exe" for "exe.jpg").
UNSHOWABLE = re.compile("[\ud800-\udfff\ue000-\uf8ff\ufdd0-\ufdef\ufffe\uffff\U000f0000-\U0010ffff]")
BIDIRECTIONAL = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def is_control(character: str) -> bool:
    """Whether a character is a control character, such as a line break."""
    return unicodedata.category(character) == "Cc"


def find_unshowable(text: str) -> str | None:
    """First control, bidirectional, private or undefined character of a text; None without one."""
    forbidden = (c for c in text if is_control(c) or UNSHOWABLE.match(c) or BIDIRECTIONAL.match(c))
    return next(forbidden, None)
