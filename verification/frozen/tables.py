"""Intended differences between two states, and the placeholders of texts that differ in every run.

A place is the path of the file below the folder of artefacts with the JSON pointer of the value, for example
`ac-simple/results.json/cases/0/verdict`. Patterns of places must match the whole place.
"""

import re
from collections import Counter
from typing import NamedTuple

from verification.frozen.commands import OLD_WORDS


class Rename(NamedTuple):
    """Pattern of the old place, file or text, its replacement in the syntax of `re.sub`, and the reason."""

    pattern: str
    replacement: str
    reason: str


class Omission(NamedTuple):
    """Pattern of what only one state has, or of what is not compared, and the reason."""

    pattern: str
    reason: str


RENAMED_FILES: tuple[Rename, ...] = ()
"""Files by their path, searched in the path of the old state."""

RENAMED: tuple[Rename, ...] = ()
"""Keys of JSON files, searched in the place of the old state."""

REMOVED: tuple[Omission, ...] = ()
"""Places of JSON files, or files, of the old state only."""

ADDED: tuple[Omission, ...] = ()
"""Places of JSON files, or files, of the new state only."""

RENAMED_TEXT: tuple[Rename, ...] = ()
"""Words of pages and texts, searched in the old text after placeholders are set; removed words have no replacement."""

ADDED_TEXT: tuple[Omission, ...] = ()
"""Words of pages and texts of the new state only."""

NOT_COMPARED = (
    Omission(r".*/campaign\.sqlite", "store of the runs; campaign.json and campaign.csv hold its values"),
    Omission(r".*/campaign\.lock", "lock of a running campaign"),
    Omission(r".*\.json(/.*)?/(wall_s|started|commit)", "fact of one run"),
    Omission(r".*\.json/(suite/version|system/version|platform/.*|renderer/.*)", "version or platform"),
)
"""Files and places that are left out of the comparison."""

_WORDS = {old: new for new, old in OLD_WORDS.items()}
_GROUPED = "|".join(new.removeprefix("drop ") for new in OLD_WORDS if new.startswith("drop "))
_OLD_COMMAND = re.compile(
    rf"(?<=pantocheck )({'|'.join(sorted(_WORDS, key=len, reverse=True))})(?![\w-])(?! (?:{_GROUPED})\b)"
)

PLACEHOLDERS = (
    (re.compile(r"sha256:(?:[0-9a-f]{64}|[0-9a-f]{30,63} [0-9a-f]+)\b"), "<digest>"),
    (re.compile(r"sha256[:-][0-9A-Za-z+/=]{12,64}"), "<digest>"),
    (re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)[0-9a-f]{12,64}(?![\w.])"), "<digest>"),
    (re.compile(r"\b20\d\d-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d)?(?:\.\d+)?(?:Z| UTC|\+00:00)?)?"), "<date>"),
    (re.compile(r"\b([Pp]antocheck(?: reference simulator)?) \d+\.\d+(?:\.\w+)*(?:\+\w+)?"), r"\1 <version>"),
    (re.compile(r"(?i)\b(python|numpy|scipy|numba|typst|matplotlib|jinja2) \d+(?:\.\d+)+"), r"\1 <version>"),
    (re.compile(r"(?m)^(wall_s|version) = .*$"), r"\1 = <fact of the run>"),
)
"""Digests (broken over two lines, too), dates, versions and facts of a run; the same for both states."""


class Tables:
    """The tables above, with the number of uses of each entry."""

    def __init__(self) -> None:
        self.uses: Counter[Rename | Omission] = Counter()

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
        return self._rename(tuple(Rename(added.pattern, "", added.reason) for added in ADDED_TEXT), replace(text))

    def omits(self, table: tuple[Omission, ...], place: str) -> bool:
        """Whether a table names a place."""
        matching = [omission for omission in table if re.fullmatch(omission.pattern, place)]
        self.uses.update(matching)
        return bool(matching)

    def unused(self) -> list[str]:
        """Patterns of intended differences that were not found."""
        entries = (*RENAMED_FILES, *RENAMED, *REMOVED, *ADDED, *RENAMED_TEXT)
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
