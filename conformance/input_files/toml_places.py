"""Lines of tables and keys in TOML files, for messages at the right line."""

import re

# Longest forms first. A text without its end reaches to the end of the line or file, so that no place is read twice.
_TEXT_OR_COMMENT = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"""|\Z)'
    r"|'''(?:[^']|'(?!''))*+(?:'''|\Z)"
    r'|"(?:[^"\\\n]|\\[^\n])*+"?'
    r"|'[^'\n]*+'?"
    r"|#[^\n]*+",
    re.DOTALL,
)
_ANY_TABLE = re.compile(r"^[ \t]*+\[", re.MULTILINE)


def list_table_lines(text: str, name: str) -> tuple[int, ...]:
    """Lines of the headers `[[name]]` of a list of tables.

    Args:
        text: Content of a TOML file.
        name: Name of the list. Tables that are written inside other values, or with a quoted name, are not found.

    Returns:
        Number of each line, from 1.
    """
    header = re.compile(rf"^[ \t]*+\[\[[ \t]*+{re.escape(name)}[ \t]*+\]\]", re.MULTILINE)
    bare = _blank_texts(text)
    return tuple(_line_of(bare, match.start()) for match in header.finditer(bare))


def find_key_line(text: str, key: str) -> int | None:
    """Line of a key before the first table of a file; None without it.

    Args:
        text: Content of a TOML file.
        key: Name of the key, without dots.

    Returns:
        Number of the line, from 1.
    """
    bare = _blank_texts(text)
    table = _ANY_TABLE.search(bare)
    head = bare if table is None else bare[: table.start()]
    found = re.search(rf"^[ \t]*+{re.escape(key)}[ \t]*+=", head, re.MULTILINE)
    return None if found is None else _line_of(bare, found.start())


def _blank_texts(text: str) -> str:
    """Content without texts and comments; the line breaks remain."""
    return _TEXT_OR_COMMENT.sub(lambda match: "\n" * match[0].count("\n"), text)


def _line_of(text: str, start: int) -> int:
    return text.count("\n", 0, start) + 1
