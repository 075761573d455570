"""Meaning of the names that data loggers give to their channels: quantity, unit and time, in one place."""

import re
import tomllib
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

from pantocheck.conformance.core.texts import TEMPLATES
from pantocheck.conformance.core.units import SPELLINGS, find_key_units, is_unit, key_suffix

_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]\s*$")
_SEPARATOR = re.compile(r"\s*/\s*|\s+in\s+|_|\s+")
_SENSOR = re.compile(r"s\d+_[xyz]")


VOICED_MARKS = "\u3099\u309a"
"""Marks that distinguish Japanese syllables; they are not accents."""


@dataclass(frozen=True)
class ChannelWords:
    """Words of the names of a channel."""

    unit: str
    """SI unit as at the end of a key."""
    words: tuple[str, ...]
    """Words at the start or the end of a word of the name; anywhere in it where a script has no blanks."""
    names: tuple[str, ...]
    """Whole words, also with a number behind them."""

    def match(self, name: str) -> bool:
        """Whether a folded name contains one of the words."""
        tokens = [re.sub(r"_?\d+$", "", token) for token in (name, *re.split(r"[^0-9a-z]+", name))]
        return any(token in self.names for token in tokens) or any(
            word in name if not word.isascii() else token.startswith(word) or token.endswith(word)
            for token in tokens
            for word in self.words
        )


@cache
def load_channel_words() -> Mapping[str, ChannelWords]:
    """Words of each channel, in the order in which a name is tried."""
    tables = tomllib.loads((TEMPLATES / "channel_words.toml").read_text(encoding="utf-8"))
    return {name: ChannelWords(row["unit"], tuple(row["words"]), tuple(row["names"])) for name, row in tables.items()}


def fold_name(text: str) -> str:
    """Name in lower case without accents, for comparisons."""
    plain = unicodedata.normalize("NFKD", text.casefold().replace("ł", "l"))
    kept = (c for c in plain if not unicodedata.combining(c) or c in VOICED_MARKS)
    return unicodedata.normalize("NFC", "".join(kept))


def find_factor(text: str, known: Mapping[str, float]) -> float | None:
    """Factor of a unit to the SI unit; None if it is not a unit of this quantity. `known` as from `find_key_units`."""
    name = text.strip()
    return known.get(key_suffix(SPELLINGS.get(name.lower(), name)))


def split_unit(label: str) -> tuple[str, str | None]:
    """Name of a column without its groups and its unit, and this unit; None for a name without a unit.

    A unit stands in brackets at the end, or after a slash, a blank, `in` or `_`. There, a unit of one letter counts
    only behind a word of its quantity: `Zeit_s`, but not `sensor_s`.
    """
    label = label.strip()
    match = _BRACKETS.search(label)
    if match and match[1].strip() and is_unit(match[1]):
        name = label[: match.start()].rstrip(" /").removesuffix(" in")
        return name.rpartition("/")[2].strip(), match[1].strip()
    for mark in _SEPARATOR.finditer(label, 1):
        name, unit = label[: mark.start()].strip(), label[mark.end() :].strip()
        spelled = unit.replace("_", "/") if mark[0] == "_" else unit
        if unit and is_unit(spelled) and (len(unit) > 1 or _has_word_of(spelled, fold_name(name))):
            return name.rpartition("/")[2].strip(), spelled
    return label.rpartition("/")[2].strip(), None


def _has_word_of(unit: str, folded: str) -> bool:
    """Whether a folded name has a word of a channel with a unit of this quantity."""
    return any(
        words.match(folded) and find_factor(unit, find_key_units(words.unit)) is not None
        for words in load_channel_words().values()
    )


def list_meanings(label: str, unit: str | None) -> Iterator[tuple[str, float | None]]:
    """Channels that a column may hold, the most probable first.

    Args:
        label: Name in the file.
        unit: Unit that the file states beside the name; None without.

    Yields:
        Channel, and the factor of its unit to the SI unit; None without a unit.
    """
    name, named_unit = split_unit(label)
    folded, stated = fold_name(name), unit or named_unit
    for channel, words in load_channel_words().items():
        if not words.match(folded) and not (channel == "acceleration" and _SENSOR.fullmatch(folded)):
            continue
        factor = None if stated is None else find_factor(stated, find_key_units(words.unit))
        if stated is None or factor is not None:
            yield channel, factor


def has_word(label: str, channel: str) -> bool:
    """Whether the name of a column has a word of a channel; its unit does not matter."""
    return load_channel_words()[channel].match(fold_name(split_unit(label)[0]))


def find_time_factor(label: str, unit: str | None) -> float | None:
    """Factor of a time column to seconds, 1 without a unit; None for a column without the name or unit of a time."""
    channel, factor = next(list_meanings(label, unit), (None, None))
    if channel != "time":
        return None
    return 1.0 if factor is None else factor
