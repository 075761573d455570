"""Comparison of two folders of artefacts: every difference with its file, its place, and both values."""

import json
from collections import Counter
from collections.abc import Iterator
from difflib import SequenceMatcher
from pathlib import Path

from verification.frozen.commands import COMMANDS, SPLIT
from verification.frozen.contents import Contents, read_contents
from verification.frozen.tables import ADDED, MOVED, NOT_COMPARED, REMOVED, Tables

ABSENT = "(absent)"
LONGEST = 160
"""Characters of a value that are printed."""

CONTEXT = 6
"""Words before a difference that are printed with it."""

ITEMS = {"text": "words", "page": "words", "figure": "elements of figures", "line": "lines"}
"""Items of a sequence by the kind of the part."""

Difference = tuple[str, str, str]
"""Place in the file, old and new value."""


def compare(old: Path, new: Path, selected: list[str]) -> bool:
    """Compare the artefacts of two states and print every difference.

    Args:
        old: Folder that `write` has filled with the earlier state.
        new: Folder of the later state.
        selected: Names of the commands; all if empty.

    Returns:
        True if nothing differs.
    """
    tables, counts, total = Tables(), Counter[str](), 0
    for name in selected or COMMANDS:
        pairs = _pair_files(old, new, name, tables)
        differences = [("exit code", *codes)] if (codes := _exit_codes(old, new, name)) else []
        total += _print_differences(name, differences)
        for file, old_path, new_path in pairs:
            total += _print_differences(file, list(_compare_files(file, old_path, new_path, tables, counts)))
        counts["commands"] += 1
    print("compared: " + ", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    for pattern in tables.unused():
        print(f"intended difference not found: {pattern}")
    print(f"{total} differences")
    return total == 0


def _exit_codes(old: Path, new: Path, name: str) -> tuple[str, str] | None:
    codes = [
        str(json.loads((folder / "commands.json").read_text()).get(known, {}).get("exit_code", ABSENT))
        for folder, known in ((old, SPLIT.get(name, name)), (new, name))
    ]
    # A command that neither state has run is not an agreement.
    return None if codes[0] == codes[1] != ABSENT else (codes[0], codes[1])


def _pair_files(old: Path, new: Path, name: str, tables: Tables) -> list[tuple[str, Path | None, Path | None]]:
    """Name in the new state and both paths of every file of a command."""
    old_names = {name, SPLIT.get(name, name)}
    renamed = {tables.file(file): path for old_name in sorted(old_names) for file, path in _list_files(old, old_name)}
    old_files = {file: path for file, path in renamed.items() if file.startswith(f"{name}/")}
    new_files = dict(_list_files(new, name))
    return [
        (file, old_files.get(file), new_files.get(file))
        for file in sorted(old_files | new_files)
        if not tables.omits(NOT_COMPARED, file)
    ]


def _list_files(folder: Path, name: str) -> Iterator[tuple[str, Path]]:
    for path in (folder / name).rglob("*"):
        if path.is_file():
            yield path.relative_to(folder).as_posix(), path


def _compare_files(
    file: str, old: Path | None, new: Path | None, tables: Tables, counts: Counter[str]
) -> Iterator[Difference]:
    if old is None or new is None:
        if not tables.omits(ADDED if old is None else REMOVED, file):
            yield "file", *(ABSENT if path is None else "present" for path in (old, new))
        return
    counts[f"files {new.suffix}"] += 1
    if old.read_bytes() == new.read_bytes():
        counts["files with the same bytes"] += 1
    old_parts, new_parts = read_contents(old, tables.old_text), read_contents(new, tables.new_text)
    if _count_words(old_parts) == _count_words(new_parts) and tables.omits(MOVED, file):
        counts["files whose words moved"] += 1
        old_parts = new_parts
    for part in old_parts | new_parts:
        old_part, new_part = old_parts.get(part), new_parts.get(part)
        if old_part is None or new_part is None:
            yield part, *(ABSENT if content is None else "present" for content in (old_part, new_part))
        elif isinstance(old_part, dict) and isinstance(new_part, dict):
            yield from _compare_values(file, old_part, new_part, tables, counts)
        else:
            kind = part.split(" ")[0]
            if kind in ("page", "figure"):
                counts[f"{kind}s"] += 1
            counts[ITEMS[kind]] += len(new_part)
            yield from _compare_sequences(part, list(old_part), list(new_part))


def _count_words(parts: Contents) -> Counter[str]:
    """Every word with its number, in any order; empty for a file with values."""
    sequences = [content for content in parts.values() if not isinstance(content, dict)]
    return Counter(word for sequence in sequences for word in sequence)


def _compare_values(
    file: str, old: dict[str, str], new: dict[str, str], tables: Tables, counts: Counter[str]
) -> Iterator[Difference]:
    renamed = {tables.place(file + place): value for place, value in old.items()}
    if len(renamed) < len(old):
        yield "renamed places", str(len(old)), f"{len(renamed)}: several have the same new name"
    later = {file + place: value for place, value in new.items()}
    for place in renamed | later:
        if tables.omits(NOT_COMPARED, place):
            counts["values left out"] += 1
            continue
        counts["values"] += 1
        if renamed.get(place) == later.get(place):
            continue
        if place not in later and tables.omits(REMOVED, place):
            counts["values removed"] += 1
        elif place not in renamed and tables.omits(ADDED, place):
            counts["values added"] += 1
        elif tables.changes(place, renamed.get(place), later.get(place)):
            counts["values changed"] += 1
        else:
            yield place.removeprefix(file), renamed.get(place, ABSENT), later.get(place, ABSENT)


def _compare_sequences(part: str, old: list[str], new: list[str]) -> Iterator[Difference]:
    if old == new:
        return
    for operation, i, i_end, j, j_end in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if operation != "equal":
            before = " ".join(new[max(j - CONTEXT, 0) : j])[-LONGEST // 2 :]
            yield f"{part}, item {j + 1}, after '{before}'", " ".join(old[i:i_end]), " ".join(new[j:j_end])


def _print_differences(file: str, differences: list[Difference]) -> int:
    for place, old, new in differences:
        print(f"{file}: {place}\n  old: {_shorten(old)}\n  new: {_shorten(new)}")
    return len(differences)


def _shorten(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 20]} ... ({len(text)} characters)"
