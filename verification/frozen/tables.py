"""Intended differences between two states, and the placeholders of texts that differ in every run.

A place is the path of the file below the folder of artefacts with the JSON pointer of the value, for example
`ac-simple/results.json/cases/0/verdict`. Patterns of places must match the whole place.
"""

import re
import tomllib
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from verification.frozen.commands import OLD_WORDS


class Rename(NamedTuple):
    """Pattern of the old place, file or text, its replacement in the syntax of `re.sub`, and the reason."""

    pattern: str
    replacement: str
    reason: str


class Change(NamedTuple):
    """Pattern of a place, its exact value in the old and in the new state, and the reason."""

    pattern: str
    old: str
    new: str
    reason: str


class Omission(NamedTuple):
    """Pattern of what only one state has, or of what is not compared, and the reason."""

    pattern: str
    reason: str


_TABLES = tomllib.loads(Path(__file__).with_name("differences.toml").read_text("utf-8"))


def _read_renames(name: str) -> tuple[Rename, ...]:
    return tuple(Rename(**row) for row in _TABLES.get(name, ()))


def _read_omissions(name: str) -> tuple[Omission, ...]:
    return tuple(Omission(**row) for row in _TABLES.get(name, ()))


RENAMED_FILES = _read_renames("renamed_files")
"""Files by their path, searched in the path of the old state."""

RENAMED = _read_renames("renamed")
"""Keys of JSON files, searched in the place of the old state."""

REMOVED = _read_omissions("removed")
"""Places of JSON files, or files, of the old state only."""

ADDED = _read_omissions("added")
"""Places of JSON files, or files, of the new state only."""

CHANGED = tuple(Change(**row) for row in _TABLES["changed"])
"""Values of JSON files that state the same fact in another way; never a number or a verdict."""

RENAMED_TEXT = _read_renames("renamed_text")
"""Words of pages and texts, searched in the old text after placeholders are set; removed words have no replacement."""

ADDED_TEXT = _read_omissions("added_text")
"""Words of pages and texts of the new state only."""

_ADDED_WORDS = tuple(Rename(added.pattern, "", added.reason) for added in ADDED_TEXT)

MOVED = _read_omissions("moved")
"""Files that have the same words in another order or on another page."""

NOT_COMPARED = _read_omissions("not_compared")
"""Files and places that are left out of the comparison."""

_WORDS = {old: new for new, old in OLD_WORDS.items()}
_GROUPED = "|".join(new.removeprefix("drop ") for new in OLD_WORDS if new.startswith("drop "))
_OLD_COMMAND = re.compile(
    rf"(?<=pantocheck )({'|'.join(sorted(_WORDS, key=len, reverse=True))})(?![\w-])(?! (?:{_GROUPED})\b)"
)

PLACEHOLDERS = (
    (re.compile(r"sha256:(?:[0-9a-f]{64}|[0-9a-f]{30,63} [0-9a-f]+)\b"), "<digest>"),
    (re.compile(r"sha256[:-][0-9A-Za-z+/=]{12,64}"), "<digest>"),
    (re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)[0-9a-f]{12,64}(?:-dirty)?(?![\w.])"), "<digest>"),
    (re.compile(r"\b20\d\d-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d)?(?:\.\d+)?(?:Z| UTC|\+00:00)?)?"), "<date>"),
    (re.compile(r"\b([Pp]antocheck(?: reference simulator)?) \d+\.\d+(?:\.\w+)*(?:\+\w+)?"), r"\1 <version>"),
    (re.compile(r"(?i)\b(python|numpy|scipy|numba|typst|matplotlib|jinja2) \d+(?:\.\d+)+"), r"\1 <version>"),
    (re.compile(r"(?m)^(wall_s|version) = .*$"), r"\1 = <fact of the run>"),
)
"""Digests (broken over two lines, too), dates, versions and facts of a run; the same for both states."""


class Tables:
    """The tables above, with the number of uses of each entry."""

    def __init__(self) -> None:
        self.uses: Counter[Rename | Change | Omission] = Counter()

    def file(self, path: str) -> str:
        """Path of the new state for a path of the old one."""
        return self._rename(RENAMED_FILES, path)

    def place(self, place: str) -> str:
        """Place of the new state for a place of the old one."""
        return self._rename(RENAMED, place)

    def old_text(self, text: str) -> str:
        """Text of the old state with placeholders and the words of the new one."""
        return self._rename(RENAMED_TEXT, replace(text))

    def new_text(self, text: str) -> str:
        """Text of the new state with placeholders, without the words that the old one lacks."""
        return self._rename(_ADDED_WORDS, replace(text))

    def omits(self, table: tuple[Omission, ...], place: str) -> bool:
        """Whether a table names a place."""
        matching = [omission for omission in table if re.fullmatch(omission.pattern, place)]
        self.uses.update(matching)
        return bool(matching)

    def changes(self, place: str, old: str | None, new: str | None) -> bool:
        """Whether the table of changed values has this change."""
        matching = [
            entry for entry in CHANGED if (entry.old, entry.new) == (old, new) and re.fullmatch(entry.pattern, place)
        ]
        self.uses.update(matching)
        return bool(matching)

    def unused(self) -> list[str]:
        """Patterns of intended differences that were not found."""
        entries = (*RENAMED_FILES, *RENAMED, *REMOVED, *ADDED, *CHANGED, *RENAMED_TEXT, *_ADDED_WORDS, *MOVED)
        return [entry.pattern for entry in entries if not self.uses[entry]]

    def _rename(self, table: tuple[Rename, ...], text: str) -> str:
        for rename in table:
            text, count = re.subn(rename.pattern, rename.replacement, text)
            self.uses[rename] += count
        return text


def replace(text: str) -> str:
    """Text with placeholders for digests, dates, versions and facts of a run, and the new words of commands."""
    for pattern, placeholder in PLACEHOLDERS:
        text = pattern.sub(placeholder, text)
    return _OLD_COMMAND.sub(lambda match: _WORDS[match[1]], text)
