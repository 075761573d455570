"""Intended differences between two states, and the placeholders of texts that differ in every run.

A place is the path of the file below the folder of artefacts with the JSON pointer of the value, for example
`ac-simple/results.json/cases/0/verdict`. Patterns of places must match the whole place.
"""

import re
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

from verification.frozen.commands import OLD_WORDS


class Rename(NamedTuple):
    """Pattern of the old place, file or text, its replacement in the syntax of `re.sub`, and the reason."""

    pattern: str
    replacement: str | Callable[[re.Match[str]], str]
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


def _rename_source(place: re.Match[str]) -> str:
    """Place of the name, source or digest of a source for a key such as `record`, `record_source` or `line_digest`."""
    subject = "record" if place[2] == "record" else "model"
    return f"{place[1]}/{subject}/{(place[3] or '_name').removeprefix('_')}"


_SOURCES = "one type for the sources of all comparisons"
_CRITERIA = "one type and one table for the criteria of all comparisons, by label, with a limit that has its sign"
_CRITERION = "criteria of comparisons have the keys of all criteria, and a reason that names the side of the limit"
_EVIDENCE = "evidence has its own place"
_WIRE_SPRINGS = "springs between the wires are a new element"
_DOSSIER = r"(?:validate|site/runs/[\w-]+)/\w+\.(?:json|html)/procedure"
_STATIC = rf"^(line-statics/static_comparison\.(?:json|html)|{_DOSSIER}/statics/\d+)"
_RESPONSE = (
    r"^(pantograph-(?:compare|graded)/response_comparison\.(?:json|html)"
    rf"|pantograph-fit/fitted-fit\.(?:json|html)/comparison|{_DOSSIER}/responses/\d+)"
)
_DROP = r"^(drop-(?:compare|graded)/drop_comparison\.(?:json|html))"
_COMPARISON = (
    r"(line-statics|pantograph-(compare|graded|fit)|drop-(compare|graded)"
    r"|(?:validate|site/runs/[\w-]+)/\w+\.\w+/procedure/(statics|responses))/.*"
)

RENAMED_FILES = (Rename(r"^show/line\.svg$", "line-draw/line.svg", "`show --drawing` is the command `line draw`"),)
"""Files by their path, searched in the path of the old state."""

RENAMED = (
    Rename(_STATIC + r"/(line|record)(_digest)?$", _rename_source, _SOURCES),
    Rename(_STATIC + r"/criteria/(\d+)/tolerance$", r"\1/criteria/\2/upper", _CRITERIA),
    Rename(_RESPONSE + r"/(pantograph)(_digest)?$", _rename_source, _SOURCES),
    Rename(_RESPONSE + r"/criteria/(\d+)/response$", r"\1/criteria/\2/where/record", _CRITERIA),
    Rename(
        r"((?:-graded/\w+\.(?:json|html)|/procedure/responses/\d+)/criteria/\d+)/(motion|sensor|window_s|band_Hz|static_force_N|height_m)(?=/|$)",
        r"\1/where/\2",
        _CRITERIA,
    ),
    Rename(_DROP + r"/(line|record)(_digest|_source)?$", _rename_source, _SOURCES),
    *(
        Rename(comparison + r"/criteria/(\d+)/measurement$", r"\1/criteria/\2/limit_uncertainty", _CRITERION)
        for comparison in (_STATIC, _RESPONSE, _DROP)
    ),
    *(
        Rename(comparison + r"/criteria/(\d+)/discretisation$", r"\1/criteria/\2/uncertainty", _CRITERION)
        for comparison in (_STATIC, _DROP)
    ),
)
"""Keys of JSON files, searched in the place of the old state."""

REMOVED: tuple[Omission, ...] = ()
"""Places of JSON files, or files, of the old state only."""

ADDED = (
    Omission(r"line-draw/output\.txt", "`show --drawing` is the command `line draw`"),
    Omission(_COMPARISON + r"/(model|record)/(source|digest)", _SOURCES),
    Omission(r"show/request\.json/features/\d+", "a program answers with the features that it simulates"),
    Omission(r".*/campaign\.parquet", "written if pyarrow is installed"),
    Omission(r".*/line_shape/symbols/.*", "the elements of the line name the symbols of its drawing"),
    Omission(_COMPARISON + r"/warnings", "every comparison states its warnings"),
    Omission(
        _COMPARISON + r"/criteria/\d+/(where/.*|unit|lower|upper|source)",
        _CRITERIA,
    ),
    Omission(_COMPARISON + r"/criteria/\d+/(pantograph|item|trust|baseline|finding|spread)", _CRITERION),
    Omission(_COMPARISON + r"/criteria/\d+/(discretisation_error|uncertainty|components(/.*)?)", _CRITERION),
)
"""Places of JSON files, or files, of the new state only."""

