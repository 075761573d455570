"""Pages in another language: every text of a document is replaced by its entry in the catalogue of the language.

The key of an entry is the English text. It may hold arguments, which a digit tells apart: `{n}` is a number, `{x}` a
name or another part that stays as it is, `{s}` a source, and `{t}` a text that is translated in turn. A text without an
entry, such as the title of a user's case, stays as it is. Numbers never change.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from html import escape, unescape
from typing import Any

from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.pages.document import Code, CodeBlock, Document, TrustMark, VerdictMark
from pantocheck.conformance.pages.words import BOUND_UNITS
from pantocheck.conformance.results.report_files import LANGUAGES

ARGUMENT = re.compile(r"\{([nstx])\d*\}")
"""Argument of an entry."""

ARGUMENT_TEXTS = {"n": r"[-−+]?\d[\d.]*(?:e[-−+]?\d+)?", "x": r"(?:(?![.!?] [^\W\d_]|; ).)+?", "s": ".+", "t": ".+?"}
"""Texts of arguments as regular expressions; `{x}` ends with its sentence or its item of a list."""

WORD = re.compile(r"[^\W\d_]+")
SENTENCE_END = re.compile(r"(?<=[.!?]) (?=\S)")
SURROUNDED = re.compile(r"^([\s.,;:]*)(.*?)([\s.,;:]*)$", re.DOTALL)
"""Punctuation and spaces around a text, and the text."""

MARKED = re.compile(r'translate\("((?:[^"\\]|\\.)*)"\)')
"""Text in a template, a style sheet or a script that is shown in the language of the page."""

LETTERS_OF_A_FRAME = 4
"""An entry with fewer letters, such as `{t} and {t2}`, joins texts that have entries themselves; others are left."""

DRAWN = re.compile(r"(<text\b[^>]*>|<title>)([^<>]+)(?=</t)")
"""Text of a figure."""

LIST_JOINT = "{t}; {t2}"
"""Entry that divides a list, whose items stand on their own."""

LETTER_SIZE = re.compile(r"(font(?:-size)?: )([\d.]+)px")
SMALLEST_LETTERS = 0.7
"""Smallest letters of a translated text of a figure, as a share of those of the English text."""

SPARE_LETTERS = 3
"""Number of letters that fit between a text in a row and its neighbour."""

FIXED = frozenset(("kind", "svg", "anchor", "address", "verdict", "trust", "layout", "curves", "results", "language"))
"""Fields of a document that hold no text for a reader."""


@dataclass(frozen=True)
class Entry:
    """One text of a catalogue."""

    key: str
    """English text with its arguments."""
    translation: str
    letters: int
    """Number of letters of the key outside its arguments: the entry with the most is tried first, of equal ones that
    with the most arguments."""


@dataclass(frozen=True)
class Translation:
    """A text in another language."""

    text: str
    missing: tuple[str, ...] = ()
    """Parts without an entry, which stay as they are."""

    @property
    def lack(self) -> int:
        """Number of characters without an entry."""
        return sum(map(len, self.missing))


@cache
def read_sections(language: str) -> Mapping[str, Mapping[str, str]]:
    """Entries of a language by their section: English text and translation.

    Every entry is a line of its own, and is found in a tenth of the time of a parser of TOML; a test compares both.
    """
    sections: dict[str, dict[str, str]] = {}
    for line in (TEMPLATES / "languages" / f"{language}.toml").read_text("utf-8").splitlines():
        if line.startswith("["):
            entries = sections[line[1:-1]] = {}
        elif line.startswith('"'):
            key, _, text = line[1:-1].partition('" = "')
            entries |= tomllib.loads(line) if "\\" in line else {key: text}
    return sections


@cache
def read_catalogue(language: str) -> Mapping[str, str]:
    """Entries of a language: English text and translation."""
    return {key: text for section in read_sections(language).values() for key, text in section.items()}


@cache
def _index(language: str) -> Mapping[str, tuple[Entry, ...]]:
    """Entries with arguments by the longest word of their key; a key without a word stands under the empty text."""
    index: dict[str, list[Entry]] = {}
    for key, text in read_catalogue(language).items():
        if "{" in key and ARGUMENT.search(key):
            words = WORD.findall(ARGUMENT.sub(" ", key))
            entry = Entry(key, text, sum(map(len, words)))
            index.setdefault(max(words, key=len, default=""), []).append(entry)
    return {word: tuple(entries) for word, entries in index.items()}


@cache
def _compile(key: str) -> re.Pattern[str]:
    """Expression of a key, with one group for each argument; only a key that shares a word with a text is compiled."""
    parts = ARGUMENT.split(key)
    pieces = [re.escape(part) if i % 2 == 0 else f"({ARGUMENT_TEXTS[part]})" for i, part in enumerate(parts)]
    return re.compile("".join(pieces), re.DOTALL)


@lru_cache(maxsize=100_000)
def translate(text: str, language: str) -> Translation:
    """A text in a language, with the parts that the catalogue lacks."""
    if language == LANGUAGES[0] or not _has_words(text):
        return Translation(text)
    if (exact := read_catalogue(language).get(text)) is not None:
        return Translation(exact)
    core, stop = _cut_stop(text)
    found = min(_list_candidates(core, language), key=lambda candidate: candidate.lack)
    return Translation(f"{found.text}{stop}", found.missing)


def _cut_stop(text: str) -> tuple[str, str]:
    """A text without its full stop, and the full stop: keys have none at their end."""
    core = text.removesuffix(".")
    return core, text[len(core) :]


def _has_words(text: str) -> bool:
    """Whether a text has words; a number with its unit, a name of a file or of a value has none."""
    words = [word for word in text.replace("\N{NO-BREAK SPACE}", " ").split() if word.strip("()[]") not in BOUND_UNITS]
    plain = (word.strip("()[].,;:=±–—‡*'\"") for word in words)
    return any(WORD.fullmatch(word.replace("-", "").replace("'", "")) and len(word) > 1 for word in plain)


def _list_candidates(text: str, language: str) -> Iterator[Translation]:
    """Translations of a text: by its own entry, of its sentences, by a general entry, without punctuation; itself."""
    if found := _match(text, language, WORD.findall(text)):
        yield found
        if not found.missing:
            return
    if (pieces := SENTENCE_END.split(text))[1:]:
        yield _join_sentences(pieces, language)
    if found := _match(text, language, [""]):
        yield found
    before, core, after = SURROUNDED.match(text).groups()  # type: ignore[union-attr]  # it matches every text
    if core and (before or after):
        inner = translate(core, language)
        yield Translation(f"{before}{inner.text}{after}", inner.missing)
    yield Translation(text, (text,))


def _match(text: str, language: str, words: list[str]) -> Translation | None:
    """Translation of a whole text by one entry; None without an entry."""
    if (exact := read_catalogue(language).get(text)) is not None:
        return Translation(exact)
    index = _index(language)
    entries = {entry.key: entry for word in words for entry in index.get(word, ())}
    found: list[Translation] = []
    for entry in sorted(entries.values(), key=lambda entry: (-entry.letters, -entry.key.count("{"))):
        if match := _compile(entry.key).fullmatch(text):
            filled = _fill(entry, match, language)
            if not filled.missing:
                return filled
            if entry.letters >= LETTERS_OF_A_FRAME or entry.key == LIST_JOINT:
                found.append(filled)
    return min(found, key=lambda candidate: candidate.lack, default=None)


def _fill(entry: Entry, match: re.Match[str], language: str) -> Translation:
    """Translation by an entry, with its arguments."""
    names = [found[0] for found in ARGUMENT.finditer(entry.key)]
    arguments: dict[str, str] = {}
    missing: tuple[str, ...] = ()
    for name, part in zip(names, match.groups(), strict=True):
        inner = translate(part, language) if name[1] == "t" else Translation(part)
        arguments[name], missing = inner.text, missing + inner.missing
    return Translation(ARGUMENT.sub(lambda found: arguments[found[0]], entry.translation), missing)


def _join_sentences(pieces: list[str], language: str) -> Translation:
    """Translation of sentences; some of them have one entry together: a full stop can stand inside them."""
    texts: list[str] = []
    missing: tuple[str, ...] = ()
    start = 0
    while start < len(pieces):
        for end in range(len(pieces) if start else len(pieces) - 1, start, -1):
            joined = " ".join(pieces[start:end])
            core, stop = _cut_stop(joined)
            found = translate(joined, language) if end == start + 1 else _match(core, language, WORD.findall(core))
            if found is not None and (not found.missing or end == start + 1):
                break
        texts.append(found.text + stop * (end > start + 1))  # type: ignore[union-attr]  # a sentence gives a text
        missing, start = missing + found.missing, end  # type: ignore[union-attr]
    return Translation(" ".join(texts), missing)


# Documents and templates.
def translate_document(document: Document) -> Document:
    """A document with every text in its language."""
    if document.language == LANGUAGES[0]:
        return document
    translated: Document = _change_parts(document, lambda text: translate(text, document.language).text)
    return translated


def _change_parts(value: Any, change: Callable[[str], str]) -> Any:
    """Parts of a document with every text for a reader changed."""
    if isinstance(value, str):
        return change(value)
    if isinstance(value, tuple):
        return tuple(_change_parts(part, change) for part in value)
    if isinstance(value, Code | CodeBlock | VerdictMark | TrustMark) or not hasattr(value, "__dataclass_fields__"):
        return value
    names = [field.name for field in fields(value)]
    changed = {name: _change_parts(getattr(value, name), change) for name in names if name not in FIXED}
    if "svg" in names:
        changed["svg"] = DRAWN.sub(lambda found: _redraw_text(found[1], unescape(found[2]), change), value.svg)
    return replace(value, **changed)


def _redraw_text(tag: str, text: str, change: Callable[[str], str]) -> str:
    """Text of a figure; a longer one in a row, such as a legend, has smaller letters, to end where the text ended."""
    changed = change(text)
    fits = (len(text) + SPARE_LETTERS) / max(len(changed), 1)
    share = max(fits, SMALLEST_LETTERS) if "text-anchor: start" in tag else 1.0
    if share < 1.0:
        tag = LETTER_SIZE.sub(lambda found: f"{found[1]}{float(found[2]) * share:.2f}px", tag)
    return f"{tag}{escape(changed, quote=False)}"


def translate_tree(value: Any, language: str) -> Any:
    """Dictionaries and lists, such as the words of the pages, with every text but the keys in a language."""
    if isinstance(value, str):
        return translate(value, language).text
    return {key: translate_tree(part, language) for key, part in value.items()} if isinstance(value, dict) else value


def translate_marked(source: str, language: str) -> str:
    """Source of a script or of a style sheet with its marked texts in a language, each as a literal."""
    return MARKED.sub(lambda found: f'"{translate(found[1], language).text}"', source)


def collect_marked(source: str, language: str) -> dict[str, str]:
    """Marked texts of a template in a language, by the English text."""
    return {found[1]: translate(found[1], language).text for found in MARKED.finditer(source)}