CHANGED = (
    Change(
        r"compare-(results|systems)/comparison\.(?:json|html)/subjects/\d+/digest",
        "''",
        "None",
        "null is the word for no digest",
    ),
)
"""Values of JSON files that state the same fact in another way; never a number or a verdict."""

RENAMED_TEXT = (
    Rename(
        r"\bbenchmarks/(dossier_measurements|finite\\?_ ?differences)\.py",
        r"verification/formulations/\1.py",
        _EVIDENCE,
    ),
    Rename(r"\bbenchmarks/(stand_in_search)\.py", r"verification/tables/\1.py", _EVIDENCE),
    Rename(r"\bbenchmarks/table_ ?search\.py", "verification/tables/table_search.py", _EVIDENCE),
    Rename(r"(?<=thresholds of )fit-damping\b", "drop fit", "commands stand in groups"),
    Rename(r"(?<=[%°Nm] )beyond the limit\b", "above the upper limit", _CRITERION),
    Rename(r"(?<=\d )beyond the limit\b", "below the lower limit", _CRITERION),
    Rename(r"(?<=Criterion Value )Tolerance(?= ± model ± measured)", "Limit", _CRITERIA),
    Rename(
        r"((?:to the measured one|contact wire height) ?\[(?:%|mm)\] [\d.]+ )(?=\d+ [\d.]+ [\d.]+ ✓)",
        r"\1≤ ",
        _CRITERIA,
    ),
    Rename(
        r"\bcriterion value tolerance verdict\b",
        "criterion value limit verdict",
        _CRITERIA,
    ),
    Rename(r"(?<=Criterion Value )Limits(?= ± model ±)", "Limit", _CRITERIA),
    Rename(r"(?<=Criterion Value Limit ± model ± )noise\b", "measured", _CRITERIA),
    Rename(r"\bcriterion value limits verdict\b", "criterion value limit verdict", _CRITERIA),
    Rename(r"(?<= Hz )(\S+) ([\d.]+) to -(?= )", r"\1 >= \2", _CRITERIA),
    Rename(r"(?<= N \[[%°]\] )(\S+) (?=[\d.]+ (?:PASS|FAIL|SKIP))", r"\1 <= ", _CRITERIA),
    Rename(r" show/line\.svg\b", "", "`show --drawing` is the command `line draw`"),
    Rename(
        r"\belasticity_difference_pct ([\d.]+) (?=\d+ (?:PASS|FAIL))",
        r"Largest difference of the elasticity, relative to the measured one [%] \1 <= ",
        _CRITERIA,
    ),
    Rename(
        r"\bcontact_wire_height_difference_mm ([\d.]+) (?=\d+ (?:PASS|FAIL))",
        r"Largest difference of the contact wire height [mm] \1 <= ",
        _CRITERIA,
    ),
)
"""Words of pages and texts, searched in the old text after placeholders are set; removed words have no replacement."""

ADDED_TEXT = (
    Omission(
        r"(?m)^# Spring between messenger and contact wire.*\n(?:# .*\n)+\n",
        _WIRE_SPRINGS,
    ),
    Omission(r"[\w-]+/campaign\.parquet\b ?", "written if pyarrow is installed"),
    Omission(
        r" further_sections every tension section behind the first one, .*? Absent: one section\b",
        "the message to a program describes every tension section",
    ),
    Omission(r" wire_springs springs between the wires; absent: none\b", _WIRE_SPRINGS),
)
"""Words of pages and texts of the new state only."""

_ADDED_WORDS = tuple(Rename(added.pattern, "", added.reason) for added in ADDED_TEXT)

MOVED = (
    Omission(r"show(-drop)?/output\.txt", "the keys of a line are listed in the order of its elements"),
    Omission(r"line-statics/static_comparison\.pdf", "a label has one line now: a row moves to the page before"),
)
"""Files that have the same words in another order or on another page."""

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
